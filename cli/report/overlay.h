// SPDX-License-Identifier: GPL-3.0-or-later
// A tree, or its outline, drawn over the photograph it was found in.
#pragma once

#include "cli/report/image.h"
#include "core/photograph.h"
#include "core/tree.h"
#include "recon/image/segmentation.h"

namespace dendrofit {

/// The photograph, paler, with every cylinder's axis as a line in its order's colour and a ring at the feet.
/// Halved until its longer side has at most `longest_side_px` pixels. `shift`: from the tree's local
/// coordinates to the camera's (tree.origin_shift - views.origin_shift). Cylinders behind the camera are left
/// out. Throws InputError for a broken photograph.
Image draw_overlay(const Photograph& photo, const Camera& camera, const Tree& tree, const Vec3& shift,
                   int longest_side_px = 2300);

/// The photograph, paler and halved alike, with the tree's outermost pixels marked: of a crown of which no
/// more is told. Throws InputError for a broken photograph.
Image draw_outline(const Photograph& photo, const Silhouette& silhouette, int longest_side_px = 2300);

}  // namespace dendrofit
