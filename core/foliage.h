// SPDX-License-Identifier: GPL-3.0-or-later
// Leaves on a tree, as instances of a few leaf shapes.
#pragma once

#include "core/mesh.h"
#include "core/tree.h"
#include "core/types.h"

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace dendrofit {

/// A leaf's blade in its own frame: the petiole joins at the origin, +y runs to the tip, +z is the upper
/// side. Its length (extent along y) is 1; a leaf scales it by its length in metres.
struct LeafShape {
  std::string name;
  std::vector<Vec3> vertices;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  double petiole_width = 0.015;  ///< of its stalk, as a share of the blade's length

  double unit_area() const;  ///< one-sided area at length 1 (square metres)
  /// Throws InputError for a degenerate triangle, a vertex that is not finite, or no triangle at all.
  void validate() const;
};

/// One leaf. Blade vertex = origin + length_m * (x * (direction x normal) + y * direction + z * normal).
struct Leaf {
  Vec3 petiole_foot = Vec3::Zero();  ///< just off the wood's surface, metres, local
  Vec3 origin = Vec3::Zero();        ///< where petiole and blade meet, metres, local
  Vec3 direction = Vec3::UnitY();    ///< unit, from origin to the blade's tip
  Vec3 normal = Vec3::UnitZ();       ///< unit, upper side, perpendicular to direction
  double length_m = 0;               ///< of the blade
  std::int32_t node = -1;            ///< the tree node (cylinder) that bears it
  std::uint16_t shape = 0;           ///< index into Foliage::shapes
};

/// The blade's vertices where they are written: local metres, rounded to whole micrometres. Replaces `out`.
void blade_vertices(const Leaf& leaf, const LeafShape& shape, std::vector<Vec3>& out);
/// The petiole's strip, rounded alike: its four corners, triangles 0 1 2 and 0 2 3. False where there is
/// none.
bool petiole_corners(const Leaf& leaf, const LeafShape& shape, std::array<Vec3, 4>& out);

/// All leaves of a tree. World = origin_shift + local, with the tree's own shift.
struct Foliage {
  Vec3 origin_shift = Vec3::Zero();
  std::string species;
  std::vector<LeafShape> shapes;
  std::vector<Leaf> leaves;
  /// Shoots the leaves stand on where the tree itself ends coarser than twigs; rooted where they leave its
  /// wood. Such a leaf's `node` is the tree's node that bears the shoot.
  Tree twigs;

  std::size_t size() const { return leaves.size(); }
  double leaf_area(std::size_t i) const;
  double total_area() const;
  /// Appends the blade of leaf i, triangle for triangle as its shape has them (local coordinates, rounded to
  /// 1 um: the very numbers every writer prints and every intersection test sees).
  void append_blade(std::size_t i, TriangleMesh& mesh) const;
  /// Appends the petiole of leaf i: two triangles, or none for a leaf that sits on the wood.
  void append_petiole(std::size_t i, TriangleMesh& mesh) const;
};

}  // namespace dendrofit
