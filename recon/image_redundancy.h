// SPDX-License-Identifier: GPL-3.0-or-later
// Wood that the pictures would not miss.
#pragma once

#include "core/photograph.h"
#include "core/tree.h"

#include <vector>

namespace dendrofit {

/// Where silhouettes leave space open beside or between branches, a skeleton may run there: it projects on
/// wood in every view, but on wood that other axes explain. From the shortest axis up, an axis (with what it
/// bears gone already) is dropped unless in two views or more no other axis covers at least a third of its
/// middle line: 1 for nodes to keep. Cylinders in the frame of the cameras' world; axes that hold a root
/// stay.
std::vector<char> needed_by_views(const Tree& tree, const std::vector<Camera>& cameras, int threads = 0);

}  // namespace dendrofit
