// SPDX-License-Identifier: GPL-3.0-or-later
// A unit of length for views that have none.
#pragma once

#include "core/photograph.h"
#include "core/progress.h"
#include "recon/image/frame.h"

namespace dendrofit {

/// Scales a set without a unit (metric = false) so that the tree in it is `height_m` tall: by its carved
/// space, along +z. Throws as reconstruct_views does where the views give no tree.
void scale_to_height(ViewSet& set, double height_m, Progress& progress = no_progress());

/// Scales a set without a unit by a bar in its first view, at the stem: in the upright plane through the
/// stem's foot that faces that camera. Throws SolverError where fewer than three views hold the foot, and
/// InputError where the bar's pixels do not meet that plane.
void scale_to_bar(ViewSet& set, const ScaleBar& bar);

}  // namespace dendrofit
