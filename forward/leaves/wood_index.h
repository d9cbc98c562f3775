// SPDX-License-Identifier: GPL-3.0-or-later
// All cylinders of a tree in a grid, to ask which are near.
#pragma once

#include "core/tree.h"
#include "forward/leaves/clearance.h"

#include <cstdint>
#include <unordered_map>
#include <vector>

namespace dendrofit {

class WoodIndex {
 public:
  /// `cell_m`: about the reach of the queries.
  WoodIndex(const Tree& tree, double cell_m);

  /// Cylinders whose surface comes within `reach` of `centre` (metres), in rising index. Replaces `out`.
  void near(const Vec3& centre, double reach, std::vector<std::int32_t>& out) const;
  const SolidCylinder& cylinder(std::int32_t i) const { return cylinders_[static_cast<std::size_t>(i)]; }

 private:
  std::uint64_t key(std::int64_t x, std::int64_t y, std::int64_t z) const;
  std::vector<SolidCylinder> cylinders_;
  double cell_;
  Vec3 lo_ = Vec3::Zero();
  std::unordered_map<std::uint64_t, std::uint32_t> cell_of_;  // -> row
  std::vector<std::uint32_t> first_;
  std::vector<std::int32_t> entry_;
};

/// Square of the distance from `p` to the segment from `a` along unit `axis` for `length`.
double distance2_to_segment(const Vec3& p, const Vec3& a, const Vec3& axis, double length);

}  // namespace dendrofit
