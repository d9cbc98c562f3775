// SPDX-License-Identifier: GPL-3.0-or-later
#include "recon/scan_order.h"

#include "recon/thick_places.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace dendrofit {
namespace {

/// A stretch of the file's points, with the sums of their outward directions.
struct Stretch {
  std::uint32_t first = 0;  // place in the file of its first point
  double weight = 0;
  Vec3 out = Vec3::Zero();
};

struct Facing {
  std::uint32_t stored;
  double weight;
  double farthest;  // cosine to the middle direction of its scan, which noise alone leads no farther around
  Vec3 out;
};

/// Stretches of equal weight in the file's order.
std::vector<Stretch> stretches_of(std::vector<Facing>& facings, std::size_t most) {
  std::sort(facings.begin(), facings.end(),
            [](const Facing& a, const Facing& b) { return a.stored < b.stored; });
  double total = 0;
  for (const Facing& f : facings) total += f.weight;
  std::vector<Stretch> stretches;
  double before = 0;
  for (const Facing& f : facings) {
    if (before >= total * static_cast<double>(stretches.size()) / static_cast<double>(most)) {
      stretches.emplace_back();
      stretches.back().first = f.stored;
    }
    Stretch& s = stretches.back();
    s.weight += f.weight;
    s.out += f.weight * f.out;
    before += f.weight;
  }
  return stretches;
}

/// Ends of `count` runs of stretches whose outward directions agree best within each run, for every count up
/// to `most` (dynamic programming).
std::vector<std::vector<std::size_t>> best_runs(const std::vector<Stretch>& stretches, std::size_t most) {
  const std::size_t n = stretches.size();
  std::vector<double> weight(n + 1, 0);
  std::vector<Vec3> out(n + 1, Vec3::Zero());
  for (std::size_t i = 0; i < n; ++i) {
    weight[i + 1] = weight[i] + stretches[i].weight;
    out[i + 1] = out[i] + stretches[i].out;
  }
  const auto cost = [&](std::size_t a, std::size_t b) {  // spread of the directions of stretches a..b-1
    const double w = weight[b] - weight[a];
    return w - (out[b] - out[a]).squaredNorm() / w;
  };
  std::vector<std::vector<std::size_t>> from(most, std::vector<std::size_t>(n + 1, 0));
  std::vector<double> least(n + 1, 0), next(n + 1);
  for (std::size_t b = 1; b <= n; ++b) least[b] = cost(0, b);
  std::vector<std::vector<std::size_t>> ends = {{n}};
  for (std::size_t k = 1; k < most && k < n; ++k) {
    next.assign(n + 1, std::numeric_limits<double>::infinity());
    for (std::size_t b = k + 1; b <= n; ++b)
      for (std::size_t a = k; a < b; ++a)
        if (const double c = least[a] + cost(a, b); c < next[b]) {
          next[b] = c;
          from[k][b] = a;
        }
    least.swap(next);
    std::vector<std::size_t> runs(k + 1);
    runs[k] = n;
    for (std::size_t j = k; j > 0; --j) runs[j - 1] = from[j][runs[j]];
    ends.push_back(std::move(runs));
  }
  return ends;
}

/// Largest share, among the runs that end at `ends`, of points that face farther from their run's middle
/// direction than one scan's do.
double most_beyond(const std::vector<Facing>& facings, const std::vector<Stretch>& stretches,
                   const std::vector<std::size_t>& ends) {
  double most = 0;
  std::size_t begin = 0, f = 0;
  for (const std::size_t end : ends) {
    Vec3 middle = Vec3::Zero();
    for (std::size_t s = begin; s < end; ++s) middle += stretches[s].out;
    middle.normalize();
    double all = 0, beyond = 0;
    for (; f < facings.size() && (end == stretches.size() || facings[f].stored < stretches[end].first); ++f) {
      all += facings[f].weight;
      if (facings[f].out.dot(middle) < facings[f].farthest) beyond += facings[f].weight;
    }
    most = std::max(most, beyond / all);
    begin = end;
  }
  return most;
}

}  // namespace

std::vector<std::uint16_t> scans_by_order(const std::vector<Vec3>& points,
                                          const std::vector<std::uint32_t>& stored,
                                          const std::vector<Limb>& limbs, double noise_m) {
  constexpr std::size_t kStretches = 512;
  constexpr std::size_t kMostScans = 16;
  constexpr double kAround = 0.05, kAroundNoises = 2;  // a scan sees half around, and noise leads beyond
  // Share of points that lie there all the same; more where the scan is rough.
  constexpr double kBeyond[2] = {0.03, 0.05};
  constexpr std::size_t kFewest = 2000;  // points
  std::vector<std::uint16_t> scan_of(points.size(), 0);
  std::vector<Facing> facings;
  for (const ThickPlace& place : thick_places(limbs, noise_m)) {
    const double farthest = -kAround - kAroundNoises * noise_m / place.node->rough_radius_m;
    for (const std::uint32_t p : place.node->points) {
      const Eigen::Vector2d d = place.across(points[p]);
      if (std::abs(d.norm() - place.node->rough_radius_m) > 0.5 * place.node->rough_radius_m) continue;
      facings.push_back(
          {stored[p], place.point_weight(), farthest, (d.x() * place.u + d.y() * place.v).normalized()});
    }
  }
  if (facings.size() < kFewest) return scan_of;
  const std::vector<Stretch> stretches = stretches_of(facings, kStretches);
  const auto divisions = best_runs(stretches, kMostScans);
  for (const double beyond : kBeyond)
    for (const std::vector<std::size_t>& ends : divisions) {
      if (most_beyond(facings, stretches, ends) > beyond) continue;
      for (std::size_t i = 0; i < points.size(); ++i)
        for (std::size_t k = 0; k + 1 < ends.size(); ++k)
          if (stored[i] >= stretches[ends[k]].first) scan_of[i] = static_cast<std::uint16_t>(k + 1);
      return scan_of;
    }
  return scan_of;
}

}  // namespace dendrofit
