// SPDX-License-Identifier: GPL-3.0-or-later
#include "forward/leaves/twigs.h"

#include "core/random.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <Eigen/Geometry>

namespace dendrofit {
namespace {

constexpr double kGoldenAngle = 2.399963229728653;
constexpr double kMainRadius = 0.0035, kSideRadius = 0.002, kTipRadius = 0.0012;
constexpr int kSides = 7;
constexpr double kSideShare = 0.45;   // of the shoot's length, for the lowest side twig
constexpr double kMostPerMetre = 12;  // shoots a metre of wood
constexpr std::size_t kMostShoots = 8000;

/// Length of a shoot of length 1 with all its side twigs.
double total_of_unit_shoot() {
  double total = 1;
  for (int k = 0; k < kSides; ++k) total += kSideShare * (1 - 0.6 * (k + 0.5) / kSides);
  return total;
}

struct Grower {
  const Tree& tree;
  TwigGrowth& out;
  std::int32_t axes = 0;

  /// A slightly wavy axis; returns its nodes.
  std::vector<std::int32_t> axis(std::int32_t parent, std::int32_t bearer, Vec3 at, Vec3 along, double length,
                                 int count, double radius, std::int32_t order, Random& draw) {
    std::vector<std::int32_t> nodes;
    for (int k = 0; k < count; ++k) {
      // Shoots turn up toward their ends.
      along = (along + 0.12 * draw.direction() + Vec3(0, 0, 0.06)).normalized();
      TreeNode node;
      node.start = at;
      node.end = at = at + along * (length / count);
      node.parent = parent;
      node.radius = radius + (kTipRadius - radius) * (k + 0.5) / count;
      node.axis = axes;
      node.order = order;
      node.quality = RadiusQuality::extrapolated;
      nodes.push_back(parent = out.twigs.add(node));
      out.bearer.push_back(bearer);
    }
    ++axes;
    return nodes;
  }

  void shoot(std::int32_t bearer, const Vec3& at, const Vec3& along, double length, Random& draw) {
    const auto main = axis(-1, bearer, at, along, length, kSides, kMainRadius, 0, draw);
    for (int k = 0; k < kSides; ++k) {
      const auto node = static_cast<std::size_t>(main[static_cast<std::size_t>(k)]);
      const Vec3 here = out.twigs.direction(node);
      // Two rows of side twigs, level where the shoot slants, one at every node on the other side.
      Vec3 side = here.cross(Vec3::UnitZ());
      side = side.norm() > 0.2 ? Vec3(side.normalized()) : Vec3(here.unitOrthogonal());
      side = Eigen::AngleAxisd(0.5 * draw.normal(), here) * side * (k % 2 ? -1.0 : 1.0);
      const double own = length * kSideShare * (1 - 0.6 * (k + 0.5) / kSides) * draw.uniform(0.8, 1.2);
      const Vec3 away = (0.65 * here + 0.75 * side).normalized();
      axis(main[static_cast<std::size_t>(k)], bearer, out.twigs.end[node], away, own, 3, kSideRadius, 1,
           draw);
    }
  }
};

}  // namespace

TwigGrowth grow_twigs(const Tree& tree, const BearingWood& wood, double length_m, std::uint64_t seed) {
  TwigGrowth growth;
  growth.twigs.origin_shift = tree.origin_shift;
  if (wood.pieces.empty() || !(length_m > 0)) return growth;
  const double burden = length_m / std::max(wood.length_m, 1e-6);
  const double shoot_length = std::clamp(0.25 * std::sqrt(burden), 0.25, 1.0);
  const double wanted = length_m / (shoot_length * total_of_unit_shoot());
  const double most = std::min(kMostPerMetre * wood.length_m, static_cast<double>(kMostShoots));
  const auto count = static_cast<std::size_t>(std::ceil(std::clamp(wanted, 1.0, std::max(1.0, most))));
  Grower grower{tree, growth};
  for (std::size_t i = 0; i < count; ++i) {
    Random draw = Random(seed).child({0x74776967, i});
    const double u = (static_cast<double>(i) + draw.uniform(0.2, 0.8)) / static_cast<double>(count);
    const auto found =
        std::upper_bound(wood.cumulative.begin(), wood.cumulative.end(), u * wood.cumulative.back());
    const Piece& piece = wood.pieces[std::min(static_cast<std::size_t>(found - wood.cumulative.begin()),
                                              wood.pieces.size() - 1)];
    const auto node = static_cast<std::size_t>(piece.node);
    const double t = draw.uniform(piece.t0, piece.t1), length = tree.length(node);
    const Vec3 along = tree.direction(node);
    const Vec3 out = Eigen::AngleAxisd(kGoldenAngle * static_cast<double>(i), along) * along.unitOrthogonal();
    // Steeper toward the tip of an axis: the last shoots carry it on.
    const double to_tip = wood.axis_tip_m[node] + (1 - t) * length;
    const double lean = (0.25 + 0.75 * std::clamp(to_tip / 0.5, 0.0, 1.0)) * draw.uniform(0.75, 1.1);
    const Vec3 away = (std::cos(lean) * along + std::sin(lean) * out + Vec3(0, 0, 0.2)).normalized();
    const Vec3 foot = tree.start[node] + t * length * along + tree.radius[node] * out;
    const double own = shoot_length * draw.uniform(0.6, 1.4);
    // None that would hang to the ground.
    if (foot.z() + std::min(0.0, own * away.z()) < wood.foot_z + 0.1) continue;
    grower.shoot(piece.node, foot, away, own, draw);
  }
  return growth;
}

Tree with_twigs(const Tree& tree, const TwigGrowth& growth) {
  Tree all = tree;
  const auto nodes = static_cast<std::int32_t>(tree.size());
  const std::int32_t axes = tree.axis_count();
  all.reserve(tree.size() + growth.twigs.size());
  for (std::size_t i = 0; i < growth.twigs.size(); ++i) {
    TreeNode node = growth.twigs.node(i);
    node.parent = node.parent < 0 ? growth.bearer[i] : node.parent + nodes;
    node.axis += axes;
    node.order += tree.order[static_cast<std::size_t>(growth.bearer[i])] + 1;
    all.add(node);
  }
  return all;
}

}  // namespace dendrofit
