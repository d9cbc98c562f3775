// SPDX-License-Identifier: GPL-3.0-or-later
#include "fit/descriptors.h"

#include "core/errors.h"
#include "core/metrics.h"
#include "core/tree_topology.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

namespace dendrofit {

struct DescriptorInput {
  Tree tree;  ///< comparable_tree
  std::vector<Axis> axes;
  Vec3 foot = Vec3::Zero();
  double height = 0;
  double total_volume = 0;
  double total_length = 0;
  double length_centroid = 0;  ///< height of the wood length's centroid above the foot
  std::vector<std::pair<double, double>>
      volume_by_height;  ///< (height of the piece's middle, volume), rising
  std::vector<std::pair<double, double>>
      reach;  ///< (relative height, horizontal distance from the stem foot)
  std::optional<double> dbh;
};

namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
constexpr double kDegrees = 180 / std::numbers::pi;

double log_or_none(double value) {
  return value > 0 ? std::log(value) : kNone;
}

/// Share of the wood volume below `share` of the height.
double volume_below(const DescriptorInput& in, double share) {
  double below = 0;
  for (const auto& [z, volume] : in.volume_by_height) {
    if (z > share * in.height) break;
    below += volume;
  }
  return in.total_volume > 0 ? below / in.total_volume : kNone;
}

/// 90th percentile of the horizontal reach within a fifth of the height about `centre` (relative), over the
/// height.
double reach_at(const DescriptorInput& in, double centre) {
  std::vector<double> band;
  for (const auto& [z, distance] : in.reach)
    if (std::abs(z - centre) <= 0.1) band.push_back(distance);
  if (band.empty()) return std::log(0.02);
  auto at = band.begin() + static_cast<std::ptrdiff_t>(0.9 * static_cast<double>(band.size() - 1));
  std::nth_element(band.begin(), at, band.end());
  return std::log(*at / in.height + 0.02);
}

double taper(const DescriptorInput& in, double share) {
  const auto d = stem_diameter(in.tree, share * in.height);
  return d && in.dbh ? *d / *in.dbh : kNone;
}

template <class Value>
double mean_over_axes(const DescriptorInput& in, int order, Value value) {
  double sum = 0;
  int count = 0;
  for (const Axis& axis : in.axes) {
    if (axis.order != order || axis.parent_node < 0) continue;
    sum += value(axis);
    ++count;
  }
  return count > 0 ? sum / count : kNone;
}

int axis_count(const DescriptorInput& in, int order) {
  return static_cast<int>(
      std::count_if(in.axes.begin(), in.axes.end(), [&](const Axis& a) { return a.order == order; }));
}

/// Direction of an axis over its first tenth (at least its first node): the angle at which it leaves its
/// parent.
Vec3 first_direction(const Tree& tree, const Axis& axis, double length) {
  const Vec3 base = tree.start[static_cast<std::size_t>(axis.nodes.front())];
  double run = 0;
  Vec3 tip = base;
  for (const std::int32_t i : axis.nodes) {
    run += tree.length(static_cast<std::size_t>(i));
    tip = tree.end[static_cast<std::size_t>(i)];
    if (run >= length) break;
  }
  return (tip - base).normalized();
}

double insertion_angle(const DescriptorInput& in, const Axis& axis) {
  const Vec3 parent = in.tree.direction(static_cast<std::size_t>(axis.parent_node));
  const Vec3 own = first_direction(in.tree, axis, 0.25 * axis.length);
  return std::acos(std::clamp(parent.dot(own), -1.0, 1.0)) * kDegrees;
}

/// Elevation of an axis' chord above the horizontal, degrees: droop shows here.
double chord_elevation(const DescriptorInput& in, const Axis& axis) {
  const Vec3 chord = in.tree.end[static_cast<std::size_t>(axis.nodes.back())] -
                     in.tree.start[static_cast<std::size_t>(axis.nodes.front())];
  return std::atan2(chord.z(), chord.head<2>().norm()) * kDegrees;
}

double angle_spread(const DescriptorInput& in) {
  const double mean = mean_over_axes(in, 1, [&](const Axis& a) { return insertion_angle(in, a); });
  const double square =
      mean_over_axes(in, 1, [&](const Axis& a) { return std::pow(insertion_angle(in, a) - mean, 2); });
  return axis_count(in, 1) >= 3 ? std::sqrt(square) : kNone;
}

double crown_base(const DescriptorInput& in) {
  const auto base = measure(in.tree).crown_base_m;
  return base ? *base / in.height : kNone;
}

using In = const DescriptorInput&;

constexpr auto kTable = std::to_array<DescriptorRow>({
    {"height", "log m", 0.01, "height of the highest wood above the foot",
     [](In in) { return log_or_none(in.height); }},
    {"dbh", "log m", 0.03, "stem diameter at 1.3 m",
     [](In in) { return in.dbh ? log_or_none(*in.dbh) : kNone; }},
    {"volume", "log m3", 0.08, "volume of the visible wood",
     [](In in) { return log_or_none(in.total_volume); }},
    {"length", "log", 0.15, "length of the visible wood over the height",
     [](In in) { return log_or_none(in.total_length / in.height); }},
    {"volume_below_10", "", 0.02, "share of wood volume in the lowest tenth",
     [](In in) { return volume_below(in, 0.10); }},
    {"volume_below_25", "", 0.02, "share of wood volume in the lowest quarter",
     [](In in) { return volume_below(in, 0.25); }},
    {"volume_below_50", "", 0.02, "share of wood volume in the lower half",
     [](In in) { return volume_below(in, 0.50); }},
    {"volume_below_75", "", 0.01, "share of wood volume in the lower three quarters",
     [](In in) { return volume_below(in, 0.75); }},
    {"length_centroid", "", 0.03, "height of the wood length's centroid over the height",
     [](In in) { return in.length_centroid / in.height; }},
    {"reach_20", "log", 0.08, "crown radius about 0.2 of the height, over the height",
     [](In in) { return reach_at(in, 0.2); }},
    {"reach_40", "log", 0.08, "crown radius about 0.4 of the height, over the height",
     [](In in) { return reach_at(in, 0.4); }},
    {"reach_60", "log", 0.08, "crown radius about 0.6 of the height, over the height",
     [](In in) { return reach_at(in, 0.6); }},
    {"reach_80", "log", 0.08, "crown radius about 0.8 of the height, over the height",
     [](In in) { return reach_at(in, 0.8); }},
    {"crown_base", "", 0.03, "height of the lowest long branch over the height", crown_base},
    {"taper_35", "", 0.05, "stem diameter at 0.35 of the height over DBH",
     [](In in) { return taper(in, 0.35); }},
    {"taper_65", "", 0.05, "stem diameter at 0.65 of the height over DBH",
     [](In in) { return taper(in, 0.65); }},
    {"branches_1", "log", 0.15, "number of first-order branches (plus one)",
     [](In in) { return std::log(1.0 + axis_count(in, 1)); }},
    {"branches_2_per_1", "log", 0.25, "second-order branches per first-order branch (plus one)",
     [](In in) {
       const int first = axis_count(in, 1);
       return first > 0 ? std::log(1.0 + double(axis_count(in, 2)) / first) : kNone;
     }},
    {"branch_length_1", "log", 0.10, "mean length of first-order branches over the height",
     [](In in) {
       return log_or_none(mean_over_axes(in, 1, [](const Axis& a) { return a.length; }) / in.height);
     }},
    {"insertion_1", "deg", 3, "mean angle at which first-order branches leave the stem",
     [](In in) { return mean_over_axes(in, 1, [&](const Axis& a) { return insertion_angle(in, a); }); }},
    {"insertion_spread_1", "deg", 3, "standard deviation of that angle", angle_spread},
    {"insertion_2", "deg", 4, "mean angle at which second-order branches leave theirs",
     [](In in) { return mean_over_axes(in, 2, [&](const Axis& a) { return insertion_angle(in, a); }); }},
    {"elevation_1", "deg", 3, "mean elevation of first-order branches' chords above the horizontal",
     [](In in) { return mean_over_axes(in, 1, [&](const Axis& a) { return chord_elevation(in, a); }); }},
});

DescriptorInput analyse(const Tree& tree, const DescribeOptions& options) {
  DescriptorInput in;
  in.tree = comparable_tree(tree, options);
  const Tree& t = in.tree;
  in.axes = axes_of(t);
  const double foot_z = foot_height(t);
  // The height is the whole tree's: a scan sees the top even where its twigs are too thin to compare.
  double top = foot_z;
  for (std::size_t i = 0; i < tree.size(); ++i) top = std::max({top, tree.start[i].z(), tree.end[i].z()});
  in.foot = t.start.front();
  in.volume_by_height.reserve(t.size());
  in.reach.reserve(t.size());
  for (std::size_t i = 0; i < t.size(); ++i) {
    const Vec3 middle = 0.5 * (t.start[i] + t.end[i]);
    in.volume_by_height.emplace_back(middle.z() - foot_z, t.volume(i));
    in.total_volume += t.volume(i);
    in.total_length += t.length(i);
    in.length_centroid += t.length(i) * (middle.z() - foot_z);
  }
  in.height = top - foot_z;
  in.length_centroid /= in.total_length;
  std::sort(in.volume_by_height.begin(), in.volume_by_height.end());
  for (std::size_t i = 0; i < t.size(); ++i)
    in.reach.emplace_back((t.end[i].z() - foot_z) / in.height, (t.end[i] - in.foot).head<2>().norm());
  in.dbh = stem_diameter(t, 1.3);
  return in;
}

}  // namespace

