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

namespace dendrofit {

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
  std::string crs_wkt;  ///< WKT as stated, or "EPSG:n" from GeoTIFF keys
  std::string software;
};

/// Smallest record of each point format.
std::uint32_t las_record_length(int point_format);

/// Reads and checks the header and the variable length records; does not look at the points. Throws IoError.
LasHeader read_las_header(const FileBytes& bytes);

/// Decodes header.point_count records that lie one after another from `records`, which must hold them all.
PointCloud decode_las_points(const LasHeader& header, const char* records, Progress& progress);

}  // namespace dendrofit
