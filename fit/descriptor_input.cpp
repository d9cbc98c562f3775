// SPDX-License-Identifier: GPL-3.0-or-later
#include "fit/descriptor_input.h"

#include "core/errors.h"
#include "core/metrics.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace dendrofit {
namespace {

constexpr double kDegrees = 180 / std::numbers::pi;
constexpr double kReferenceHeight = 0.1;      // share of the height at which the stem is measured
constexpr double kSamplesPerHeight = 200;     // along the wood
constexpr double kStraightnessSteps = 40;     // of the height
constexpr double kThinnestInScan = 0.004;     // radius, metres
constexpr double kThinnestInPicture = 0.008;  // radius, metres

double height_of(const Tree& tree) {
  const double foot = foot_height(tree);
  double top = foot;
  for (std::size_t i = 0; i < tree.size(); ++i) top = std::max({top, tree.start[i].z(), tree.end[i].z()});
  return top - foot;
}

/// Point of an axis at this length from its base.
Vec3 point_along(const Tree& tree, const Axis& axis, double length) {
  double run = 0;
  for (const std::int32_t node : axis.nodes) {
    const auto i = static_cast<std::size_t>(node);
    const double piece = tree.length(i);
    if (run + piece >= length) return tree.start[i] + (length - run) / piece * (tree.end[i] - tree.start[i]);
    run += piece;
  }
  return tree.end[static_cast<std::size_t>(axis.nodes.back())];
}

std::optional<double> fork_exponent(double parent, const std::vector<double>& children) {
  const auto excess = [&](double v) {
    double sum = 0;
    for (const double child : children) sum += std::pow(child / parent, v);
    return sum - 1;
  };
  double lo = 1.2;
  double hi = 5;
  if (excess(lo) < 0 || excess(hi) > 0) return {};
  for (int i = 0; i < 40; ++i) (excess(0.5 * (lo + hi)) > 0 ? lo : hi) = 0.5 * (lo + hi);
  return 0.5 * (lo + hi);
}

void add_wood(DescriptorInput& in) {
  const Tree& t = in.tree;
  const double foot_z = foot_height(t);
  const double step = in.height / kSamplesPerHeight;
  in.volume_by_height.reserve(t.size());
  std::vector<double> path(t.size());
  std::vector<char> tip(t.size(), 1);
  double left_over = 0;
  for (std::size_t i = 0; i < t.size(); ++i) {
    const Vec3 start = t.start[i] - in.foot;
    const Vec3 run = t.end[i] - t.start[i];
    const double length = t.length(i);
    const Vec3 middle = start + 0.5 * run;
    in.volume_by_height.emplace_back(t.start[i].z() + 0.5 * run.z() - foot_z, t.volume(i));
    in.total_volume += t.volume(i);
    in.total_length += length;
    in.length_centroid += length * (t.start[i].z() + 0.5 * run.z() - foot_z);
    in.spread += length * middle.head<2>().norm();
    for (; left_over < length; left_over += step) in.samples.push_back(start + left_over / length * run);
    left_over -= length;
    path[i] = length;
    if (t.parent[i] < 0) continue;
    path[i] += path[static_cast<std::size_t>(t.parent[i])];
    tip[static_cast<std::size_t>(t.parent[i])] = 0;
  }
  for (std::size_t i = 0; i < t.size(); ++i)
    if (tip[i]) in.path_lengths.push_back(path[i]);
  std::sort(in.path_lengths.begin(), in.path_lengths.end());
  std::sort(in.volume_by_height.begin(), in.volume_by_height.end());
  in.length_centroid /= in.total_length;
  in.spread /= in.total_length;
}

}  // namespace

double reference_radius(const Tree& tree) {
  if (const auto d = stem_diameter(tree, kReferenceHeight * height_of(tree))) return 0.5 * *d;
  double radius = 0;
  for (std::size_t i = 0; i < tree.size(); ++i)
    if (tree.parent[i] < 0) radius = std::max(radius, tree.radius[i]);
  return radius;
}

std::size_t comparison_level(const Tree& tree, ObservedFrom from) {
  if (from == ObservedFrom::exact) return 0;
  const double thinnest = from == ObservedFrom::scan ? kThinnestInScan : kThinnestInPicture;
  const double radius = reference_radius(tree);
  std::size_t level = 0;
  while (level + 1 < kVisibleShares.size() && kVisibleShares[level] * radius < thinnest) ++level;
  return level;
}

void DescribeOptions::validate() const {
  require(std::isfinite(visible_share) && visible_share >= 0 && visible_share < 1, "visible_share",
          visible_share, "must lie in [0, 1)");
  require(std::isfinite(shortest_axis_share) && shortest_axis_share >= 0, "shortest_axis_share",
          shortest_axis_share, "must not be negative");
  require(std::isfinite(internode_length_m) && internode_length_m > 0, "internode_length_m",
          internode_length_m, "must be positive");
}

