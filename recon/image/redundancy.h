// SPDX-License-Identifier: GPL-3.0-or-later
// Wood that the pictures would not miss.
#pragma once

#include "core/photograph.h"
#include "core/tree.h"

#include <vector>

namespace dendrofit {

/// Where silhouettes leave space open beside or between branches, a skeleton may run there: it projects on
/// wood in every view, but on wood that others explain. From the shortest up, an unbranched run that bears
/// nothing (any more) is dropped unless in two views or more no other run covers at least a third of its
/// middle line: 1 for nodes to keep. Cylinders in the frame of the cameras' world; roots stay.
std::vector<char> needed_by_views(const Tree& tree, const std::vector<Camera>& cameras, int threads = 0);

}  // namespace dendrofit
