// SPDX-License-Identifier: GPL-3.0-or-later
#include "recon/thick_places.h"

#include "recon/cylinder_fit.h"

#include <algorithm>

namespace dendrofit {

Eigen::Vector2d ThickPlace::across(const Vec3& point) const {
  const Vec3 d = point - node->centre;
  return {d.dot(u), d.dot(v)};
}

double ThickPlace::point_weight() const {
  constexpr double kMost = 20;
  return std::min(1.0, kMost / static_cast<double>(node->points.size()));
}

std::vector<ThickPlace> thick_places(const std::vector<Limb>& limbs, double noise_m) {
  constexpr double kThinnest = 0.012;    // radius of wood whose sides can be told apart, metres,
  constexpr double kThinnestNoises = 4;  // ... and in noises
  constexpr std::size_t kFewestPoints = 8;
  std::vector<ThickPlace> places;
  for (const Limb& limb : limbs) {
    if (limb.nodes.size() < 2) continue;
    for (std::size_t i = 0; i < limb.nodes.size(); ++i) {
      const LimbNode& node = limb.nodes[i];
      if (node.rough_radius_m < std::max(kThinnest, kThinnestNoises * noise_m) ||
          node.points.size() < kFewestPoints)
        continue;
      ThickPlace place{.node = &node};
      plane_frame(direction_at(limb, i), place.u, place.v);
      places.push_back(place);
    }
  }
  return places;
}

}  // namespace dendrofit
