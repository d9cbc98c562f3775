// SPDX-License-Identifier: GPL-3.0-or-later
// Do two things keep a distance? Every test here may only err on the safe side: "clear" is always true.
#pragma once

#include "core/foliage.h"
#include "core/types.h"

#include <array>
#include <vector>

namespace dendrofit {

/// A cylinder with flat ends, and a frame to see it from.
struct SolidCylinder {
  Vec3 base = Vec3::Zero();
  Vec3 axis = Vec3::UnitZ();
  Vec3 side = Vec3::UnitX();
  Vec3 other = Vec3::UnitY();
  double length = 0;
  double radius = 0;
};

SolidCylinder solid_cylinder(const Vec3& start, const Vec3& end, double radius);

/// How far a blade of length 1 reaches.
struct BodyPlan {
  double reach = 0;  ///< from its origin
  double width = 0;  ///< between any two of its vertices
  explicit BodyPlan(const LeafShape& s);
};

/// One leaf as it will be written: blade and petiole on whole micrometres.
struct LeafBody {
  const LeafShape* shape = nullptr;
  std::array<Vec3, 3> frame;   ///< blade's across, direction, normal
  std::array<double, 3> from;  ///< its least and
  std::array<double, 3> to;    ///< greatest coordinate along each
  std::vector<Vec3> blade;
  std::array<Vec3, 4> petiole;
  bool has_petiole = false;
  Vec3 lo, hi;  ///< of both
  Vec3 blade_lo, blade_hi;

  /// Fills itself in; keeps its storage from leaf to leaf.
  void set(const Leaf& leaf, const LeafShape& s);
};

/// True if some plane separates the triangles by more than `gap`.
bool triangles_clear(const std::array<const Vec3*, 3>& a, const std::array<const Vec3*, 3>& b, double gap);
/// True if blades and petioles of the two leaves all keep more than `gap`.
bool leaves_clear(const LeafBody& a, const LeafBody& b, double gap);
/// True if blade and petiole keep more than `gap` from the solid cylinder (measured along its axis or away
/// from it).
bool cylinder_clear(const LeafBody& leaf, const SolidCylinder& cylinder, double gap);

}  // namespace dendrofit
