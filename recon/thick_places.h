// SPDX-License-Identifier: GPL-3.0-or-later
// Places on limbs that are thick enough to tell from which side a point saw them.
#pragma once

#include "core/types.h"
#include "recon/skeleton.h"

#include <cstddef>
#include <vector>

namespace dendrofit {

/// One place on thick wood: a short cylinder and the points about it. Holds while the limbs do.
struct ThickPlace {
  const LimbNode* node = nullptr;
  Vec3 u = Vec3::UnitX(), v = Vec3::UnitY();  ///< unit vectors across
  /// A point relative to the place's middle, seen along the wood.
  Eigen::Vector2d across(const Vec3& point) const;
  /// Of each of its points: thick stems have most points and are the least round, so a place counts as so
  /// many points at most.
  double point_weight() const;
};

std::vector<ThickPlace> thick_places(const std::vector<Limb>& limbs, double noise_m);

}  // namespace dendrofit
