// SPDX-License-Identifier: GPL-3.0-or-later
// The outermost twigs, where single masks lose what most still show.
#pragma once

#include "core/photograph.h"
#include "core/tree.h"
#include "recon/image/outline.h"

#include <vector>

namespace dendrofit {

/// Carving ends a twig where the first view loses it. Each axis goes on straight ahead while three quarters
/// of the views hold the way on their mask (within 0.7 px), over gaps of two pixels in all of them, for at
/// most as long as the axis is and 0.3 m. The new cylinders carry their axis's last radius, quality
/// extrapolated.
void extend_tips(Tree& tree, const std::vector<Camera>& cameras, const std::vector<Outline>& outlines);

}  // namespace dendrofit
