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

/// The stems of one tree: one, or several from one stool. The best supported stands first.
using Stool = std::vector<Foot>;

struct Stem {
  Foot foot;
  double thickness_m = 0;  ///< near the ground, without the undergrowth about it
};

/// The feet that bear stems, the first of them always. Another counts only where a stem stands on it: upright
/// wood that goes on above, or a trunk's surface below a low crown, no thinner than a third of the thickest.
/// Boughs that hang to the ground and herbs do not.
std::vector<Stem> tell_stems(const std::vector<Vec3>& points, const PointGraph& graph,
                             const std::vector<double>& height, const std::vector<Foot>& feet);

struct KeptTree {
  Stool stool;
  std::vector<Foot> other_trees;  ///< the first stem of each
  std::size_t other_points =
      0;  ///< of other trees and of what is lower than a third of the tree: posts, shrubs
};

/// Every point goes to the stem from whose foot its shortest path comes. Stems nearer to one another than
/// their thickness (40 cm at least) are one tree's. Keeps the tree that stands nearest to `at` (plan, local),
/// or the one with the most points, and closes (open[i] = 0) all other points. Throws SolverError that names
/// the stems' places (world: local plus origin_shift) where none stands within 2 m of `at`.
KeptTree keep_tree(const std::vector<Vec3>& points, const PointGraph& graph,
                   const std::vector<Bridge>& bridges, const std::vector<Stem>& stems,
                   const std::optional<Eigen::Vector2d>& at, const Vec3& origin_shift,
                   std::vector<char>& open, Progress& progress);

/// The points that paths start from: the lowest ring of every stem.
std::vector<std::uint32_t> ring_of(const Stool& stool);

}  // namespace dendrofit
