// SPDX-License-Identifier: GPL-3.0-or-later
// Where shoots grow (Yi 2018, 4.4): V = Vd + mu Vo + gamma Vt, step by step through the cycle's markers.
#pragma once

#include "core/progress.h"
#include "forward/environment/light_field.h"
#include "forward/environment/obstacles.h"
#include "forward/igm/allocate.h"
#include "forward/igm/stand.h"

#include <cstdint>
#include <vector>

namespace dendrofit::igm {

/// Grows the sprouts of cycle T: markers are strewn about every sprouting node of every tree, then trees in
/// random order, and within each its nodes in random order, send out their shoots. New nodes are appended to
/// the stand; `light` is only read. `profiles` are the trees' shadows in this cycle.
void grow_shoots(Stand& stand, const std::vector<Sprout>& sprouts, int cycle, LightField& light,
                 const Obstacles& obstacles, const std::vector<ShadeProfile>& profiles, std::uint64_t seed,
                 Progress& progress);

}  // namespace dendrofit::igm
