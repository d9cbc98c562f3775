// SPDX-License-Identifier: GPL-3.0-or-later
// Centre lines and radii of a carved tree, settled from what the pictures show.
#pragma once

#include "core/tree.h"
#include "recon/image/sightings.h"

namespace dendrofit {

/// Cylinders without support (see support_of) in `least_views`, with all they bear that has none either, are
/// shadows where silhouettes meet by chance: 1 for those to keep. The stem's first cylinder stays.
std::vector<char> supported(const Tree& tree, const Sightings& sightings, int least_views);

/// Moves each cylinder across its axis to where the views' stretches meet (least squares with falling weight
/// of what is far off), evened along the axes.
void centre_on_views(Tree& tree, const Sightings& sightings);

/// Radii as the median over the views in which a cylinder is alone: quality measured where there are two or
/// more, interpolated between such places on one axis, elsewhere extrapolated by the tree's own relation of
/// radius to the wood length beyond. Radii never grow towards the tips.
void settle_radii_from_views(Tree& tree, const Sightings& sightings);

}  // namespace dendrofit
