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

}  // namespace dendrofit
