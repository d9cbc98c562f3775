// SPDX-License-Identifier: GPL-3.0-or-later
// The LAS header and point record (ASPRS LAS 1.2 to 1.4, R15), shared by the readers of LAS and LAZ and the
// writer.
#pragma once

#include "core/point_cloud.h"
#include "core/progress.h"
#include "io/file_bytes.h"

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace dendrofit {

/// A variable length record about the coordinate system (user LASF_Projection), as it stands in the file.
struct LasRecord {
  std::uint16_t id = 0;  ///< 2112 WKT, 34735 GeoTIFF keys, 34736 and 34737 their numbers and texts
  std::string content;
};

struct LasHeader {
  int major = 1;
  int minor = 2;
  int point_format = 0;  ///< 0 to 10
  bool compressed = false;
  std::uint32_t record_length = 0;
  std::uint64_t points_offset = 0;
  std::uint64_t point_count = 0;
  double scale[3] = {};
  double offset[3] = {};
  std::string crs_wkt;  ///< WKT as stated, or of GeoTIFF keys "EPSG:n", "EPSG:n+vertical" or the name
  std::vector<LasRecord> projection;
  std::string software;
  std::uint32_t chunk_points =
      0;  ///< of compressed points: points a chunk, 2^32 - 1 where it varies; 0 without its record
};

/// Smallest record of each point format.
std::uint32_t las_record_length(int point_format);

/// Reads and checks the header and the variable length records; does not look at the points. Throws IoError.
LasHeader read_las_header(const FileBytes& bytes);

/// Decodes records, in as many pieces as they come, into a cloud in world coordinates.
class LasDecoder {
 public:
  LasDecoder(const LasHeader& header, Progress& progress);
  /// `count` records of header.record_length bytes, one after another.
  void append(const char* records, std::uint64_t count);
  /// One point by its fields.
  void append(std::int32_t x, std::int32_t y, std::int32_t z, std::uint16_t intensity,
              std::uint8_t classification);
  std::uint64_t count() const { return cloud_.points.size(); }
  PointCloud take() { return std::move(cloud_); }

 private:
  const LasHeader& header_;
  Progress& progress_;
  PointCloud cloud_;
};

/// Whether this build compresses (through LASzip).
bool can_write_laz();
/// Throws IoError: why there is no LAZ writing, and what to do.
[[noreturn]] void fail_without_laz_writer(const std::filesystem::path& out);

/// LAS or LAZ into LAS or LAZ (by the extension of `out`): every attribute of every point, the records and
/// the integer coordinates as they are; `shift` (metres) is added to offsets and bounds. Waveform packets are
/// left behind. Throws IoError for a damaged file, or for .laz where can_write_laz() is false.
void copy_las(const std::filesystem::path& in, const std::filesystem::path& out, const Vec3& shift,
              Progress& progress);

}  // namespace dendrofit
