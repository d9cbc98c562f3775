// SPDX-License-Identifier: GPL-3.0-or-later
#include "forward/leaves/bearing.h"

#include "core/convex_hull.h"
#include "core/errors.h"
#include "core/metrics.h"
#include "core/neighbors.h"
#include "core/tree_topology.h"
#include "forward/leaves/clearance.h"
#include "forward/leaves/measured_profile.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

namespace dendrofit {
namespace {

constexpr double kPieceLength = 0.05;
constexpr std::size_t kBins = 25;

/// Radius below which `share` of the wood's length lies.
double radius_quantile(const Tree& tree, double share, bool branches_only) {
  std::vector<std::size_t> order;
  double total = 0;
  for (std::size_t i = 0; i < tree.size(); ++i)
    if (!branches_only || tree.order[i] > 0) {
      order.push_back(i);
      total += tree.length(i);
    }
  std::sort(order.begin(), order.end(),
            [&](std::size_t a, std::size_t b) { return tree.radius[a] < tree.radius[b]; });
  double below = 0;
  for (std::size_t i : order) {
    below += tree.length(i);
    if (below >= share * total) return tree.radius[i];
  }
  return order.empty() ? 0 : tree.radius[order.back()];
}

/// Relative leaf area a metre of wood carries.
struct Willingness {
  Bearing rule;
  double operator()(double radius, double tip_distance, bool stem) const {
    const double span = std::max(rule.max_radius_m - rule.twig_radius_m, 1e-9);
    double thin = std::clamp((rule.max_radius_m - radius) / span, 0.0, 1.0);
    // An axis ends in leaves even where its model ends thick.
    if (tip_distance < 0.3 && radius < 2 * rule.max_radius_m) thin = std::max(thin, 0.5);
    const double full = rule.full_tip_distance_m, bare = stem ? 0 : rule.bare_share;
    const double near =
        tip_distance <= full ? 1 : bare + (1 - bare) * std::exp(-(tip_distance - full) / full);
    return thin * (near < 0.01 ? 0 : near);
  }
};

/// Where a model is coarser than real twigs, the thinnest fifth of its branches (or of its stems) bears.
Bearing rule_for(const Tree& tree, const Bearing& wanted, BearingWood& wood) {
  const bool branched =
      std::any_of(tree.order.begin(), tree.order.end(), [](std::int32_t o) { return o > 0; });
  Bearing rule = wanted;
  const double thinnest = radius_quantile(tree, 0.2, branched);
  if (thinnest > wanted.twig_radius_m) {
    rule.twig_radius_m = thinnest;
    rule.max_radius_m = std::max({wanted.max_radius_m, 1.5 * thinnest, radius_quantile(tree, 0.5, branched)});
    wood.coarse = thinnest > 1.5 * wanted.twig_radius_m;
    if (wood.coarse)
      wood.warnings.push_back("the model has few twigs: leaves sit on wood of up to " +
                              std::to_string(std::lround(rule.max_radius_m * 1000)) + " mm radius");
  }
  return rule;
}

void share_by_points(std::vector<Piece>& pieces, const Tree& tree, const PointCloud& cloud, double reach,
                     std::vector<std::string>& warnings) {
  std::vector<Vec3> middle;
  middle.reserve(pieces.size());
  for (const Piece& p : pieces) {
    const auto i = static_cast<std::size_t>(p.node);
    middle.push_back(tree.start[i] + 0.5 * (p.t0 + p.t1) * (tree.end[i] - tree.start[i]));
  }
  const std::vector<Vec3> seen = leaf_voxel_centres(cloud, tree.origin_shift);
  const Neighbors neighbors(middle);
  std::vector<Neighbor> found;
  std::vector<double> votes(pieces.size(), 0);
  std::size_t far = 0;
  for (const Vec3& at : seen) {
    neighbors.nearest(at, 3, found);
    double total = 0;
    for (const Neighbor& n : found)
      if (n.distance_squared <= reach * reach) total += pieces[n.index].share;
    if (!(total > 0)) ++far;
    for (const Neighbor& n : found)
      if (total > 0 && n.distance_squared <= reach * reach) votes[n.index] += pieces[n.index].share / total;
  }
  if (far == seen.size()) {
    warnings.push_back("no leaf point lies near bearing wood: the measured leaf profile is not used");
    return;
  }
  for (std::size_t k = 0; k < pieces.size(); ++k) pieces[k].share = votes[k];
  if (5 * far > seen.size())
    warnings.push_back(std::to_string(100 * far / seen.size()) +
                       " % of the leaf points lie further from bearing wood than measured_reach_m");
}

void normalise(std::vector<Piece>& pieces) {
  double total = 0;
  for (const Piece& p : pieces) total += p.share;
  for (Piece& p : pieces) p.share /= total;
}

double crown_area(const Tree& tree, const std::vector<Piece>& pieces, double reach) {
  std::vector<Vec3> points;
  for (const Piece& p : pieces) {
    const auto i = static_cast<std::size_t>(p.node);
    const Vec3 at = tree.start[i] + p.t1 * (tree.end[i] - tree.start[i]);
    for (int k = 0; k < 8; ++k) {
      const double turn = std::numbers::pi * k / 4;
      points.push_back(at + reach * Vec3(std::cos(turn), std::sin(turn), 0));
    }
  }
  return plan_hull(points).area_m2;
}

/// Plan area of the cells within a cell of bearing wood.
double covered_area(const Tree& tree, const std::vector<Piece>& pieces) {
  constexpr double kCell = 0.25;
  std::vector<std::pair<std::int64_t, std::int64_t>> cells;
  for (const Piece& p : pieces) {
    const auto i = static_cast<std::size_t>(p.node);
    const Vec3 at = tree.start[i] + p.t1 * (tree.end[i] - tree.start[i]);
    const auto x = static_cast<std::int64_t>(std::floor(at.x() / kCell));
    const auto y = static_cast<std::int64_t>(std::floor(at.y() / kCell));
    for (std::int64_t dx = -1; dx <= 1; ++dx)
      for (std::int64_t dy = -1; dy <= 1; ++dy) cells.emplace_back(x + dx, y + dy);
  }
  std::sort(cells.begin(), cells.end());
  const auto last = std::unique(cells.begin(), cells.end());
  return kCell * kCell * static_cast<double>(last - cells.begin());
}

}  // namespace

double fit_shares(std::vector<Piece>& pieces, const LeafProfile& profile) {
  const std::array<const std::optional<UnitDistribution>*, kPlaces> wanted = {
      &profile.height, &profile.along_axis, &profile.compass,
      &profile.radius, &profile.order,      &profile.tip_distance};
  const auto bin_of = [](double x) {
    return std::min(kBins - 1, static_cast<std::size_t>(std::max(0.0, x) * static_cast<double>(kBins)));
  };
  std::array<std::optional<TabulatedLaw>, kPlaces> laws;
  for (std::size_t place = 0; place < kPlaces; ++place)
    if (*wanted[place]) laws[place].emplace(**wanted[place]);
  double unreachable = 0;
  for (int round = 0; round < 40; ++round) {
    double worst = 0;
    for (std::size_t place = 0; place < kPlaces; ++place) {
      if (!laws[place]) continue;
      const TabulatedLaw& law = *laws[place];
      std::array<double, kBins> have{}, want{};
      for (const Piece& p : pieces) have[bin_of(p.place[place])] += p.share;
      double reachable = 0;
      for (std::size_t b = 0; b < kBins; ++b) {
        want[b] = law.cdf((b + 1.0) / kBins) - law.cdf(static_cast<double>(b) / kBins);
        if (have[b] > 0) reachable += want[b];
      }
      if (!(reachable > 1e-9))
        throw InputError(std::string("leaf profile over ") + kPlaceNames[place] +
                         ": it puts all leaves where the tree has no bearing wood");
      unreachable = std::max(unreachable, 1 - reachable);
      for (Piece& p : pieces) {
        const std::size_t b = bin_of(p.place[place]);
        if (have[b] > 0) p.share *= want[b] / reachable / have[b];
      }
      for (std::size_t b = 0; b < kBins; ++b)
        if (have[b] > 0) worst = std::max(worst, std::abs(want[b] / reachable - have[b]));
    }
    if (worst < 1e-9) break;
  }
  return unreachable;
}

BearingWood find_bearing_wood(const Tree& tree, const LeafOptions& options) {
  BearingWood wood;
  if (tree.empty()) return wood;
  const Willingness willing{rule_for(tree, options.traits.bearing, wood)};
  const std::vector<Axis> axes = axes_of(tree);
  wood.axis_tip_m.assign(tree.size(), 0);
  wood.foot_z = foot_height(tree);
  double top = wood.foot_z;
  for (const Vec3& end : tree.end) top = std::max(top, end.z());

  const auto collect = [&](bool everything) {
    for (const Axis& axis : axes) {
      double base_distance = 0;
      for (const std::int32_t node : axis.nodes) {
        const auto i = static_cast<std::size_t>(node);
        const double length = tree.length(i);
        wood.axis_tip_m[i] = axis.length - base_distance - length;
        // A very long cylinder still gives a bounded number of pieces.
        const int count = static_cast<int>(std::clamp(std::ceil(length / kPieceLength), 1.0, 2000.0));
        for (int k = 0; k < count; ++k) {
          Piece piece;
          piece.node = node;
          piece.t0 = static_cast<double>(k) / count;
          piece.t1 = (k + 1.0) / count;
          piece.length_m = length / count;
          const double middle = 0.5 * (piece.t0 + piece.t1);
          const double tip = std::max(0.0, axis.length - base_distance - middle * length);
          piece.share = piece.length_m * (everything ? 1 : willing(tree.radius[i], tip, tree.order[i] == 0));
          if (!(piece.share > 0)) continue;
          const Vec3 at = tree.start[i] + middle * (tree.end[i] - tree.start[i]);
          piece.place = {at.z() - wood.foot_z, 1 - tip / std::max(axis.length, 1e-12), 0,
                         tree.radius[i],       static_cast<double>(tree.order[i]),     tip};
          wood.pieces.push_back(piece);
        }
        base_distance += length;
      }
    }
  };
  collect(false);
  if (wood.pieces.empty()) {
    collect(true);
    wood.warnings.push_back("no wood of this tree is as thin as a twig: leaves sit all over it");
  }

  Vec3 centre = Vec3::Zero();
  const auto middle_of = [&](const Piece& p) -> Vec3 {
    const auto i = static_cast<std::size_t>(p.node);
    return tree.start[i] + 0.5 * (p.t0 + p.t1) * (tree.end[i] - tree.start[i]);
  };
  for (const Piece& p : wood.pieces) {
    centre += p.length_m * middle_of(p);
    wood.length_m += p.length_m;
    wood.radius_m = std::max(wood.radius_m, tree.radius[static_cast<std::size_t>(p.node)]);
  }
  centre /= wood.length_m;
  const auto largest = [&](Place place) {
    double most = 0;
    for (const Piece& p : wood.pieces) most = std::max(most, p.place[static_cast<std::size_t>(place)]);
    return std::max(most, 1e-12);
  };
  const double orders = std::max(1.0, largest(Place::order));
  wood.scale = {std::max(top - wood.foot_z, 1e-12), 1, 1, largest(Place::radius), orders,
                largest(Place::tip_distance)};
  for (Piece& p : wood.pieces) {
    const Vec3 out = middle_of(p) - centre;
    const double turn = std::atan2(out.x(), out.y()) / (2 * std::numbers::pi);
    p.place[static_cast<std::size_t>(Place::compass)] = turn - std::floor(turn);
    for (std::size_t k = 0; k < kPlaces; ++k) p.place[k] = std::clamp(p.place[k] / wood.scale[k], 0.0, 1.0);
  }

  if (options.measured)
    share_by_points(wood.pieces, tree, *options.measured, options.measured_reach_m, wood.warnings);
  wood.unreachable = fit_shares(wood.pieces, options.profile);
  normalise(wood.pieces);
  wood.cumulative.resize(wood.pieces.size());
  double sum = 0;
  for (std::size_t k = 0; k < wood.pieces.size(); ++k) wood.cumulative[k] = sum += wood.pieces[k].share;
  wood.covered_m2 = covered_area(tree, wood.pieces);
  double reach = 0;
  for (const LeafShapeShare& s : options.traits.shapes) reach = std::max(reach, BodyPlan(s.shape).reach);
  wood.crown_area_m2 = crown_area(tree, wood.pieces,
                                  reach * options.traits.length.mean_m +
                                      0.5 * (options.traits.petiole_min_m + options.traits.petiole_max_m));
  wood.covered_m2 = std::min(wood.covered_m2, wood.crown_area_m2);
  return wood;
}

}  // namespace dendrofit
