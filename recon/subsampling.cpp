// SPDX-License-Identifier: GPL-3.0-or-later
#include "recon/subsampling.h"

#include "core/random.h"
#include "recon/intervals.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

namespace dendrofit {
namespace {

constexpr double kHeavyShare = 0.9;

/// What is measured of the whole and of every half.
struct Measures {
  std::optional<double> dbh_m;
  double top_m = -1e300;
  double stem_m3 = 0, branch_m3 = 0;
};

Measures measures_of(const std::vector<Vec3>& points, const std::vector<Limb>& limbs,
                     const SubsampleOptions& options) {
  Measures m;
  for (const Limb& limb : limbs)
    for (std::size_t i = 0; i < limb.nodes.size(); ++i) {
      const LimbNode& node = limb.nodes[i];
      for (const std::uint32_t p : node.points) m.top_m = std::max(m.top_m, points[p].z());
      if (i == 0) continue;
      const double step = node.along_m - limb.nodes[i - 1].along_m;
      (limb.parent < 0 ? m.stem_m3 : m.branch_m3) += std::numbers::pi * node.radius_m * node.radius_m * step;
    }
  if (options.breast_z_m)
    if (const auto slice = slice_diameter(points, limbs, *options.breast_z_m, options.seeing.noise_m))
      m.dbh_m = slice->diameter_m;
  return m;
}

double volume_of(const Limb& limb) {
  double volume = 0;
  for (std::size_t i = 1; i < limb.nodes.size(); ++i)
    volume += std::pow(limb.nodes[i].radius_m, 2) * (limb.nodes[i].along_m - limb.nodes[i - 1].along_m);
  return volume;
}

/// Marks the most voluminous limbs that together hold kHeavyShare of the wood.
std::vector<char> heavy_limbs(const std::vector<Limb>& limbs) {
  std::vector<std::size_t> order(limbs.size());
  std::vector<char> heavy(limbs.size(), 0);
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::vector<double> volume(limbs.size());
  double all = 0, held = 0;
  for (std::size_t l = 0; l < limbs.size(); ++l) all += volume[l] = volume_of(limbs[l]);
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return volume[a] > volume[b]; });
  for (const std::size_t l : order) {
    if (held > kHeavyShare * all) break;
    held += volume[l];
    heavy[l] = 1;
  }
  return heavy;
}

/// The limbs with the points that the halves look at: those of the heavy limbs and of such as pass breast
/// height. Of the others the highest point is left.
struct Stripped {
  std::vector<Limb> limbs;
  double top_m = -1e300;
};

Stripped strip(const std::vector<Vec3>& points, const std::vector<Limb>& limbs,
               const std::vector<char>& heavy, const std::optional<double>& breast_z_m) {
  constexpr double kReach_m = 0.6;  // of the slices about breast height
  Stripped stripped{limbs};
  for (std::size_t l = 0; l < limbs.size(); ++l) {
    std::vector<LimbNode>& nodes = stripped.limbs[l].nodes;
    const auto at_breast = [&](const LimbNode& node) {
      return breast_z_m && std::abs(node.centre.z() - *breast_z_m) < kReach_m;
    };
    if (heavy[l] || std::any_of(nodes.begin(), nodes.end(), at_breast)) continue;
    for (LimbNode& node : nodes) {
      for (const std::uint32_t p : node.points) stripped.top_m = std::max(stripped.top_m, points[p].z());
      node.points = {};
    }
  }
  return stripped;
}

/// Radii of the heavy limbs from those of their points whose draw in this round is `side`.
std::vector<Limb> settled_half(const std::vector<Vec3>& points, std::vector<Limb> half,
                               const std::vector<char>& heavy, Sights sights, const std::vector<char>& draw,
                               char side, const SubsampleOptions& options) {
  for (std::size_t l = 0; l < half.size(); ++l) {
    if (!heavy[l]) continue;
    for (LimbNode& node : half[l].nodes)
      std::erase_if(node.points, [&](std::uint32_t p) { return draw[p] != side; });
  }
  Sights seen = look_at_some_limbs(points, half, heavy, options.seeing);
  for (std::size_t l = 0; l < half.size(); ++l)
    if (heavy[l]) sights[l] = std::move(seen[l]);
  settle_radii(half, sights, options.seeing.noise_m, options.radii);
  return half;
}

}  // namespace

SubsampleSpread subsample(const std::vector<Vec3>& points, const std::vector<Limb>& limbs,
                          const Sights& sights, const SubsampleOptions& options, Progress& progress) {
  const Measures whole = measures_of(points, limbs, options);
  const std::vector<char> heavy = heavy_limbs(limbs);
  const Stripped stripped = strip(points, limbs, heavy, options.breast_z_m);
  double dbh = 0, dbhs = 0, top = 0, stem = 0, branch = 0, halves = 0;
  std::vector<char> draw(points.size());
  for (int round = 0; round < options.rounds; ++round) {
    progress.check();
    Random random = Random(options.seed).child({0x5b5a, static_cast<std::uint64_t>(round)});
    for (char& d : draw) d = static_cast<char>(random.bits() >> 63);
    for (const char side : {0, 1}) {
      Measures m = measures_of(
          points, settled_half(points, stripped.limbs, heavy, sights, draw, side, options), options);
      m.top_m = std::max(m.top_m, stripped.top_m);
      if (m.dbh_m && whole.dbh_m) {
        dbh += std::pow(*m.dbh_m - *whole.dbh_m, 2);
        dbhs += 1;
      }
      top += std::pow(std::max(m.top_m, -1e6) - std::max(whole.top_m, -1e6), 2);
      stem += std::pow(m.stem_m3 - whole.stem_m3, 2);
      branch += std::pow(m.branch_m3 - whole.branch_m3, 2);
      halves += 1;
    }
  }
  SubsampleSpread spread;
  if (dbhs > 0) spread.dbh_m = std::sqrt(dbh / dbhs);
  if (halves == 0) return spread;
  spread.height_m = std::sqrt(top / halves);
  if (whole.stem_m3 > 0) spread.stem_share = std::sqrt(stem / halves) / whole.stem_m3;
  if (whole.branch_m3 > 0) spread.branch_share = std::sqrt(branch / halves) / whole.branch_m3;
  return spread;
}

}  // namespace dendrofit
