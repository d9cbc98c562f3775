// SPDX-License-Identifier: GPL-3.0-or-later
// Triangle meshes, and the mesh of a tree's wood.
#pragma once

#include "core/tree.h"
#include "core/types.h"

#include <array>
#include <cstdint>
#include <vector>

namespace dendrofit {

/// Indexed triangles, counter-clockwise seen from outside. World = origin_shift + local (metres).
struct TriangleMesh {
  Vec3 origin_shift = Vec3::Zero();
  std::vector<Vec3> vertices;
  std::vector<std::array<std::uint32_t, 3>> triangles;

  /// Appends another mesh's triangles; both must share the origin shift (InputError else).
  void append(const TriangleMesh& other);
  /// Throws InputError when a vertex is not finite or a triangle names a vertex that does not exist.
  void validate() const;
};

/// Whether the triangles enclose a body: every edge belongs to an even number of them, vertices at the same
/// place taken for one. False without triangles.
bool is_closed(const TriangleMesh& mesh);

struct TreeMeshOptions {
  int min_sides = 5;   ///< of the thinnest twigs
  int max_sides = 24;  ///< of the thickest stem
  void validate() const;
};

/// The wood as closed tubes, one an axis: rings between neighbouring cylinders carry their mean radius, so
/// that a stem looks smooth; both ends are capped.
TriangleMesh tree_mesh(const Tree& tree, const TreeMeshOptions& options = {});

}  // namespace dendrofit
