// SPDX-License-Identifier: GPL-3.0-or-later
// Point clouds from files: LAS, LAZ, PLY, PCD, PTX, E57 and columns of numbers.
#pragma once

#include "core/point_cloud.h"
#include "core/progress.h"

#include <filesystem>
#include <optional>
#include <string>

namespace dendrofit {

/// How to read columns of numbers (.xyz .txt .csv .pts .asc); all else is said by the files themselves.
struct ReadCloudOptions {
  /// Between fields: ' ' (any blanks and tabs), ',', ';' or '\t'; detected when absent.
  std::optional<char> delimiter = std::nullopt;
  /// '.' or ','; detected when absent.
  std::optional<char> decimal = std::nullopt;
  /// What the columns hold, e.g. "x,y,z,intensity,-,class" ('-' skips one); from the header line, else x,y,z
  /// first.
  std::optional<std::string> columns = std::nullopt;
  /// Throws InputError for an unknown delimiter, decimal sign or column list without x, y and z.
  void validate() const;
};

/// Reads a cloud, telling the format by the file's content rather than by its name. Coordinates stay double;
/// origin_shift is a multiple of 100 m per axis, 0 below 100 m. Intensity, class and coordinate system are
/// kept where the file has them. Points without a return (PCD's NaN triple, PTX's "0 0 0") are left out.
/// Throws IoError naming file and byte or line, what was found, what was expected and what to do: missing
/// file, folder, wrong magic, truncation, header that claims more than the file holds, coordinates that are
/// not finite numbers or beyond 10^9 m, no point at all. Never allocates for what a header claims beyond the
/// file's size.
PointCloud read_point_cloud(const std::filesystem::path& path, const ReadCloudOptions& options = {},
                            Progress& progress = no_progress());

}  // namespace dendrofit
