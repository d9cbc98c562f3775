// SPDX-License-Identifier: GPL-3.0-or-later
// leaves.json: what was asked of the leaves and what came of it.
#pragma once

#include <string>

#include "forward/leaves/insert_leaves.h"

namespace dendrofit::cli {

/// The content of leaves.json. The only value that differs between equal runs is `seconds`.
std::string leaves_json(const LeafResult& result);

}  // namespace dendrofit::cli
