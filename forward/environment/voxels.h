// SPDX-License-Identifier: GPL-3.0-or-later
// The voxel frame light and obstacles share, and light in fixed point.
#pragma once

#include "core/types.h"

#include <cmath>
#include <cstdint>

namespace dendrofit {

/// Light and shade in units of 2^-40 of full light: sums are exact, whatever their order, and can be taken
/// back.
using Fixed = std::int64_t;
constexpr int kFixedBits = 40;
constexpr Fixed kFullLight = Fixed{1} << kFixedBits;
/// Shade that leaves no light, whatever else is added or taken.
constexpr Fixed kDark = Fixed{1} << 60;

/// Fixed point to the share of full light.
constexpr double to_light(Fixed value) {
  return static_cast<double>(value) * (1.0 / static_cast<double>(kFullLight));
}

/// A voxel's indices; z counts upwards from the ground layer 0.
struct Voxel {
  std::int32_t x = 0, y = 0, z = 0;
  bool operator==(const Voxel&) const = default;
};

/// Where voxel (0,0,0) has its centre (metres, local) and how long its edge is (Yi 2018, section 3: rho / 2).
struct VoxelFrame {
  Vec3 origin = Vec3::Zero();
  double edge_m = 0.05;

  Voxel at(const Vec3& position) const {
    const Vec3 cell = (position - origin) / edge_m;
    return {static_cast<std::int32_t>(std::floor(cell.x() + 0.5)),
            static_cast<std::int32_t>(std::floor(cell.y() + 0.5)),
            static_cast<std::int32_t>(std::floor(cell.z() + 0.5))};
  }
};

}  // namespace dendrofit
