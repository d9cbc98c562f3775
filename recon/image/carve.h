// SPDX-License-Identifier: GPL-3.0-or-later
// Shape from silhouettes: the space that every view's mask allows, carved on an octree (Laurentini's visual
// hull; Szeliski 1993 for the octree).
#pragma once

#include "core/photograph.h"
#include "core/point_cloud.h"
#include "core/progress.h"
#include "core/types.h"
#include "recon/image/outline.h"

#include <cstdint>
#include <vector>

namespace dendrofit {

struct CarveOptions {
  double cell_m = 0.003;      ///< side of the smallest cells
  double tolerance_px = 0.7;  ///< this far outside a mask still counts as inside: half a pixel and some blur
  int misses_allowed = 0;     ///< views in which a cell may lie outside the mask
  std::size_t most_cells = 3'000'000;          ///< a hull of many more is kept in cells twice as large
  std::size_t most_coarse_cells = 16'000'000;  ///< and of many more of these in larger ones still
  int threads = 0;
  void validate() const;
};

/// The hull's skin: smallest cells within about one cell of its surface, in order of a space-filling curve.
struct Hull {
  double cell_m = 0;                  ///< of these cells: the options', or a power of two times that
  std::vector<Vec3> cells;            ///< centres, metres, local
  std::vector<std::uint64_t> misses;  ///< bit i: outside the mask of view i (first 64 views)
};

/// Carves what the views (cameras[i] with outlines[i]) have in common. Beyond a side of the picture that the
/// mask touches a view says nothing; what fewer than two views, or fewer than half, speak of is not kept. The
/// hull is empty where no place lies inside all masks. Throws InputError where the sizes do not agree or a
/// mask is empty, SolverError where the views look nowhere in common.
Hull carve(const std::vector<Camera>& cameras, const std::vector<Outline>& outlines,
           const CarveOptions& options, Progress& progress = no_progress());

/// Twice the resolution of the middle view at the tree: half the median pixel footprint, at least 3 mm.
double carving_cell_m(const std::vector<Camera>& cameras, const std::vector<Outline>& outlines);

/// Where the rays through the masks' middles pass nearest to each other.
Vec3 common_middle(const std::vector<Camera>& cameras, const std::vector<Outline>& outlines);

/// Share of each view's mask that cells (centres, of side `cell_m`) cover.
std::vector<double> explained_shares(const std::vector<Vec3>& cells, double cell_m,
                                     const std::vector<Camera>& cameras, const std::vector<Outline>& outlines,
                                     int threads = 0);

}  // namespace dendrofit
