// SPDX-License-Identifier: GPL-3.0-or-later
#include "forward/igm/start.h"

#include "core/errors.h"
#include "core/tree_topology.h"
#include "forward/growth_equations.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace dendrofit::igm {
namespace {

constexpr double kSameLength = 1e-3;  // relative: an internode of this model already

// One axis of the given tree as points about rho apart.
struct Course {
  std::vector<Vec3> point;         // without the foot
  std::vector<std::int32_t> from;  // the given tree's node each lies on
  double length = 0;
};

Course divide(const Tree& tree, const std::vector<std::int32_t>& nodes, double rho) {
  Course course;
  bool even = true;
  for (const std::int32_t node : nodes) {
    const double length = tree.length(static_cast<std::size_t>(node));
    course.length += length;
    even = even && std::abs(length - rho) <= kSameLength * rho;
  }
  if (even) {
    for (const std::int32_t node : nodes) course.point.push_back(tree.end[static_cast<std::size_t>(node)]);
    course.from = nodes;
    return course;
  }
  const int count = std::max(1, static_cast<int>(std::lround(course.length / rho)));
  double behind = 0;
  std::size_t j = 0;
  for (int m = 1; m <= count; ++m) {
    const double arc = course.length * m / count;
    while (j + 1 < nodes.size() && behind + tree.length(static_cast<std::size_t>(nodes[j])) < arc)
      behind += tree.length(static_cast<std::size_t>(nodes[j++]));
    const auto node = static_cast<std::size_t>(nodes[j]);
    const double part = m == count ? 1.0 : std::min(1.0, (arc - behind) / tree.length(node));
    course.point.push_back(tree.start[node] + part * (tree.end[node] - tree.start[node]));
    course.from.push_back(nodes[j]);
  }
  return course;
}

// Age at which the equation gives a tree of so many internodes; its late years where it never does.
double age_at(const IgmParameters& p, double internodes) {
  const GrowthEquation& equation = growth_equation(p.equation);
  const double most = 0.98 * equation.asymptote(p.equation_values);
  const double age = equation.age_at(p.equation_values, std::min(internodes, most));
  return std::isfinite(age) ? std::max(0.0, age) : 0.0;
}

}  // namespace

void plant_seedling(Stand& stand, int tree, const Vec3& root, int cycle) {
  const IgmParameters& p = stand.parameters[static_cast<std::size_t>(tree)];
  stand.plants.push_back({tree, root, 0});
  const std::int32_t trunk = stand.add_axis(-1, static_cast<std::int32_t>(stand.plants.size()) - 1, 1);
  const double pipe = std::pow(p.tip_radius_m, p.pipe_exponent);
  for (int i = 1; i <= kSeedlingInternodes; ++i)
    stand.add_node(trunk, root + Vec3(0, 0, i * p.rho_m), cycle, pipe);
}

int plant_tree(Stand& stand, int tree, const Tree& grown, const Vec3& frame_shift, std::optional<int> cycle) {
  grown.validate();
  if (grown.empty()) throw InputError("start: the tree has no cylinders; nothing to go on from");
  const IgmParameters& p = stand.parameters[static_cast<std::size_t>(tree)];
  const std::vector<Axis> axes = axes_of(grown);
  std::vector<std::int32_t> plant_of(axes.size(), -1), axis_of(axes.size(), -1);
  std::vector<std::vector<std::int32_t>> made(axes.size());  // nodes of the stand along each axis
  std::vector<Course> course(axes.size());
  std::vector<std::int32_t> depth;  // internodes down to the foot, by node of the stand
  std::vector<std::int32_t> known;  // birth cycle as given

  // An axis is made once the one it grows from is; ids need not be in that order.
  std::vector<std::size_t> order(axes.size());
  for (std::size_t a = 0; a < axes.size(); ++a) order[a] = a;
  std::sort(order.begin(), order.end(),
            [&](std::size_t a, std::size_t b) { return axes[a].nodes[0] < axes[b].nodes[0]; });
  const std::size_t first_node = stand.nodes.size();
  for (const std::size_t a : order) {
    const auto foot = static_cast<std::size_t>(axes[a].nodes[0]);
    course[a] = divide(grown, axes[a].nodes, p.rho_m);
    std::int32_t base = -1;
    if (axes[a].parent_axis < 0) {
      stand.plants.push_back({tree, grown.start[foot] + frame_shift, 0});
      plant_of[a] = static_cast<std::int32_t>(stand.plants.size()) - 1;
    } else {
      const auto bearer = static_cast<std::size_t>(axes[a].parent_axis);
      plant_of[a] = plant_of[bearer];
      double nearest = 1e300;
      for (std::size_t j = 0; j < made[bearer].size(); ++j) {
        const double d = (course[bearer].point[j] - grown.start[foot]).squaredNorm();
        if (d < nearest) nearest = d, base = made[bearer][j];
      }
    }
    const std::int32_t bearer_order =
        base < 0
            ? 0
            : stand.axes.order[static_cast<std::size_t>(stand.nodes.axis[static_cast<std::size_t>(base)])];
    axis_of[a] = stand.add_axis(base, plant_of[a], bearer_order + 1);
    std::int32_t below = base < 0 ? 0 : depth[static_cast<std::size_t>(base) - first_node];
    Vec3 last = base < 0 ? Vec3(grown.start[foot] + frame_shift)
                         : stand.nodes.position[static_cast<std::size_t>(base)];
    for (std::size_t j = 0; j < course[a].point.size(); ++j) {
      const auto node = static_cast<std::size_t>(course[a].from[j]);
      const Vec3 at = course[a].point[j] + frame_shift;
      if ((at - last).norm() < 1e-6) continue;  // a twig that ends where its bearer's node is
      made[a].push_back(stand.add_node(axis_of[a], at, 0, std::pow(grown.radius[node], p.pipe_exponent)));
      last = at;
      depth.push_back(++below);
      known.push_back(grown.birth_cycle[node]);
    }
    if (made[a].empty()) {  // keep the axis: one internode straight on
      made[a].push_back(stand.add_node(axis_of[a], last + p.rho_m * grown.direction(foot), 0,
                                       std::pow(grown.radius[foot], p.pipe_exponent)));
      depth.push_back(++below);
      known.push_back(grown.birth_cycle[foot]);
    }
    if (made[a].size() != course[a].point.size()) {
      course[a].point.clear();
      for (const std::int32_t node : made[a])
        course[a].point.push_back(stand.nodes.position[static_cast<std::size_t>(node)] - frame_shift);
    }
  }

  const std::int32_t deepest = *std::max_element(depth.begin(), depth.end());
  const bool all_known = std::all_of(known.begin(), known.end(), [](std::int32_t b) { return b >= 0; });
  const int now = cycle       ? *cycle
                  : all_known ? *std::max_element(known.begin(), known.end())
                              : std::max(1, static_cast<int>(std::lround(age_at(p, deepest))));
  for (std::size_t j = 0; j < depth.size(); ++j) {
    const int estimate = static_cast<int>(std::lround(age_at(p, depth[j])));
    stand.nodes.birth[first_node + j] = std::clamp(known[j] >= 0 ? known[j] : estimate, 0, now);
  }
  return now;
}

}  // namespace dendrofit::igm
