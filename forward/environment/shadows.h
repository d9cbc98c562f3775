// SPDX-License-Identifier: GPL-3.0-or-later
// What nodes take from the voxels below them (Yi 2018, 4.5 and Fig. 10): an inverted square pyramid of 20
// layers, then a column of the same 41 x 41 base down to the ground, b^-q at q layers below. Weights are in
// fixed point (2^-40); those below half a unit (q > 48 for b = 1.8) are 0: columns are complete.
#pragma once

#include "forward/environment/voxels.h"

#include <algorithm>
#include <cstddef>
#include <span>
#include <utility>
#include <vector>

namespace dendrofit {

constexpr int kPyramidLayers = 20;

/// A shadow reaches so many voxels to each side, q layers below its node.
constexpr int shadow_half_width(int q) {
  return q < kPyramidLayers ? q : kPyramidLayers;
}

/// b^-q in fixed point for q = 0, 1, ... until it vanishes.
class ShadeProfile {
 public:
  /// b > 1.
  explicit ShadeProfile(double b);
  int layers() const { return static_cast<int>(weight_.size()) - 1; }
  /// The weights as an array of layers() + 1, the last one 0.
  const Fixed* padded() const { return weight_.data(); }
  Fixed operator[](int q) const { return weight_[static_cast<std::size_t>(q)]; }

 private:
  std::vector<Fixed> weight_;  // ends with a 0
};

/// Voxels of one layer: x0 <= x <= x1, y0 <= y <= y1; none if x0 > x1.
struct VoxelRect {
  std::int32_t x0 = kNone, y0 = kNone, x1 = -kNone, y1 = -kNone;
  bool empty() const { return x0 > x1; }
  bool holds(const VoxelRect& r) const { return r.x0 >= x0 && r.y0 >= y0 && r.x1 <= x1 && r.y1 <= y1; }
  void add(const VoxelRect& r);
  std::int64_t width() const { return empty() ? 0 : std::int64_t{x1} - x0 + 1; }
  std::int64_t height() const { return empty() ? 0 : std::int64_t{y1} - y0 + 1; }

  static constexpr std::int32_t kNone = 1 << 29;
};

/// Voxels in order of layer and row.
class VoxelRows {
 public:
  struct Layer {
    VoxelRect span;         // of its voxels
    std::size_t first = 0;  // row span.y0's place in starts()
  };
  /// Places in order(), the last one past the end.
  using Range = std::pair<std::uint32_t, std::uint32_t>;

  /// Voxels of other layers than the `count` from `lowest` on are left out.
  VoxelRows(std::span<const Voxel> at, std::int32_t lowest, std::size_t count);
  std::int32_t lowest() const { return lowest_; }
  std::int32_t highest() const { return lowest_ + static_cast<std::int32_t>(layers_.size()) - 1; }
  /// Of layer z, lowest() <= z <= highest().
  const Layer& layer(std::int32_t z) const { return layers_[static_cast<std::size_t>(z - lowest_)]; }
  /// Voxels of layer z with y0 <= y < y1.
  Range rows(std::int32_t z, std::int32_t y0, std::int32_t y1) const {
    const Layer& of = layer(z);
    const std::int32_t from = std::max(y0, of.span.y0), to = std::min(y1, of.span.y1 + 1);
    if (from >= to) return {0, 0};
    return {start_[of.first + static_cast<std::size_t>(from - of.span.y0)],
            start_[of.first + static_cast<std::size_t>(to - of.span.y0)]};
  }
  /// Voxels of the layers z0 <= z <= z1.
  Range layers(std::int32_t z0, std::int32_t z1) const;
  /// The voxels' numbers.
  std::span<const std::uint32_t> order() const { return order_; }
  /// Where each row's voxels start in order(), row after row, and the end.
  const std::vector<std::uint32_t>& starts() const { return start_; }

 private:
  std::int32_t lowest_;
  std::vector<Layer> layers_;
  std::vector<std::uint32_t> start_, order_;
};

/// The shadows of nodes with one profile, sorted so that what they do to a layer can be drawn
/// or summed at single voxels.
class Shadows {
 public:
  /// `sign` +1, or -1 to take shadows back. Nodes outside the layers lowest..highest are left out.
  Shadows(std::span<const Voxel> nodes, std::int32_t lowest, std::int32_t highest,
          const ShadeProfile& profile, int sign);
  const VoxelRows& rows() const { return rows_; }
  std::int32_t x(std::uint32_t place) const { return x_[place]; }
  std::int32_t y(std::uint32_t place) const { return y_[place]; }
  /// What a node takes q layers below.
  Fixed amount(int q) const { return sign_ * profile_[q]; }
  /// Layers up, first and last, at which nodes may lie that shade layer z; none if first > last.
  std::pair<int, int> steps(std::int32_t z) const;
  /// How many nodes lie there.
  std::size_t count_above(std::int32_t z) const;
  /// The voxels of layer z they may reach.
  VoxelRect reach(std::int32_t z) const;
  /// Adds their shade at voxels of layer z.
  void add_at(std::int32_t z, std::span<const Voxel> at, std::span<Fixed> shade) const;

 private:
  ShadeProfile profile_;
  int sign_;
  VoxelRows rows_;
  std::vector<std::int32_t> x_, y_;  // of the nodes, in that order
};

}  // namespace dendrofit
