// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/report/distributions.h"

#include "core/metrics.h"
#include "core/tree_topology.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace dendrofit {
namespace {

void add_at(HeightProfile& profile, double height, double area, double step) {
  const auto bin = static_cast<std::size_t>(std::max(0.0, std::floor(height / step)));
  while (profile.height_m.size() <= bin) {
    profile.height_m.push_back((static_cast<double>(profile.height_m.size()) + 0.5) * step);
    profile.area_per_m.push_back(0);
  }
  profile.area_per_m[bin] += area / step;
}

}  // namespace

BranchValues branch_values(const Tree& tree) {
  BranchValues values;
  for (const Axis& axis : axes_of(tree)) {
    if (axis.parent_node < 0 || axis.nodes.empty()) continue;
    const auto first = static_cast<std::size_t>(axis.nodes.front());
    const double stretch = std::max(0.1, 2 * tree.radius[static_cast<std::size_t>(axis.parent_node)]);
    Vec3 along = Vec3::Zero();
    for (std::int32_t node : axis.nodes) {
      along = tree.end[static_cast<std::size_t>(node)] - tree.start[first];
      if (along.norm() >= stretch) break;
    }
    values.length_m.push_back(axis.length);
    if (along.norm() > 0) {
      const double cosine =
          along.normalized().dot(tree.direction(static_cast<std::size_t>(axis.parent_node)));
      values.angle_deg.push_back(std::acos(std::clamp(cosine, -1.0, 1.0)) * 180 / std::numbers::pi);
    }
  }
  return values;
}

std::vector<double> histogram(const std::vector<double>& values, double lo, double hi, std::size_t bins) {
  std::vector<double> shares(bins, 0.0);
  for (double v : values) {
    const double at = (v - lo) / (hi - lo) * static_cast<double>(bins);
    const auto bin = static_cast<std::size_t>(std::clamp(at, 0.0, static_cast<double>(bins) - 0.5));
    shares[bin] += 1.0 / static_cast<double>(values.size());
  }
  return shares;
}

HeightProfile wood_profile(const Tree& tree, double step_m) {
  HeightProfile profile;
  if (tree.empty()) return profile;
  const double foot = foot_height(tree);
  for (std::size_t i = 0; i < tree.size(); ++i) {
    // A cylinder is cut into pieces shorter than a step, each counted at its middle.
    const auto pieces = static_cast<std::size_t>(
        std::clamp(std::ceil(4 * std::abs(tree.end[i].z() - tree.start[i].z()) / step_m), 1.0, 1e4));
    const double area = 2 * std::numbers::pi * tree.radius[i] * tree.length(i) / static_cast<double>(pieces);
    for (std::size_t k = 0; k < pieces; ++k) {
      const double t = (static_cast<double>(k) + 0.5) / static_cast<double>(pieces);
      add_at(profile, tree.start[i].z() + t * (tree.end[i].z() - tree.start[i].z()) - foot, area, step_m);
    }
  }
  return profile;
}

HeightProfile leaf_profile(const Foliage& foliage, const Tree& tree, double step_m) {
  HeightProfile profile;
  if (tree.empty()) return profile;
  const double foot = foot_height(tree) + tree.origin_shift.z() - foliage.origin_shift.z();
  for (std::size_t i = 0; i < foliage.size(); ++i) {
    const Leaf& leaf = foliage.leaves[i];
    add_at(profile, leaf.origin.z() + 0.5 * leaf.length_m * leaf.direction.z() - foot, foliage.leaf_area(i),
           step_m);
  }
  return profile;
}

}  // namespace dendrofit
