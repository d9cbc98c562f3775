// SPDX-License-Identifier: GPL-3.0-or-later
// Leafy shoots for a tree model that ends coarser than twigs, so that its leaves have something to stand on.
#pragma once

#include "core/tree.h"
#include "forward/leaves/bearing.h"

#include <cstdint>
#include <vector>

namespace dendrofit {

struct TwigGrowth {
  Tree twigs;                        ///< every shoot with its side twigs is a root of its own
  std::vector<std::int32_t> bearer;  ///< of every twig node: the tree's node the shoot leaves from
};

/// Shoots spread over `wood` (the bearing wood of the coarse model), together about `length_m` long: the more
/// of it a metre of wood must carry, the longer each. Radii are extrapolated (RadiusQuality).
TwigGrowth grow_twigs(const Tree& tree, const BearingWood& wood, double length_m, std::uint64_t seed);

/// The tree with its shoots: nodes 0..tree.size()-1 are the tree's own.
Tree with_twigs(const Tree& tree, const TwigGrowth& growth);

}  // namespace dendrofit
