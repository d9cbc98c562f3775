// SPDX-License-Identifier: GPL-3.0-or-later
// The light every node takes from the voxels below it (Yi 2018, 4.5 and Fig. 10): an inverted square pyramid
// of 20 layers, then a column of the same 41 x 41 base down to the ground, b^-q at q layers below.
//
// The field is kept as one 2-D difference array a layer, in bricks of 32 x 32 made when something is cast on
// them: a node adds four corners a layer (about 150 additions where the voxels themselves would be 40,000),
// and reading integrates each layer once. Sums are in fixed point (2^-40), so the result does not depend on
// the order of anything, equals voxel by voxel addition to the last bit, and removal is exact. Weights below
// half a unit (q > 48 for b = 1.8) are 0: columns are complete.
#pragma once

#include "forward/environment/voxels.h"
#include "forward/environment/zero_arena.h"

#include <cstddef>
#include <span>
#include <vector>

namespace dendrofit {

constexpr int kPyramidLayers = 20;

/// b^-q in fixed point for q = 0, 1, ... until it vanishes.
class ShadeProfile {
 public:
  /// b > 1.
  explicit ShadeProfile(double b);
  int layers() const { return static_cast<int>(weight_.size()) - 1; }
  /// The weights as an array of layers() + 1, the last one 0.
  const Fixed* padded() const { return weight_.data(); }
  Fixed operator[](int q) const { return weight_[static_cast<std::size_t>(q)]; }
  /// Shade of a node at a voxel dx, dy away and q layers below it.
  Fixed at(int dx, int dy, int q) const {
    if (q < 0 || q >= layers()) return 0;
    const int half = q < kPyramidLayers ? q : kPyramidLayers;
    return (dx <= half && -dx <= half && dy <= half && -dy <= half) ? weight_[static_cast<std::size_t>(q)]
                                                                    : 0;
  }

 private:
  std::vector<Fixed> weight_;  // ends with a 0
};

class LightField {
 public:
  /// Casting and reading throw InputError where the field would take more than this.
  explicit LightField(double max_gib = 16) : max_gib_(max_gib) {}

  /// Casts (sign +1) or takes back (-1) the shadows of nodes. Layers below 0 are the ground and get none.
  void cast(std::span<const Voxel> nodes, const ShadeProfile& profile, int sign = 1);
  /// Adds shade to one voxel alone.
  void darken(const Voxel& voxel, Fixed amount);
  /// Shade at each voxel, at any place; voxels outside everything cast have 0. Shadows cast since the last
  /// reading are drawn now, so that each layer passes through the processor's cache once for both.
  void read(std::span<const Voxel> at, std::span<Fixed> shade);

 private:
  struct Rect {
    std::int32_t x0 = kNone, y0 = kNone, x1 = -kNone, y1 = -kNone;  // inclusive
    bool empty() const { return x0 > x1; }
    bool holds(const Rect& r) const { return r.x0 >= x0 && r.y0 >= y0 && r.x1 <= x1 && r.y1 <= y1; }
    void add(const Rect& r);
    std::int64_t width() const { return empty() ? 0 : std::int64_t{x1} - x0 + 1; }
    std::int64_t height() const { return empty() ? 0 : std::int64_t{y1} - y0 + 1; }

    static constexpr std::int32_t kNone = 1 << 29;
  };
  struct Layer {
    Rect reach;                  // everything cast, with the corners that close the squares; voxels
    Rect table;                  // which bricks `bricks` has a place for
    std::vector<Fixed*> bricks;  // row after row; none where nothing was cast
  };
  struct Shadows {  // cast, not yet drawn
    ShadeProfile profile;
    int sign;
    std::int32_t lowest;               // layer of the lowest node
    std::vector<std::uint32_t> first;  // nodes of each layer from there on
    std::vector<Voxel> nodes;          // by layer
    std::int32_t highest() const { return lowest + static_cast<std::int32_t>(first.size()) - 2; }
    int reach() const { return profile.layers() - 1; }  // layers down
  };
  struct Queries;
  struct Canvas;

  void check_memory() const;
  Fixed* new_brick();
  static void make_room(Layer& layer);
  void draw(const Shadows& shadows, std::int32_t z, Layer& layer);
  void read_layer(const Layer& layer, std::size_t z, const Queries& queries, std::span<const Voxel> at,
                  std::span<Fixed> shade);

  std::vector<Layer> layers_;
  std::vector<Shadows> pending_;
  std::vector<Fixed> column_, sum_;  // of the rows so far; and along x
  ZeroArena arena_;
  double max_gib_;
};

}  // namespace dendrofit
