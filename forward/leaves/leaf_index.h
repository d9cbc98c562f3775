// SPDX-License-Identifier: GPL-3.0-or-later
// Leaves already placed, in a grid of cells grouped into blocks. A leaf belongs to the block its foot lies
// in; blocks are so wide that leaves of two blocks with a third between them can neither meet nor share a
// cell, so blocks of one of eight colours may be worked on at once, and the outcome does not depend on who
// comes first.
#pragma once

#include "core/types.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <unordered_map>
#include <vector>

namespace dendrofit {

class LeafIndex {
 public:
  /// `reach_m`: no vertex of a leaf is further from its foot; `half_extent_m`: no leaf's box is wider than
  /// twice this.
  /// `origin`: near the tree; boxes are kept about it in single precision.
  LeafIndex(double reach_m, double half_extent_m, const Vec3& origin);

  /// Makes room for leaves with feet at these points; call before insert, from one thread.
  void prepare(const std::vector<Vec3>& feet);
  void resize(std::size_t slots);

  /// The block of a foot, as a number that sorts, and its colour 0..7.
  std::uint64_t block_of(const Vec3& foot) const;
  int colour_of(std::uint64_t block) const;

  /// Records the box of the leaf in `slot`.
  void insert(std::uint32_t slot, const Vec3& lo, const Vec3& hi);

  /// Calls visit(slot) for leaves whose boxes come within `gap` of this one, until it returns false; returns
  /// whether it was never false. Leaves come in an order that does not depend on threads.
  template <class Visit>
  bool each_near(const Vec3& lo, const Vec3& hi, double gap, const Visit& visit) const {
    const Vec3 wide = Vec3::Constant(half_extent_ + gap);
    const std::array<std::int64_t, 3> first = cell_at(lo - wide), last = cell_at(hi + wide);
    const Box box = outward(lo - origin_ - Vec3::Constant(gap), hi - origin_ + Vec3::Constant(gap));
    const std::array<std::int64_t, 3> b0 = block_at(first), b1 = block_at(last);
    std::array<std::int64_t, 3> b;
    for (b[0] = b0[0]; b[0] <= b1[0]; ++b[0])
      for (b[1] = b0[1]; b[1] <= b1[1]; ++b[1])
        for (b[2] = b0[2]; b[2] <= b1[2]; ++b[2]) {
          const std::uint32_t* heads = heads_of(b);
          if (!heads) continue;
          std::array<std::int64_t, 3> from, to;  // cells of this block
          for (std::size_t k = 0; k < 3; ++k) {
            from[k] = std::max<std::int64_t>(first[k] - b[k] * cells_, 0);
            to[k] = std::min<std::int64_t>(last[k] - b[k] * cells_, cells_ - 1);
          }
          for (std::int64_t x = from[0]; x <= to[0]; ++x)
            for (std::int64_t y = from[1]; y <= to[1]; ++y)
              for (std::int64_t z = from[2]; z <= to[2]; ++z)
                for (std::uint32_t slot = heads[(x * cells_ + y) * cells_ + z]; slot != kNone;
                     slot = boxes_[slot].next)
                  if (overlap(box, boxes_[slot]) && !visit(slot)) return false;
        }
    return true;
  }

 private:
  static constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();
  struct Box {
    std::array<float, 3> lo, hi;
    std::uint32_t next = kNone;
  };
  static Box outward(const Vec3& lo, const Vec3& hi);
  static bool overlap(const Box& a, const Box& b) {
    return a.lo[0] <= b.hi[0] && b.lo[0] <= a.hi[0] && a.lo[1] <= b.hi[1] && b.lo[1] <= a.hi[1] &&
           a.lo[2] <= b.hi[2] && b.lo[2] <= a.hi[2];
  }
  std::array<std::int64_t, 3> cell_at(const Vec3& p) const;
  std::array<std::int64_t, 3> block_at(const std::array<std::int64_t, 3>& cell) const;
  const std::uint32_t* heads_of(const std::array<std::int64_t, 3>& block) const;

  Vec3 origin_;
  double half_extent_;
  double cell_;
  std::int64_t cells_;                                         // along a block's edge
  std::unordered_map<std::uint64_t, std::size_t> first_head_;  // block -> its first cell
  std::vector<std::uint32_t> heads_;
  std::vector<Box> boxes_;
};

}  // namespace dendrofit
