// SPDX-License-Identifier: GPL-3.0-or-later
// The voxel frame light and obstacles share, and light in fixed point.
#pragma once

#include "core/types.h"

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

/// The largest whole number not above `value`. (std::floor is a function call where the compiler may not
/// assume SSE 4.1.)
inline std::int32_t floor_to_int(double value) {
  const auto whole = static_cast<std::int32_t>(value);
  return whole - static_cast<std::int32_t>(value < whole);
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
    return {floor_to_int(cell.x() + 0.5), floor_to_int(cell.y() + 0.5), floor_to_int(cell.z() + 0.5)};
  }
};

}  // namespace dendrofit
