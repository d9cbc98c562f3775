// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/read_cloud.h"

#include "core/errors.h"
#include "io/cloud_formats.h"
#include "io/coordinate_limit.h"
#include "io/text_numbers.h"
#include "io/tree_formats.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace dendrofit {
namespace {

constexpr std::array<std::string_view, 7> kNames = {"las", "laz", "ply", "pcd", "ptx", "e57", "xyz"};

// A multiple of 100 m near the middle value of a sample, so that one stray first point does no harm.
double shift_of(const std::vector<Vec3>& points, int axis) {
  constexpr std::size_t samples = 101;
  std::array<double, samples> values{};
  for (std::size_t k = 0; k < samples; ++k) values[k] = points[(points.size() - 1) * k / (samples - 1)][axis];
  std::nth_element(values.begin(), values.begin() + samples / 2, values.end());
  const double middle = values[samples / 2];
  return std::abs(middle) < 100 ? 0 : std::round(middle / 100) * 100;
}

/// Cylinders in a table would pass for points: many of these tables have no header, some have columns x, y
/// and z.
void refuse_tree(const FileBytes& bytes) {
  if (trimmed(bytes.view()).empty()) return;
  if (const auto format = tree_format_in(bytes))
    fail_in_file(bytes.path(),
                 "is a tree model (" + std::string(to_string(*format)) +
                     "), not a point cloud: its lines are cylinders; give the scan it was made from, or "
                     "the model to a command that takes models (fit, leaves, view, convert)");
}

}  // namespace

void ReadCloudOptions::validate() const {
  if (delimiter && std::string_view(" ,;\t").find(*delimiter) == std::string_view::npos)
    throw InputError("delimiter " + shown(std::string(1, *delimiter)) +
                     ": expected blank, comma, semicolon or tab");
  if (decimal && *decimal != '.' && *decimal != ',')
    throw InputError("decimal " + shown(std::string(1, *decimal)) + ": expected '.' or ','");
  if (delimiter && decimal && *delimiter == *decimal)
    throw InputError("delimiter and decimal are both ',': choose another delimiter");
}

std::string_view to_string(CloudFormat format) {
  return kNames[static_cast<std::size_t>(format)];
}

CloudFormat cloud_format_of(const FileBytes& bytes) {
  const std::string_view view = bytes.view();
  if (view.starts_with("LASF")) {
    const bool compressed = view.size() > 104 && (static_cast<unsigned char>(view[104]) & 0x80) != 0;
    return compressed ? CloudFormat::laz : CloudFormat::las;
  }
  if (view.starts_with("ply\n") || view.starts_with("ply\r")) return CloudFormat::ply;
  if (view.starts_with("ASTM-E57")) return CloudFormat::e57;
  if (view.starts_with("# .PCD") || view.starts_with("VERSION ") || view.starts_with("FIELDS "))
    return CloudFormat::pcd;
  const std::string_view head = view.substr(0, 4096);
  if (head.find('\0') != std::string_view::npos && !head.starts_with("\xff\xfe") &&
      !head.starts_with("\xfe\xff"))
    fail_at_byte(bytes.path(), 0,
                 shown(view.substr(0, 8)) +
                     " found; expected the start of a LAS, LAZ, PLY, PCD, PTX, E57 or text point cloud");
  return is_ptx(bytes) ? CloudFormat::ptx : CloudFormat::text;
}

void settle_cloud(const FileBytes& bytes, PointCloud& cloud) {
  if (cloud.empty()) fail_in_file(bytes.path(), "holds no points; is it the file you meant?");
  const Bounds bounds = bounds_of(cloud.points);
  if (!(bounds.lo.cwiseAbs().maxCoeff() <= kLargestCoordinate) ||
      !(bounds.hi.cwiseAbs().maxCoeff() <= kLargestCoordinate)) {
    std::size_t i = 0;
    while (i + 1 < cloud.size() && cloud.points[i].cwiseAbs().maxCoeff() <= kLargestCoordinate) ++i;
    const Vec3& p = cloud.points[i];
    std::string where;
    for (int k = 0; k < 3; ++k) {
      where += k ? " " : "";
      append_number(where, p[k]);
    }
    fail_in_file(bytes.path(), "point " + std::to_string(i + 1) + " lies at " + where +
                                   ", beyond 1e9 m; the file is damaged or its units are not metres");
  }
  for (int k = 0; k < 3; ++k) cloud.origin_shift[k] = shift_of(cloud.points, k);
  for (Vec3& p : cloud.points) p -= cloud.origin_shift;
  for (Vec3& p : cloud.scanner_positions) p -= cloud.origin_shift;
}

PointCloud read_point_cloud(const std::filesystem::path& path, const ReadCloudOptions& options,
                            Progress& progress) {
  options.validate();
  const FileBytes bytes(path);
  const auto read = [&] {
    switch (cloud_format_of(bytes)) {
      case CloudFormat::las:
        return read_las(bytes, progress);
      case CloudFormat::laz:
        return read_laz(bytes, progress);
      case CloudFormat::ply:
        return read_ply_cloud(bytes, progress);
      case CloudFormat::pcd:
        return read_pcd(bytes, progress);
      case CloudFormat::ptx:
        return read_ptx(bytes, progress);
      case CloudFormat::e57:
        return read_e57(bytes, progress);
      case CloudFormat::text:
        if (!options.columns) refuse_tree(bytes);
        return read_text_cloud(bytes, options, progress);
    }
    fail_in_file(path, "unknown cloud format");
  };
  PointCloud cloud = read();
  settle_cloud(bytes, cloud);
  progress.end();
  return cloud;
}

}  // namespace dendrofit
