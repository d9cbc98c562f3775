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
  enum class What : std::uint8_t { nothing, wood, leaf, ground, grass };
  What what = What::nothing;
  std::int32_t id = -1;  ///< node or leaf
  double range_m = 0;
};

/// A disc of ground about the scene's centre, rising towards +x.
struct GroundDisc {
  double radius_m = 0;
  double rise = 0;  ///< metres a metre
};

/// Immutable once built; cast() may be called from any thread.
class RayScene {
 public:
  /// `centre` (local frame) becomes the scene's origin, so that single precision loses nothing that matters.
  RayScene(const Tree& tree, const Foliage* foliage, bool tapered, const Vec3& centre,
           const std::optional<GroundDisc>& ground);
  ~RayScene();
  RayScene(const RayScene&) = delete;
  RayScene& operator=(const RayScene&) = delete;

  /// First thing along a ray (origin in the tree's local frame, unit direction). Grass stops it at
  /// `grass_m` above the ground.
  RayHit cast(const Vec3& origin, const Vec3& direction, double max_range_m, double grass_m = 0) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace dendrofit
