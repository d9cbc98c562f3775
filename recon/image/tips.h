// SPDX-License-Identifier: GPL-3.0-or-later
// The outermost twigs, where single masks lose what others still show.
#pragma once

#include "core/photograph.h"
#include "core/tree.h"
#include "recon/image/outline.h"

#include <vector>

namespace dendrofit {

/// Carving ends a twig where the first view loses it; a twig under a pixel wide is dots in a mask, others in
/// each view. From each tip the tree goes on, in steps of five pixels that may bend, along wood that no
/// cylinder explains in a third of the views (three at least; all of two or three), for at most 0.3 m and as
/// long as its axis is. The new cylinders' radii are the tip's, where fewer than three quarters of the views
/// show them less than a pixel; quality extrapolated. Cylinders in the frame of the cameras' world.
void extend_tips(Tree& tree, const std::vector<Camera>& cameras, const std::vector<Outline>& outlines,
                 int threads = 0);

}  // namespace dendrofit