void DescribeOptions::validate() const {
  require(std::isfinite(visible_radius_m) && visible_radius_m >= 0, "visible_radius_m", visible_radius_m,
          "must not be negative");
  require(std::isfinite(shortest_axis_m) && shortest_axis_m >= 0, "shortest_axis_m", shortest_axis_m,
          "must not be negative");
}

Tree comparable_tree(const Tree& tree, const DescribeOptions& options) {
  options.validate();
  if (tree.empty()) throw InputError("the tree has no cylinder: nothing to describe");
  std::vector<char> keep(tree.size());
  for (std::size_t i = 0; i < tree.size(); ++i) {
    const std::int32_t p = tree.parent[i];
    // A root stays whatever its radius, so that the thinnest sapling still is a tree.
    keep[i] = p < 0 || (keep[static_cast<std::size_t>(p)] && tree.radius[i] >= options.visible_radius_m);
  }
  Tree part = subset(tree, keep);
  assign_axes_by_thickness(part);
  const std::vector<Axis> axes = axes_of(part);
  keep.assign(part.size(), 1);
  for (std::size_t i = 0; i < part.size(); ++i) {
    const Axis& axis = axes[static_cast<std::size_t>(part.axis[i])];
    const bool parent_kept = part.parent[i] < 0 || keep[static_cast<std::size_t>(part.parent[i])];
    keep[i] = parent_kept && (axis.parent_node < 0 || axis.length >= options.shortest_axis_m);
  }
  return subset(part, keep);
}

std::span<const DescriptorRow> descriptor_table() {
  return kTable;
}

std::vector<double> describe(const Tree& tree, const DescribeOptions& options) {
  const DescriptorInput in = analyse(tree, options);
  std::vector<double> values;
  values.reserve(kTable.size());
  for (const DescriptorRow& row : kTable) values.push_back(row.compute(in));
  return values;
}

}  // namespace dendrofit
