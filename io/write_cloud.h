// SPDX-License-Identifier: GPL-3.0-or-later
// Point clouds to files.
#pragma once

#include "core/point_cloud.h"

#include <filesystem>

namespace dendrofit {

/// Writes by extension, in world coordinates: .las (step 0.01 mm where the extent allows; with class and
/// intensity; 1.2, or 1.4 where a WKT coordinate system or a class above 31 needs it), .ply (binary, double
/// coordinates), .pcd (binary, double coordinates) or columns of numbers (.xyz .txt .asc with blanks, .csv
/// with commas and a header). Throws IoError for another extension or an unwritable file, InputError for an
/// invalid cloud.
void write_point_cloud(const std::filesystem::path& path, const PointCloud& cloud);

}  // namespace dendrofit
