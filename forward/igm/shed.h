// SPDX-License-Identifier: GPL-3.0-or-later
// Branches that get too little light fall (Yi 2018, 4.6, after Takenaka 1994).
#pragma once

#include "forward/igm/stand.h"

#include <cstdint>
#include <vector>

namespace dendrofit::igm {

/// Which axes fall: in each of `passes`, those that bear no laterals (any more) and whose internodes have a
/// mean light under the tree's shed_ratio. Trunks stay. `shed` counts the internodes by tree. Needs
/// index_axes(); takes the fallen off the lateral counts of their bearers.
std::vector<char> shed_axes(Stand& stand, int passes, std::vector<std::int64_t>& shed);

}  // namespace dendrofit::igm
