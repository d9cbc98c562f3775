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

/// The most voluminous limbs that together hold kHeavyShare of the wood, in rising order.
std::vector<std::size_t> heavy_limbs(const std::vector<Limb>& limbs) {
  std::vector<std::size_t> order(limbs.size()), heavy;
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::vector<double> volume(limbs.size());
  double all = 0, held = 0;
  for (std::size_t l = 0; l < limbs.size(); ++l) all += volume[l] = volume_of(limbs[l]);
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return volume[a] > volume[b]; });
  for (const std::size_t l : order) {
    if (held > kHeavyShare * all) break;
    held += volume[l];
    heavy.push_back(l);
  }
  std::sort(heavy.begin(), heavy.end());
  return heavy;
}

/// Radii of the heavy limbs from those of their points whose draw in this round is `side`.
std::vector<Limb> settled_half(const std::vector<Vec3>& points, const std::vector<Limb>& limbs,
                               const std::vector<std::size_t>& heavy, Sights sights,
                               const std::vector<char>& draw, char side, const SubsampleOptions& options) {
  std::vector<Limb> half = limbs, part;
  for (const std::size_t l : heavy) {
    for (LimbNode& node : half[l].nodes)
      std::erase_if(node.points, [&](std::uint32_t p) { return draw[p] != side; });
    part.push_back(half[l]);
  }
  Sights seen = look_at_limbs(points, part, options.seeing);
  for (std::size_t k = 0; k < heavy.size(); ++k) sights[heavy[k]] = std::move(seen[k]);
  settle_radii(half, sights, options.seeing.noise_m, options.radii);
  return half;
}

}  // namespace

SubsampleSpread subsample(const std::vector<Vec3>& points, const std::vector<Limb>& limbs,
                          const Sights& sights, const SubsampleOptions& options, Progress& progress) {
  const Measures whole = measures_of(points, limbs, options);
  const std::vector<std::size_t> heavy = heavy_limbs(limbs);
  double dbh = 0, dbhs = 0, top = 0, stem = 0, branch = 0, halves = 0;
  std::vector<char> draw(points.size());
  for (int round = 0; round < options.rounds; ++round) {
    progress.check();
    Random random = Random(options.seed).child({0x5b5a, static_cast<std::uint64_t>(round)});
    for (char& d : draw) d = static_cast<char>(random.bits() >> 63);
    for (const char side : {0, 1}) {
      const Measures m =
          measures_of(points, settled_half(points, limbs, heavy, sights, draw, side, options), options);
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
