// SPDX-License-Identifier: GPL-3.0-or-later
// One row of growth.csv a tree and cycle.
#pragma once

#include "forward/igm/grow.h"
#include "forward/igm/stand.h"

#include <cstdint>
#include <vector>

namespace dendrofit::igm {

/// Measures every tree of the stand and appends its record.
void record(const Stand& stand, int cycle, const std::vector<std::int64_t>& shed,
            std::vector<GrowthRecord>& series);

}  // namespace dendrofit::igm
