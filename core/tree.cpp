// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/tree.h"

#include "core/errors.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string>

namespace dendrofit {
namespace {

constexpr std::array<std::string_view, 4> kQualityWords = {"measured", "interpolated", "allometric",
                                                           "extrapolated"};

[[noreturn]] void broken(std::size_t node, const std::string& what) {
  throw InputError("tree node " + std::to_string(node + 1) + ": " + what);
}

}  // namespace

std::string_view to_string(RadiusQuality quality) {
  return kQualityWords[static_cast<std::size_t>(quality)];
}

RadiusQuality radius_quality_from(std::string_view word) {
  const auto* found = std::find(kQualityWords.begin(), kQualityWords.end(), word);
  if (found == kQualityWords.end())
    throw InputError("quality '" + std::string(word) +
                     "': expected measured, interpolated, allometric or extrapolated");
  return static_cast<RadiusQuality>(found - kQualityWords.begin());
}

std::int32_t Tree::axis_count() const {
  return axis.empty() ? 0 : *std::max_element(axis.begin(), axis.end()) + 1;
}

void Tree::reserve(std::size_t nodes) {
  start.reserve(nodes);
  end.reserve(nodes);
  parent.reserve(nodes);
  radius.reserve(nodes);
  axis.reserve(nodes);
  order.reserve(nodes);
  birth_cycle.reserve(nodes);
  quality.reserve(nodes);
  radius_se.reserve(nodes);
}

std::int32_t Tree::add(const TreeNode& node) {
  start.push_back(node.start);
  end.push_back(node.end);
  parent.push_back(node.parent);
  radius.push_back(node.radius);
  axis.push_back(node.axis);
  order.push_back(node.order);
  birth_cycle.push_back(node.birth_cycle);
  quality.push_back(node.quality);
  radius_se.push_back(node.radius_se);
  return static_cast<std::int32_t>(size()) - 1;
}

TreeNode Tree::node(std::size_t i) const {
  return {start[i], end[i],         parent[i],  radius[i],   axis[i],
          order[i], birth_cycle[i], quality[i], radius_se[i]};
}

Vec3 Tree::direction(std::size_t i) const {
  const Vec3 along = end[i] - start[i];
  const double norm = along.norm();
  return norm > 0 ? Vec3(along / norm) : Vec3::UnitZ();
}

double Tree::volume(std::size_t i) const {
  return std::numbers::pi * radius[i] * radius[i] * length(i);
}

void Tree::validate() const {
  const std::size_t n = size();
  const auto same_length = [n](const auto&... column) { return ((column.size() == n) && ...); };
  if (!same_length(start, parent, radius, axis, order, birth_cycle, quality, radius_se))
    throw InputError("tree: its columns differ in length");
  const std::int32_t axes = axis_count();
  std::vector<std::int32_t> last(static_cast<std::size_t>(std::max(axes, 0)), -1);
  for (std::size_t i = 0; i < n; ++i) {
    if (!start[i].allFinite() || !end[i].allFinite()) broken(i, "a coordinate is not a finite number");
    if (!(length(i) > 0)) broken(i, "length 0: a cylinder needs two different ends");
    if (!std::isfinite(radius[i]) || radius[i] <= 0)
      broken(i, "radius " + std::to_string(radius[i]) + ": must be positive");
    const std::int32_t p = parent[i];
    if (p < -1 || p >= static_cast<std::int32_t>(i))
      broken(i, "parent " + std::to_string(p + 1) + ": parents come before children (0 = none)");
    if (axis[i] < 0) broken(i, "axis " + std::to_string(axis[i] + 1) + ": ids start at 1");
    if (order[i] < 0) broken(i, "order " + std::to_string(order[i]) + ": must not be negative");
    std::int32_t& previous = last[static_cast<std::size_t>(axis[i])];
    if (previous >= 0) {
      if (p != previous) broken(i, "its axis is not an unbranched run of cylinders");
      if (order[i] != order[static_cast<std::size_t>(p)]) broken(i, "order changes along its axis");
    } else if (p < 0) {
      if (order[i] != 0) broken(i, "order " + std::to_string(order[i]) + ": a root has order 0");
    } else if (order[i] <= order[static_cast<std::size_t>(p)]) {
      broken(i, "order " + std::to_string(order[i]) + ": must be above its parent's");
    }
    previous = static_cast<std::int32_t>(i);
  }
}

}  // namespace dendrofit
