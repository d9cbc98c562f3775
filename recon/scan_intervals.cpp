// SPDX-License-Identifier: GPL-3.0-or-later
#include "recon/scan_intervals.h"

#include "core/tree_topology.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

namespace dendrofit {
namespace {

constexpr double k95 = 1.96;
constexpr double kSettled = 0.10;  // relative, of a volume whose every radius is known to its best

/// One standard error of a volume downwards and upwards.
struct Doubt {
  double down = 0, up = 0;
};

/// What one part of the tree (stem or branches) consists of.
struct Part {
  double volume = 0, by_noise = 0, by_radius_se = 0;
};

Part part_of(const Tree& tree, bool stem, double noise_m) {
  Part part;
  for (std::size_t i = 0; i < tree.size(); ++i) {
    if ((tree.order[i] == 0) != stem) continue;
    const double mantle = 2 * std::numbers::pi * tree.radius[i] * tree.length(i);
    part.volume += tree.volume(i);
    part.by_noise += mantle * noise_m;
    const double se = std::isfinite(tree.radius_se[i]) ? tree.radius_se[i] : 0.5 * tree.radius[i];
    part.by_radius_se += mantle * std::min(se, tree.radius[i]);
  }
  return part;
}

/// By how much the stem's volume changes if at one of its forks another limb had gone on: the largest
/// difference over the forks where the other is at least `rival` times as thick.
double other_heir(const Tree& tree, double rival) {
  const TreeChildren children(tree);
  const std::vector<Axis> axes = axes_of(tree);
  std::vector<double> axis_volume(axes.size(), 0);
  for (std::size_t a = 0; a < axes.size(); ++a)
    for (const std::int32_t n : axes[a].nodes) axis_volume[a] += tree.volume(static_cast<std::size_t>(n));
  double most = 0;
  for (std::size_t a = 0; a < axes.size(); ++a) {
    if (axes[a].order != 0) continue;
    double beyond = 0;  // of the stem
    for (std::size_t k = axes[a].nodes.size(); k-- > 0;) {
      const auto i = static_cast<std::size_t>(axes[a].nodes[k]);
      const double heir = k + 1 < axes[a].nodes.size()
                              ? tree.radius[static_cast<std::size_t>(axes[a].nodes[k + 1])]
                              : tree.radius[i];
      for (const std::int32_t c : children.of(i)) {
        const auto child = static_cast<std::size_t>(c);
        if (tree.axis[child] == tree.axis[i] || tree.radius[child] < rival * heir) continue;
        most = std::max(most, std::abs(beyond - axis_volume[static_cast<std::size_t>(tree.axis[child])]));
      }
      beyond += tree.volume(i);
    }
  }
  return most;
}

// Leaf blades are 4 to 15 cm long and mostly stand off the shoot at an angle.
constexpr double kHalfLeaf_m = 0.03, kLeaf_m = 0.12;
constexpr double kInLeaf = 0.12;  // relative, of branch volume among leaves

Doubt doubt_of_stem(const Part& stem, const Visibility& seen) {
  const double one_sided = 1 - seen.stem_coverage;
  const double settled = std::max(0.0, stem.by_radius_se - kSettled * stem.volume);
  const double both = std::hypot(0.013 * stem.volume, 0.06 * stem.by_noise,
                                 std::hypot(0.15 * one_sided * one_sided * stem.volume, 0.5 * settled,
                                            seen.spread.stem_share * stem.volume));
  return {both, both + 0.3 * seen.gap_share * stem.volume};
}

Doubt doubt_of_branches(const Part& branches, const Visibility& seen) {
  const double both =
      std::hypot(0.05 * branches.volume, 0.10 * branches.by_noise,
                 branches.volume * std::hypot(0.5 * seen.unmeasured_share, seen.spread.branch_share,
                                              seen.in_leaf ? kInLeaf : 0));
  const double hidden = 1.2 * std::max(0.0, 0.85 - seen.stem_coverage) + seen.gap_share;
  return {both, both + hidden * branches.volume};
}

Interval about(double value, double down, double up) {
  return {value, std::max(0.0, value - k95 * down), value + k95 * up};
}

}  // namespace

Visibility how_well_seen(const std::vector<Limb>& limbs, bool in_leaf) {
  Visibility seen{.stem_coverage = 0, .in_leaf = in_leaf};
  double covered = 0, weight = 0, length[2] = {0, 0}, gap[2] = {0, 0}, volume = 0, unmeasured = 0;
  for (const Limb& limb : limbs)
    for (std::size_t i = 1; i < limb.nodes.size(); ++i) {
      const LimbNode& node = limb.nodes[i];
      const bool branch = limb.parent >= 0;
      const double step = node.along_m - limb.nodes[i - 1].along_m,
                   piece = node.radius_m * node.radius_m * step;
      length[branch] += step;
      if (node.after_gap) gap[branch] += step;
      if (branch) {
        volume += piece;
        if (!node.measured) unmeasured += piece;
      } else if (node.coverage > 0) {
        covered += piece * node.coverage;
        weight += piece;
      }
    }
  if (weight > 0) seen.stem_coverage = covered / weight;
  for (int k = 0; k < 2; ++k)
    if (length[k] > 0) seen.gap_share += gap[k] / length[k];
  if (volume > 0) seen.unmeasured_share = unmeasured / volume;
  return seen;
}

double height_in_leaf(double wood_top_m, const std::vector<Vec3>& foliage, double foot_z_m) {
  if (foliage.size() < 3) return wood_top_m;
  std::vector<double> z;
  z.reserve(foliage.size());
  for (const Vec3& p : foliage) z.push_back(p.z());
  std::nth_element(z.begin(), z.begin() + 2, z.end(), std::greater<>());
  return std::max(wood_top_m, z[2] - foot_z_m - kHalfLeaf_m);
}

void estimate_scan_intervals(const Tree& tree, const std::optional<SliceDiameter>& breast_height,
                             const Visibility& seen, double noise_m, double spacing_m, TreeMetrics& metrics) {
  if (metrics.dbh_m) {
    const double d = *metrics.dbh_m;
    const double se =
        breast_height ? std::hypot(breast_height->se_m / std::sqrt(std::max(0.1, breast_height->coverage)),
                                   std::hypot(breast_height->scatter_m, seen.spread.dbh_m),
                                   std::hypot(0.2 * noise_m, 0.004 * d))
                      : std::hypot(0.15 * d, noise_m);
    metrics.intervals["dbh_m"] = about(d, se, se);
  }
  const double leaf = seen.in_leaf ? 0.5 * kLeaf_m : 0;
  const double spread = 0.5 * seen.spread.height_m;
  metrics.intervals["height_m"] =
      about(metrics.height_m, std::hypot(0.006 + 0.5 * (spacing_m + noise_m), leaf, spread),
            std::hypot(0.008 + 2 * spacing_m + 0.5 * noise_m, leaf, spread));
  const Part stem = part_of(tree, true, noise_m), branches = part_of(tree, false, noise_m);
  const Doubt of_stem = doubt_of_stem(stem, seen), of_branches = doubt_of_branches(branches, seen);
  // Seen from one side, thicknesses compare badly.
  const double heir = 0.7 * other_heir(tree, std::clamp(0.7 * seen.stem_coverage, 0.3, 0.6));
  metrics.intervals["stem_volume_m3"] =
      about(metrics.stem_volume_m3, std::hypot(of_stem.down, heir), std::hypot(of_stem.up, heir));
  metrics.intervals["total_volume_m3"] =
      about(metrics.total_volume_m3, of_stem.down + of_branches.down, of_stem.up + of_branches.up);
}

}  // namespace dendrofit
