// SPDX-License-Identifier: GPL-3.0-or-later
// How much of each pixel wood covers.
#pragma once

#include "recon/image/segmentation.h"
#include "recon/image/sky.h"

namespace dendrofit {

/// Fills `cover` from the light over the sky's (grey levels made linear): 0 at the sky's, 1 at the bark's
/// (its mean nearby; of twigs, which show none, the median of all wood). Below the horizon the silhouette
/// itself.
void set_cover(Silhouette& silhouette, const SkyRatio& sky);

/// The silhouette without the soft edges of wood and without the gaps these fill between neighbours: pixels
/// that are covered for the most part, or whose cover bends downwards to its sides (in the direction, of
/// four, in which it bends most). What a mask gives has no soft edges and stays as it is.
std::vector<std::uint8_t> sharpened(const Silhouette& silhouette);

}  // namespace dendrofit