Tree without_thin_wood(const Tree& tree, double radius_m) {
  std::vector<char> keep(tree.size());
  for (std::size_t i = 0; i < tree.size(); ++i) {
    const std::int32_t p = tree.parent[i];
    // A root stays whatever its radius, so that the thinnest sapling still is a tree.
    keep[i] = p < 0 || (keep[static_cast<std::size_t>(p)] && tree.radius[i] >= radius_m);
  }
  return subset(tree, keep);
}

Tree comparable_tree(const Tree& tree, const DescribeOptions& options) {
  options.validate();
  if (tree.empty()) throw InputError("the tree has no cylinder: nothing to describe");
  Tree whole = tree;
  assign_axes_by_thickness(whole);
  const double shortest = options.shortest_axis_share * height_of(whole);
  Tree part = without_thin_wood(whole, options.visible_share * reference_radius(whole));
  assign_axes_by_thickness(part);
  const std::vector<Axis> axes = axes_of(part);
  std::vector<char> keep(part.size(), 1);
  for (std::size_t i = 0; i < part.size(); ++i) {
    const Axis& axis = axes[static_cast<std::size_t>(part.axis[i])];
    const bool parent_kept = part.parent[i] < 0 || keep[static_cast<std::size_t>(part.parent[i])];
    keep[i] = parent_kept && (axis.parent_node < 0 || axis.length >= shortest);
  }
  return subset(part, keep);
}

DescriptorInput analyse(const Tree& tree, const DescribeOptions& options) {
  DescriptorInput in;
  in.tree = comparable_tree(tree, options);
  in.axes = axes_of(in.tree);
  in.foot = in.tree.start.front();
  in.height = height_of(tree);
  in.internode_length = options.internode_length_m;
  in.base_diameter = 2 * reference_radius(in.tree);
  in.fork_exponents = fork_exponents(in.tree);
  add_wood(in);
  return in;
}

bool is_branch(const Axis& axis, int order) {
  return axis.order == order && axis.parent_node >= 0;
}

int branch_count(const DescriptorInput& in, int order) {
  return static_cast<int>(
      std::count_if(in.axes.begin(), in.axes.end(), [&](const Axis& a) { return is_branch(a, order); }));
}

std::vector<double> over_branches(const DescriptorInput& in, int order,
                                  const std::function<double(const Axis&)>& value) {
  std::vector<double> values;
  for (const Axis& axis : in.axes)
    if (is_branch(axis, order)) values.push_back(value(axis));
  std::sort(values.begin(), values.end());
  return values;
}

double insertion_angle(const DescriptorInput& in, const Axis& axis) {
  const Vec3 parent = in.tree.direction(static_cast<std::size_t>(axis.parent_node));
  const Vec3 base = in.tree.start[static_cast<std::size_t>(axis.nodes.front())];
  const Vec3 own = point_along(in.tree, axis, 0.25 * axis.length) - base;
  return std::acos(std::clamp(parent.dot(own.normalized()), -1.0, 1.0)) * kDegrees;
}

double elevation(const DescriptorInput& in, const Axis& axis, double from, double to) {
  const Vec3 chord =
      point_along(in.tree, axis, to * axis.length) - point_along(in.tree, axis, from * axis.length);
  return std::atan2(chord.z(), chord.head<2>().norm()) * kDegrees;
}

double radius_ratio(const DescriptorInput& in, const Axis& axis) {
  return in.tree.radius[static_cast<std::size_t>(axis.nodes.front())] /
         in.tree.radius[static_cast<std::size_t>(axis.parent_node)];
}

double straightness(const DescriptorInput& in, const Axis& axis) {
  const double step = in.height / kStraightnessSteps;
  const int pieces = std::max(1, static_cast<int>(axis.length / step));
  const Vec3 base = in.tree.start[static_cast<std::size_t>(axis.nodes.front())];
  Vec3 last = base;
  double run = 0;
  for (int k = 1; k <= pieces; ++k) {
    const Vec3 next = point_along(in.tree, axis, axis.length * k / pieces);
    run += (next - last).norm();
    last = next;
  }
  return run > 0 ? (last - base).norm() / run : 1;
}

double base_height(const DescriptorInput& in, const Axis& axis) {
  return (in.tree.start[static_cast<std::size_t>(axis.nodes.front())].z() - foot_height(in.tree)) / in.height;
}

std::vector<double> fork_exponents(const Tree& tree) {
  const TreeChildren children(tree);
  std::vector<double> exponents;
  for (std::size_t i = 0; i < tree.size(); ++i) {
    const auto of = children.of(i);
    if (of.size() < 2 || tree.quality[i] != RadiusQuality::measured) continue;
    std::vector<double> radii;
    bool measured = true;
    for (const std::int32_t c : of) {
      measured &= tree.quality[static_cast<std::size_t>(c)] == RadiusQuality::measured;
      radii.push_back(tree.radius[static_cast<std::size_t>(c)]);
    }
    if (!measured) continue;
    if (const auto v = fork_exponent(tree.radius[i], radii)) exponents.push_back(*v);
  }
  std::sort(exponents.begin(), exponents.end());
  return exponents;
}

}  // namespace dendrofit
