// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/metrics.h"

#include "core/convex_hull.h"
#include "core/errors.h"
#include "core/tree_topology.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <Eigen/Geometry>

namespace dendrofit {
namespace {

// A twig low on the stem does not start the crown: only branches of this length count, if there are any.
constexpr double kCrownBranchShareOfHeight = 0.1;
constexpr double kBranchBase_m = 0.1;  // over which a branch's angle is taken

double top_of(const Tree& tree) {
  double top = -1e300;
  for (std::size_t i = 0; i < tree.size(); ++i) top = std::max({top, tree.start[i].z(), tree.end[i].z()});
  return top;
}

/// Diameter along one axis at height z, linear between cylinder midpoints.
std::optional<double> axis_diameter(const Tree& tree, const Axis& axis, double z) {
  std::optional<double> diameter;
  for (std::size_t k = 0; k < axis.nodes.size(); ++k) {
    const auto i = static_cast<std::size_t>(axis.nodes[k]);
    const double lo = std::min(tree.start[i].z(), tree.end[i].z());
    const double hi = std::max(tree.start[i].z(), tree.end[i].z());
    if (z < lo || z > hi) continue;
    const double middle = 0.5 * (lo + hi);
    const bool upper = (z > middle) == (tree.end[i].z() >= tree.start[i].z());
    double radius = tree.radius[i];
    if ((upper && k + 1 < axis.nodes.size()) || (!upper && k > 0)) {
      const auto j = static_cast<std::size_t>(axis.nodes[upper ? k + 1 : k - 1]);
      const double other = 0.5 * (tree.start[j].z() + tree.end[j].z());
      const double w = other == middle ? 0 : std::clamp((z - middle) / (other - middle), 0.0, 1.0);
      radius = (1 - w) * radius + w * tree.radius[j];
    }
    diameter = std::max(diameter.value_or(0), 2 * radius);
  }
  return diameter;
}

template <class Column>
auto& slot(Column& column, std::size_t index) {
  if (column.size() <= index) column.resize(index + 1);
  return column[index];
}

void add_wood(const Tree& tree, TreeMetrics& m) {
  for (std::size_t i = 0; i < tree.size(); ++i) {
    const double volume = tree.volume(i);
    const auto order = static_cast<std::size_t>(tree.order[i]);
    (order == 0 ? m.stem_volume_m3 : m.branch_volume_m3) += volume;
    m.wood_area_m2 += 2 * std::numbers::pi * tree.radius[i] * tree.length(i);
    m.total_length_m += tree.length(i);
    slot(m.length_by_order_m, order) += tree.length(i);
    slot(m.volume_by_order_m3, order) += volume;
    slot(m.volume_by_diameter_class_m3, static_cast<std::size_t>(2 * tree.radius[i] / m.diameter_class_m)) +=
        volume;
  }
  m.total_volume_m3 = m.stem_volume_m3 + m.branch_volume_m3;
}

std::optional<double> crown_base(const std::vector<Axis>& axes, const Tree& tree, double foot,
                                 double height) {
  std::optional<double> lowest;
  for (const double shortest : {kCrownBranchShareOfHeight * height, 0.0}) {
    for (const Axis& axis : axes) {
      if (axis.order != 1 || axis.length < shortest) continue;
      const double z = tree.start[static_cast<std::size_t>(axis.nodes.front())].z() - foot;
      lowest = std::min(lowest.value_or(z), z);
    }
    if (lowest) break;
  }
  return lowest;
}

/// Mean angle between branches and their bearers by order.
std::vector<double> branch_angles(const std::vector<Axis>& axes, const Tree& tree) {
  std::vector<double> sum, count;
  for (const Axis& axis : axes) {
    if (axis.nodes.empty()) continue;
    const auto first = static_cast<std::size_t>(axis.nodes.front());
    const auto order = static_cast<std::size_t>(axis.order);
    slot(sum, order);
    slot(count, order);
    if (tree.parent[first] < 0) continue;
    const Vec3 bearer = tree.direction(static_cast<std::size_t>(tree.parent[first]));
    Vec3 run = Vec3::Zero();
    for (const std::int32_t n : axis.nodes) {
      run = tree.end[static_cast<std::size_t>(n)] - tree.start[first];
      if (run.norm() >= kBranchBase_m) break;
    }
    sum[order] += std::atan2(run.cross(bearer).norm(), run.dot(bearer)) * 180 / std::numbers::pi;
    count[order] += 1;
  }
  for (std::size_t k = 0; k < sum.size(); ++k)
    if (count[k] > 0) sum[k] /= count[k];
  return sum;
}

const Axis* main_stem(const std::vector<Axis>& axes, const Tree& tree) {
  const Axis* best = nullptr;
  double most = -1;
  for (const Axis& axis : axes) {
    if (axis.order != 0 || axis.nodes.empty()) continue;
    double volume = 0;
    for (const std::int32_t i : axis.nodes) volume += tree.volume(static_cast<std::size_t>(i));
    if (volume > most) {
      most = volume;
      best = &axis;
    }
  }
  return best;
}

}  // namespace

void MetricsOptions::validate() const {
  require(std::isfinite(dbh_height_m) && dbh_height_m > 0, "dbh_height_m", dbh_height_m, "must be positive");
}

double foot_height(const Tree& tree) {
  double foot = 1e300;
  for (std::size_t i = 0; i < tree.size(); ++i)
    if (tree.parent[i] < 0) foot = std::min(foot, tree.start[i].z());
  return foot;
}

std::optional<double> stem_diameter(const Tree& tree, double height_m) {
  const double z = foot_height(tree) + height_m;
  std::optional<double> thickest;
  for (const Axis& axis : axes_of(tree)) {
    if (axis.order != 0) continue;
    if (const auto d = axis_diameter(tree, axis, z)) thickest = std::max(thickest.value_or(0), *d);
  }
  return thickest;
}

std::vector<LeafLayer> leaf_layers(const std::vector<Vec3>& leaves, double foot_z) {
  constexpr double kDepth_m = 0.5;
  std::vector<LeafLayer> layers;
  if (leaves.empty()) return layers;
  const auto layer = [&](const Vec3& p) { return static_cast<int>(std::floor((p.z() - foot_z) / kDepth_m)); };
  int lowest = layer(leaves.front()), highest = lowest;
  for (const Vec3& p : leaves) {
    lowest = std::min(lowest, layer(p));
    highest = std::max(highest, layer(p));
  }
  for (int k = lowest; k <= highest; ++k) layers.push_back({k * kDepth_m, (k + 1) * kDepth_m, 0});
  for (const Vec3& p : leaves) ++layers[static_cast<std::size_t>(layer(p) - lowest)].points;
  return layers;
}

TreeMetrics measure(const Tree& tree, const MetricsOptions& options, const std::vector<Vec3>& foliage) {
  options.validate();
  if (tree.empty()) throw InputError("the tree has no cylinder: nothing to measure");
  const std::vector<Axis> axes = axes_of(tree);
  const double foot = foot_height(tree);

  TreeMetrics m;
  m.dbh_height_m = options.dbh_height_m;
  m.height_m = top_of(tree) - foot;
  add_wood(tree, m);
  for (const Axis& axis : axes)
    if (!axis.nodes.empty()) ++slot(m.branch_count_by_order, static_cast<std::size_t>(axis.order));
  if (m.height_m >= options.dbh_height_m) m.dbh_m = stem_diameter(tree, options.dbh_height_m);
  m.branch_angle_by_order_deg = branch_angles(axes, tree);
  m.crown_base_m = crown_base(axes, tree, foot, m.height_m);

  std::vector<Vec3> crown;
  const auto add_to_crown = [&](const Vec3& p) {
    if (m.crown_base_m && p.z() - foot >= *m.crown_base_m) crown.push_back(p);
  };
  for (const Vec3& p : tree.end) add_to_crown(p);
  for (const Vec3& p : foliage) add_to_crown(p);
  const PlanHull plan = plan_hull(crown);
  m.crown_area_m2 = plan.area_m2;
  m.crown_diameter_m = plan.perimeter_m / std::numbers::pi;
  m.crown_volume_m3 = hull_volume(crown);

  if (const Axis* stem = main_stem(axes, tree)) {
    const Vec3 run = tree.end[static_cast<std::size_t>(stem->nodes.back())] -
                     tree.start[static_cast<std::size_t>(stem->nodes.front())];
    m.lean_deg = std::atan2(run.head<2>().norm(), run.z()) * 180 / std::numbers::pi;
    const double azimuth = std::atan2(run.x(), run.y()) * 180 / std::numbers::pi;
    m.lean_azimuth_deg = azimuth < 0 ? azimuth + 360 : azimuth;
    const double per_metre = m.height_m > 10 ? 2 : 10;
    for (int k = 0; k / per_metre <= m.height_m; ++k)
      if (const auto d = axis_diameter(tree, *stem, foot + k / per_metre))
        m.stem_taper.push_back({k / per_metre, *d});
  }
  return m;
}

}  // namespace dendrofit
