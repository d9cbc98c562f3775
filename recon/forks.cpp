// SPDX-License-Identifier: GPL-3.0-or-later
#include "recon/forks.h"

#include <algorithm>
#include <cmath>

namespace dendrofit {
namespace {

/// Direction of a limb's first clear stretch.
Vec3 first_direction(const Limb& limb, double stretch) {
  const Vec3& base = limb.nodes.front().centre;
  std::size_t k = 1;
  while (k + 1 < limb.nodes.size() && limb.nodes[k].along_m < stretch) ++k;
  return (limb.nodes[k].centre - base).normalized();
}

}  // namespace

void lead_limbs_back(const std::vector<Vec3>& points, std::vector<Limb>& limbs, double spacing_m) {
  constexpr double kStep = 0.005;
  constexpr double kFarthest = 0.6;
  const double node_step = std::max(0.02, 2.5 * spacing_m);
  std::vector<std::int32_t> inserted(limbs.size(), 0);
  for (std::size_t l = 0; l < limbs.size(); ++l) {
    Limb& limb = limbs[l];
    if (limb.parent < 0) continue;
    limb.parent_node += inserted[static_cast<std::size_t>(limb.parent)];
    if (limb.nodes.size() < 2 || limb.nodes.front().after_gap) continue;
    Limb& bearer = limbs[static_cast<std::size_t>(limb.parent)];
    const auto fork = static_cast<std::size_t>(limb.parent_node);
    const LimbNode& base = limb.nodes.front();
    const double bearer_radius = bearer.nodes[fork].rough_radius_m;
    const double thickness = std::min(base.rough_radius_m, bearer_radius);
    const Vec3 direction = first_direction(limb, std::max(0.04, 3 * thickness));

    // Where along the bearer the branch may begin: from well before the fork to a little beyond it.
    const double farthest = std::min(kFarthest, 5 * bearer_radius + 3 * node_step);
    std::size_t first = fork;
    while (first > 0 && bearer.nodes[fork].along_m - bearer.nodes[first - 1].along_m <= farthest) --first;
    const std::size_t last = std::min(fork + 1, bearer.nodes.size() - 1);

    LimbPlace best = nearest_place(bearer, base.centre, first, last);
    double best_back = 0;
    for (double back = kStep; back <= farthest; back += kStep) {
      if (best.distance_m <= best.radius_m) break;
      const LimbPlace place = nearest_place(bearer, base.centre - back * direction, first, last);
      if (place.distance_m - place.radius_m < best.distance_m - best.radius_m) {
        best = place;
        best_back = back;
      }
    }
    if (best_back > 0) {
      const auto count = static_cast<std::size_t>(std::ceil(best_back / node_step));
      std::vector<LimbNode> fresh(count);
      for (std::size_t k = 0; k < count; ++k) {
        const double back = best_back * static_cast<double>(count - k) / static_cast<double>(count);
        fresh[k].centre = base.centre - back * direction;
        fresh[k].rough_radius_m = thickness;
      }
      // Points on the branch's side of the fork change hands.
      const double reach = 1.4 * thickness + 0.5 * spacing_m;
      for (std::size_t i = best.node; i <= fork; ++i) {
        auto& pool = bearer.nodes[i].points;
        std::size_t kept = 0;
        for (const std::uint32_t p : pool) {
          const double along = (points[p] - fresh.front().centre).dot(direction);
          const double off = (points[p] - fresh.front().centre - along * direction).norm();
          const LimbPlace own = nearest_place(bearer, points[p], first, last);
          const bool goes = along >= 0 && along <= best_back && off <= reach &&
                            own.distance_m > 0.8 * own.radius_m &&
                            std::abs(off - thickness) < std::abs(own.distance_m - own.radius_m);
          if (goes) {
            const auto k = static_cast<std::size_t>(along / best_back * static_cast<double>(count));
            fresh[std::min(k, count - 1)].points.push_back(p);
          } else {
            pool[kept++] = p;
          }
        }
        pool.resize(kept);
      }
      limb.nodes.insert(limb.nodes.begin(), std::make_move_iterator(fresh.begin()),
                        std::make_move_iterator(fresh.end()));
      inserted[l] = static_cast<std::int32_t>(count);
    }
    limb.parent_node = static_cast<std::int32_t>(best.node);
  }
  measure_lengths(limbs);
}

}  // namespace dendrofit
