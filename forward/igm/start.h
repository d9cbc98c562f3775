// SPDX-License-Identifier: GPL-3.0-or-later
// How growth begins: seedlings, or a tree that is already there.
#pragma once

#include "core/tree.h"
#include "forward/igm/stand.h"

#include <optional>

namespace dendrofit::igm {

constexpr int kSeedlingInternodes = 4;  // the authors' program

/// A seedling: so many internodes straight up, born in `cycle`.
void plant_seedling(Stand& stand, int tree, const Vec3& root, int cycle);

/// A grown or scanned tree, each stem a plant. Axes are divided into internodes of about rho along their own
/// course (left as they are where they have that length already); radii are kept as the least they may have.
/// Birth cycles that are not known follow from the growth equation and the number of internodes down to the
/// foot. `frame_shift` is added to the tree's positions. Returns the cycle the tree is at.
int plant_tree(Stand& stand, int tree, const Tree& grown, const Vec3& frame_shift, std::optional<int> cycle);

}  // namespace dendrofit::igm
