// SPDX-License-Identifier: GPL-3.0-or-later
// Several stems in one scan: those of the tree to model told from its neighbours'.
#pragma once

#include "core/progress.h"
#include "core/types.h"
#include "recon/foot.h"
#include "recon/graph.h"

#include <cstddef>
#include <optional>
#include <vector>

namespace dendrofit {

/// The stems of one tree: one, or several from one stool. The thickest stands first.
using Stool = std::vector<Foot>;

/// The trees that stand on these feet, that of the first foot first. A foot beside it counts only where a
/// stem stands on it: upright wood that goes on above, or a trunk's surface below a low crown, no thinner
/// than a third of the thickest. Boughs that hang to the ground and herbs do not. Stems nearer than their own
/// thickness (40 cm at least) share a stool.
std::vector<Stool> tell_trees(const std::vector<Vec3>& points, const PointGraph& graph,
                              const std::vector<double>& height, const std::vector<Foot>& feet);

/// All their feet.
std::vector<Foot> stems_of(const std::vector<Stool>& trees);

struct KeptTree {
  std::size_t tree = 0;                  ///< index
  std::vector<std::size_t> other_trees;  ///< those of the others that are no less than a third as high
  std::size_t other_points = 0;          ///< points of all others
};

/// Every point goes to the tree from whose feet its shortest path comes. Keeps the one `wanted` (an
/// index), or else the one with the most points, and closes (open[i] = 0) the others' points.
KeptTree keep_tree(const std::vector<Vec3>& points, const PointGraph& graph,
                   const std::vector<Bridge>& bridges, const std::vector<Stool>& trees,
                   std::optional<std::size_t> wanted, std::vector<char>& open, Progress& progress);

/// Index of the tree with the stem nearest to `at` (plan, local). Throws SolverError that names the stems
/// (world: local plus origin_shift) where none stands within 2 m of it.
std::size_t tree_nearest_to(const Eigen::Vector2d& at, const std::vector<Stool>& trees,
                            const Vec3& origin_shift);

/// The points that paths start from: the lowest ring of every stem.
std::vector<std::uint32_t> ring_of(const Stool& stool);

}  // namespace dendrofit
