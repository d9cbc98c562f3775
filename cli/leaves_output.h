// SPDX-License-Identifier: GPL-3.0-or-later
// leaves.json: what was asked of the leaves and what came of it.
#pragma once

#include "forward/leaves/insert_leaves.h"

#include <string>

namespace dendrofit::cli {

/// The report as a JSON object (two spaces a level). Areas one-sided, in square metres; heights above the
/// foot. `crs`: the coordinate system of the leaves' positions, under that key (empty: no such key).
std::string leaves_json(const LeafResult& result, const std::string& crs = {});

}  // namespace dendrofit::cli
