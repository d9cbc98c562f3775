// SPDX-License-Identifier: GPL-3.0-or-later
// The common ground of all QSM files: rows of cylinders in world coordinates, to and from a Tree.
#pragma once

#include "core/tree.h"
#include "core/types.h"

#include <cstdint>
#include <filesystem>
#include <limits>
#include <vector>

namespace dendrofit {

/// One cylinder as a file states it.
struct CylinderRow {
  std::int64_t id = 0;
  std::int64_t parent = 0;    ///< id of the parent, or the file's word for none
  Vec3 start = Vec3::Zero();  ///< world, metres
  Vec3 axis = Vec3::Zero();   ///< unit, used where length > 0
  double length = 0;          ///< metres; 0: `end` is given instead
  Vec3 end = Vec3::Zero();    ///< world, metres
  double radius = 0;
  std::int64_t axis_id = kUnknown;
  std::int64_t order = kUnknown;
  RadiusQuality quality = RadiusQuality::measured;
  double radius_se = std::numeric_limits<double>::quiet_NaN();
  std::size_t line = 0;  ///< in the file (for messages); 0: none, the id is named instead

  static constexpr std::int64_t kUnknown = std::numeric_limits<std::int64_t>::min();
};

struct CylinderRules {
  std::int64_t no_parent = 0;   ///< a root's parent; negative numbers always are
  bool skip_degenerate = true;  ///< join over cylinders without length or radius instead of refusing them
};

/// Makes the tree: local coordinates about a shift that keeps every coordinate's bits, parents sorted before
/// children, ends put on the start of the cylinder that goes on there (within 0.1 nm), other ends on a 2^-29
/// m grid, axes and orders from the rows where each axis is an unbranched run (a break starts a new axis),
/// orders relative to the parent's; without axis ids, the thickest child of the same order goes on; without
/// orders, by thickness. Throws IoError naming file and line: no row, repeated id, unknown parent, circle,
/// wrong numbers.
Tree tree_from_cylinders(const std::filesystem::path& path, const std::vector<CylinderRow>& rows,
                         const CylinderRules& rules);

/// A tree's cylinders as every writer prints them: world coordinates, ends as tree_from_cylinders() will set
/// them, so that writing, reading and writing again changes no bit.
struct WrittenCylinders {
  std::vector<Vec3> start;  ///< world
  std::vector<Vec3> end;    ///< world, rounded to double
  std::vector<Vec3> axis;   ///< unit
  std::vector<double> length;
};
WrittenCylinders written_cylinders(const Tree& tree);

/// For each axis: 0 where a coordinate is under 100 m, else a multiple of 100 m near the values in [lo, hi],
/// and 0 again where subtracting it would lose a bit of the smallest of them.
Vec3 exact_origin_shift(const Vec3& lo, const Vec3& hi);

}  // namespace dendrofit
