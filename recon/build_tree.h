// SPDX-License-Identifier: GPL-3.0-or-later
// Limbs with radii become the one tree type.
#pragma once

#include "core/tree.h"
#include "recon/foot.h"
#include "recon/skeleton.h"

#include <vector>

namespace dendrofit {

/// Cylinders a few radii long (8 to 15 cm, 4 where they bend); a branch starts where its centre line leaves
/// its bearer's surface, and at each fork the thicker limb carries the axis on (name_axes.h). Stems start at
/// their foot.
Tree build_tree(const std::vector<Limb>& limbs, const std::vector<Foot>& feet, const Vec3& origin_shift);

}  // namespace dendrofit
