// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/convert_loss.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

namespace dendrofit::cli {
namespace {

double volume_of(const Tree& tree) {
  double volume = 0;
  for (std::size_t i = 0; i < tree.size(); ++i) volume += tree.volume(i);
  return volume;
}

double widest_gap(const Tree& tree) {
  double widest = 0;
  for (std::size_t i = 0; i < tree.size(); ++i)
    if (tree.parent[i] >= 0)
      widest = std::max(widest, (tree.start[i] - tree.end[static_cast<std::size_t>(tree.parent[i])]).norm());
  return widest;
}

}  // namespace

std::vector<std::string> losses(const Tree& tree, const std::filesystem::path& written, TreeFormat format) {
  std::vector<std::string> lost;
  const Tree back = read_tree(written);
  const double before = volume_of(tree), after = volume_of(back);
  const std::string name(to_string(format));
  if (back.size() != tree.size())
    lost.push_back(fmt::format("{} holds {} of the {} cylinders", name, back.size(), tree.size()));
  if (std::abs(after - before) > 1e-6 * before)
    lost.push_back(fmt::format(
        "wood volume is {:.6g} m3 in {} instead of {:.6g} m3 ({:+.2g} %){}", after, name, before,
        100 * (after - before) / before,
        format == TreeFormat::treefile
            ? fmt::format(": its cylinders start at their parent's tip, so gaps of up to {:.3g} m are closed",
                          widest_gap(tree))
            : std::string(": its numbers carry fewer digits")));
  const bool kept = format == TreeFormat::ours || format == TreeFormat::arbor_csv;
  const bool graded = std::any_of(tree.quality.begin(), tree.quality.end(),
                                  [](RadiusQuality q) { return q != RadiusQuality::measured; });
  const bool errors =
      std::any_of(tree.radius_se.begin(), tree.radius_se.end(), [](double se) { return std::isfinite(se); });
  if (!kept && (graded || errors))
    lost.push_back(name +
                   " has no place for where a radius comes from (measured, interpolated, ...) and its "
                   "standard error");
  return lost;
}

std::vector<std::string> losses(const PointCloud& cloud, const std::filesystem::path& written) {
  std::vector<std::string> lost;
  std::string extension = written.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  const bool keeps_crs = extension == ".las" || extension == ".laz" || extension == ".ply";
  if (!cloud.crs_wkt.empty() && !keeps_crs)
    lost.push_back(
        fmt::format("a {} file has no place for the coordinate system ({})", extension,
                    cloud.crs_wkt.size() > 60 ? cloud.crs_wkt.substr(0, 57) + "..." : cloud.crs_wkt));
  if (!cloud.scanner_positions.empty())
    lost.push_back(fmt::format("the {} scanner positions are left out (dendrofit info --json lists them)",
                               cloud.scanner_positions.size()));
  return lost;
}

}  // namespace dendrofit::cli
