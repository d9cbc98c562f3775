// SPDX-License-Identifier: GPL-3.0-or-later
// Point clouds to files.
#pragma once

#include "core/point_cloud.h"
#include "core/progress.h"

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace dendrofit {

/// How a LAS file lays its coordinates down and in which system: kept when a cloud goes from LAS to LAS.
struct LasFrame {
  Vec3 step = Vec3::Constant(1e-5);
  Vec3 offset = Vec3::Zero();
  std::vector<std::pair<std::uint16_t, std::string>> projection;  ///< LASF_Projection records by id
};

struct WriteCloudOptions {
  /// For .las and .laz, where the coordinates fit it. Absent: a step of 0.01 mm, or coarser where the extent
  /// needs it, and the coordinate system as a WKT or GeoTIFF record.
  std::optional<LasFrame> frame;
};

/// Throws IoError where the extension is none that write_point_cloud() knows or can write here: for commands
/// that work long before they write.
void check_cloud_format(const std::filesystem::path& path);

/// Writes by extension, in world coordinates: .las (with class and intensity; 1.2, or 1.4 where a WKT
/// coordinate system or a class above 31 needs it), .laz (where the build has LASzip), .ply (binary, double
/// coordinates, the coordinate system as a comment), .pcd (binary, double coordinates) or columns of numbers
/// (.xyz .txt .asc with blanks, .csv with commas and a header). Throws IoError for another extension or an
/// unwritable file, InputError for an invalid cloud.
void write_point_cloud(const std::filesystem::path& path, const PointCloud& cloud,
                       const WriteCloudOptions& options = {}, Progress& progress = no_progress());

}  // namespace dendrofit
