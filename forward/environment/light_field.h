// SPDX-License-Identifier: GPL-3.0-or-later
// The light that voxels keep under the shadows of all nodes (Yi 2018, 4.5).
//
// The field is kept as one 2-D difference array a layer, in bricks of 32 x 32 made when something is drawn on
// them: a node adds four corners a layer (about 150 additions where the voxels themselves would be 40,000),
// and reading integrates each layer once. A layer is drawn when it is read; where few voxels of it are asked
// for, as about the stem, the shadows are summed at these alone. Sums are in fixed point, so the result does
// not depend on the order of anything, equals voxel by voxel addition to the last bit, and removal is exact.
#pragma once

#include "forward/environment/shadows.h"
#include "forward/environment/voxels.h"
#include "forward/environment/zero_arena.h"

#include <cstddef>
#include <span>
#include <vector>

namespace dendrofit {

class LightField {
 public:
  /// Casting and reading throw InputError where the field would take more than this.
  explicit LightField(double max_gib = 16) : max_gib_(max_gib) {}

  /// Casts (sign +1) or takes back (-1) the shadows of nodes. Layers below 0 are the ground and get none.
  void cast(std::span<const Voxel> nodes, const ShadeProfile& profile, int sign = 1);
  /// Adds shade to one voxel alone.
  void darken(const Voxel& voxel, Fixed amount);
  /// Shade at each voxel, at any place; voxels outside everything cast have 0.
  void read(std::span<const Voxel> at, std::span<Fixed> shade);
  /// The same for voxels that are read again and again: the first `known` have in `shade` what the last
  /// update() gave them, and only what was cast since is added to them (not what was darkened).
  void update(std::span<const Voxel> at, std::span<Fixed> shade, std::size_t known);

 private:
  struct Layer {
    VoxelRect reach;             // everything cast, with the corners that close the squares; voxels
    VoxelRect table;             // which bricks `bricks` has a place for
    std::vector<Fixed*> bricks;  // row after row; none where nothing was drawn
    std::size_t drawn = 0;       // shadows that are in the bricks; the others of cast_ are not
  };
  struct Canvas;
  // The voxels of one layer a reading asks for: those known first, then those to be read in full.
  struct Asked {
    std::vector<std::uint32_t> number;
    std::vector<Voxel> place;
    std::vector<Fixed> shade;
    std::size_t known = 0;
  };

  void check_memory() const;
  Fixed* new_brick();
  static void make_room(Layer& layer);
  void draw(std::int32_t z);
  bool worth_drawing(std::int32_t z) const;
  void read_layer(std::int32_t z, const VoxelRows& queries, std::span<const Voxel> at, std::span<Fixed> shade,
                  std::size_t known);
  void integrate(std::int32_t z, const VoxelRows& queries, std::span<const Voxel> at, std::span<Fixed> shade,
                 std::size_t known);

  std::vector<Layer> layers_;
  std::vector<Shadows> cast_;
  std::size_t updated_ = 0;  // shadows the last update() knew
  Asked asked_;
  std::vector<Fixed> column_, sum_;  // of the rows so far; and along x
  ZeroArena arena_;
  double max_gib_;
};

}  // namespace dendrofit
