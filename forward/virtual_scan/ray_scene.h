// SPDX-License-Identifier: GPL-3.0-or-later
// Rays against a tree: exact cones for the wood, triangles for the leaves, a disc for the ground.
#pragma once

#include "core/foliage.h"
#include "core/tree.h"
#include "core/types.h"

#include <cstdint>
#include <memory>
#include <optional>

namespace dendrofit {

struct RayHit {
  enum class What : std::uint8_t { nothing, wood, leaf, ground };
  What what = What::nothing;
  std::int32_t id = -1;  ///< node or leaf
  double range_m = 0;
};

/// Immutable once built; cast() may be called from any thread.
class RayScene {
 public:
  /// `centre` (local frame) becomes the scene's origin, so that single precision loses nothing that matters.
  /// The ground is a horizontal disc about it.
  RayScene(const Tree& tree, const Foliage* foliage, bool tapered, const Vec3& centre,
           std::optional<double> ground_radius_m);
  ~RayScene();
  RayScene(const RayScene&) = delete;
  RayScene& operator=(const RayScene&) = delete;

  /// First thing along a ray (origin in the tree's local frame, unit direction).
  RayHit cast(const Vec3& origin, const Vec3& direction, double max_range_m) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace dendrofit
