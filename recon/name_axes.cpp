// SPDX-License-Identifier: GPL-3.0-or-later
#include "recon/name_axes.h"

#include "core/tree_topology.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <tuple>

namespace dendrofit {
namespace {

/// The first stretch of a branch: along the child with the most wood beyond it.
struct Stretch {
  double radius = 0;
  Vec3 run = Vec3::Zero();
};

Stretch first_stretch(const Tree& tree, const TreeChildren& children, const std::vector<double>& beyond,
                      const std::vector<double>& seen_radius, std::size_t first) {
  const double length = std::clamp(6 * tree.radius[first], 0.2, 0.8);
  std::vector<double> radii;
  double along = 0;
  std::size_t at = first;
  while (true) {
    radii.push_back(seen_radius[at]);
    along += tree.length(at);
    const auto next = children.of(at);
    if (along >= length || next.empty()) break;
    at = static_cast<std::size_t>(*std::max_element(next.begin(), next.end(), [&](auto x, auto y) {
      return beyond[static_cast<std::size_t>(x)] < beyond[static_cast<std::size_t>(y)];
    }));
  }
  if (radii.size() > 1) radii.erase(radii.begin());  // in the crotch
  const auto middle = radii.begin() + static_cast<std::ptrdiff_t>(radii.size() / 2);
  std::nth_element(radii.begin(), middle, radii.end());
  return {*middle, tree.end[at] - tree.start[first]};
}

}  // namespace

void name_axes(Tree& tree, const std::vector<double>& seen_radius) {
  constexpr double kTurn = 0.2;  // what a right angle counts, in shares of the squared radius
  const std::vector<double> beyond = length_beyond(tree);
  const TreeChildren children(tree);
  std::vector<std::int32_t> heir(tree.size(), -1);
  for (std::size_t i = 0; i < tree.size(); ++i) {
    std::tuple<double, double> best(-1, -1);
    for (const std::int32_t child : children.of(i)) {
      const auto c = static_cast<std::size_t>(child);
      const Stretch s = first_stretch(tree, children, beyond, seen_radius, c);
      const double cosine = s.run.norm() > 0 ? s.run.normalized().dot(tree.direction(i)) : 0;
      const std::tuple<double, double> claim(s.radius * s.radius * (1 + kTurn * cosine), beyond[c]);
      if (claim <= best) continue;
      best = claim;
      heir[i] = child;
    }
  }
  std::int32_t next_axis = 0;
  for (std::size_t i = 0; i < tree.size(); ++i) {
    const std::int32_t p = tree.parent[i];
    const bool goes_on = p >= 0 && heir[static_cast<std::size_t>(p)] == static_cast<std::int32_t>(i);
    tree.axis[i] = goes_on ? tree.axis[static_cast<std::size_t>(p)] : next_axis++;
    tree.order[i] = p < 0 ? 0 : tree.order[static_cast<std::size_t>(p)] + (goes_on ? 0 : 1);
  }
}

}  // namespace dendrofit
