// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/recon_cases.h"

#include "core/random.h"
#include "core/tree_topology.h"
#include "forward/igm/grow.h"
#include "forward/leaves/insert_leaves.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <Eigen/Geometry>

namespace dendrofit::bench {
namespace {

struct Habit {
  double stem_radius_share;  // of the height
  double crown_base_share;   // of the height
  double per_metre;          // first-order branches
  double angle_deg, angle_top_deg;
  double length_share;  // of the height, longest branch
  double radius_share;  // of the bearer's radius
  double bend;          // radians a step
};

constexpr Habit kHabits[3] = {{0.013, 0.25, 3.0, 65, 40, 0.35, 0.45, 0.035},   // broad
                              {0.010, 0.20, 5.0, 90, 55, 0.22, 0.22, 0.020},   // slender, many thin branches
                              {0.017, 0.15, 4.5, 55, 45, 0.40, 0.55, 0.050}};  // bushy

/// Draws axes one within another.
class Drawer {
 public:
  Drawer(const Habit& habit, std::uint64_t seed) : habit_(habit), random_(Random(seed).child({77})) {}

  Tree draw(double height) {
    axis(-1, Vec3::Zero(), Vec3::UnitZ(), height, habit_.stem_radius_share * height, 0, height);
    return std::move(tree_);
  }

 private:
  static constexpr double kTip = 0.0018;

  void axis(std::int32_t parent, const Vec3& from, Vec3 direction, double length, double radius, int order,
            double height) {
    const double step = std::clamp(2 * radius, 0.02, 0.08);
    const int steps = std::max(2, static_cast<int>(length / step));
    const std::int32_t id = axes_++;
    const auto first = static_cast<std::int32_t>(tree_.size());
    Vec3 at = from;
    for (int i = 0; i < steps; ++i) {
      const double t = (i + 0.5) / steps;
      const double r = std::max(kTip, radius * std::pow(1 - t, order == 0 ? 0.8 : 1.0));
      direction = (direction + habit_.bend * (order == 0 ? 0.3 : 1.0) * random_.direction() +
                   (order > 0 ? 0.01 : 0.005) * Vec3::UnitZ())
                      .normalized();
      TreeNode node;
      node.start = at;
      node.end = at + direction * (length / steps);
      node.parent = i == 0 ? parent : static_cast<std::int32_t>(tree_.size()) - 1;
      node.radius = r;
      node.axis = id;
      node.order = order;
      at = node.end;
      tree_.add(node);
    }
    if (order == 3 || length < 0.25) return;
    const double bare = order == 0 ? habit_.crown_base_share : 0.2;
    const double density = order == 0 ? habit_.per_metre : 4.0 + 2.0 * order;
    const int shoots = static_cast<int>(length * (1 - bare) * density);
    double turn = random_.uniform(0, 2 * std::numbers::pi);
    for (int k = 0; k < shoots; ++k) {
      const double t = bare + (0.97 - bare) * (k + random_.uniform()) / shoots;
      const auto node = static_cast<std::size_t>(first + static_cast<std::int32_t>(t * steps));
      turn += 2.4 + 0.4 * random_.normal();
      const double angle = (habit_.angle_deg + (habit_.angle_top_deg - habit_.angle_deg) * t) *
                           std::numbers::pi / 180 * (order == 0 ? 1 : 0.8);
      const Vec3 along = tree_.direction(node), side = along.unitOrthogonal();
      const Vec3 out = Eigen::AngleAxisd(turn, along) * side;
      const Vec3 way = std::cos(angle) * along + std::sin(angle) * out;
      const double own =
          order == 0 ? habit_.length_share * height * std::pow(1 - t, 0.7) + 0.3 : length * 0.45 * (1.1 - t);
      const double thick =
          std::min(0.9, habit_.radius_share * random_.uniform(0.7, 1.2) * (order == 0 ? 1.0 : 1.3));
      const double r = std::max(kTip, std::min(tree_.radius[node] * thick, 0.012 * own + 0.001));
      if (own < 0.08) continue;
      axis(static_cast<std::int32_t>(node), tree_.end[node] + out * 0.5 * tree_.radius[node], way,
           own * random_.uniform(0.7, 1.2), r, order + 1, height);
    }
  }

  const Habit& habit_;
  Random random_;
  Tree tree_;
  std::int32_t axes_ = 0;
};

}  // namespace

Tree make_tree(int kind, double height_m, std::uint64_t seed) {
  Tree tree = Drawer(kHabits[kind], seed).draw(height_m);
  tree.validate();
  return tree;
}

std::vector<Case> made_cases(int count, bool leaf_on) {
  constexpr double kHeights[5] = {6, 10, 4, 14, 8}, kSteps[3] = {0.06, 0.1, 0.15};
  constexpr double kNoises[4] = {0.002, 0.001, 0.004, 0.003};
  constexpr const char* kSpecies[4] = {"broadleaf", "beech", "maple", "oak"};
  const char* kNames[4] = {"broad", "slender", "bushy", "grown"};
  std::vector<Case> cases;
  for (int i = 0; i < count; ++i) {
    Case c;
    c.kind = i % 4;
    c.seed = static_cast<std::uint64_t>(i) + 1;
    c.height_m = kHeights[i % 5];
    c.scan.stations = 1 + (i / 4 + i) % 4;
    c.scan.distance_m = std::max(5.0, 0.8 * c.height_m);
    c.scan.step_deg = kSteps[(i / 2) % 3];
    c.scan.range_noise_m = kNoises[(i / 3) % 4];
    c.scan.registration_error_m = i % 2 ? 0.001 : 0;
    c.scan.first_azimuth_deg = 37 * i;
    c.scan.rays_per_beam = 3;
    c.scan.ground_radius_m = 2;
    c.scan.seed = c.seed;
    c.scan.threads = 1;
    if (leaf_on) {
      c.species = kSpecies[(i / 2) % 4];
      c.lai = 1 + i % 3;
      c.scan.stations = std::max(2, c.scan.stations);
    }
    c.name = std::string(kNames[c.kind]) + (leaf_on ? "_leaf" : "") + "_" + std::to_string(i + 1);
    cases.push_back(c);
  }
  return cases;
}

Tree tree_of(const Case& c) {
  if (c.kind < 3) return make_tree(c.kind, c.height_m, c.seed);
  IgmOptions options;
  options.seed = c.seed;
  IgmParameters parameters = igm_preset("standard").parameters;
  parameters.cycles = 10 + static_cast<int>(c.seed / 4) % 8;
  Tree tree = grow_igm(parameters, {}, options).tree;
  assign_axes_by_thickness(tree);
  return tree;
}

VirtualScan scan_of(const Case& c, const Tree& tree) {
  if (!c.species) return scan_tree(tree, nullptr, c.scan);
  LeafOptions options;
  options.traits = leaf_traits(*c.species);
  options.lai = c.lai;
  options.seed = c.seed;
  options.threads = 1;
  const LeafResult leaves = insert_leaves(tree, options);
  return scan_tree(tree, &leaves.foliage, c.scan);
}

}  // namespace dendrofit::bench
