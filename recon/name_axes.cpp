// SPDX-License-Identifier: GPL-3.0-or-later
#include "recon/name_axes.h"

#include "core/tree_topology.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>

namespace dendrofit {
namespace {

/// The first stretch of a branch: along the child with the most wood beyond it.
struct Stretch {
  double radius = 0;
  Vec3 run = Vec3::Zero();
};

Stretch first_stretch(const Tree& tree, const TreeChildren& children, const std::vector<double>& beyond,
                      const std::vector<double>& seen_radius, std::size_t first, double bearer_radius) {
  const double from = std::clamp(2 * bearer_radius, 0.05, 0.3);
  const double to = std::clamp(8 * bearer_radius, 0.2, 1.0);
  std::vector<std::pair<double, double>> radii;  // and the length of each
  double along = 0, length = 0;
  std::size_t at = first;
  while (true) {
    along += tree.length(at);
    if (along >= from) {
      radii.emplace_back(seen_radius[at], std::min(tree.length(at), along - from));
      length += radii.back().second;
    }
    const auto next = children.of(at);
    if (along >= to || next.empty()) break;
    at = static_cast<std::size_t>(*std::max_element(next.begin(), next.end(), [&](auto x, auto y) {
      return beyond[static_cast<std::size_t>(x)] < beyond[static_cast<std::size_t>(y)];
    }));
  }
  std::sort(radii.begin(), radii.end());
  double below = 0, middle = seen_radius[at];
  for (const auto& [radius, own] : radii) {
    middle = radius;
    below += own;
    if (2 * below >= length) break;
  }
  return {middle, tree.end[at] - tree.start[first]};
}

}  // namespace

void name_axes(Tree& tree, const std::vector<double>& seen_radius) {
  constexpr double kTurn = 0.2;   // what a right angle counts, in shares of the squared radius
  constexpr double kPipe = 0.25;  // trust in the pipe relation beside what was seen of the radius
  const std::vector<double> beyond = length_beyond(tree);
  const TreeChildren children(tree);
  std::vector<std::int32_t> heir(tree.size(), -1);
  for (std::size_t i = 0; i < tree.size(); ++i) {
    double best = -1;
    for (const std::int32_t child : children.of(i)) {
      const auto c = static_cast<std::size_t>(child);
      const Stretch s = first_stretch(tree, children, beyond, seen_radius, c, tree.radius[i]);
      const double cosine = s.run.norm() > 0 ? s.run.normalized().dot(tree.direction(i)) : 0;
      const double claim = s.radius * s.radius * (1 + kTurn * cosine) * std::pow(beyond[c] + 0.1, kPipe);
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
