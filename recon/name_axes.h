// SPDX-License-Identifier: GPL-3.0-or-later
// Which of a fork's branches is the axis that goes on.
#pragma once

#include "core/tree.h"

#include <vector>

namespace dendrofit {

/// Sets `axis` and `order` anew: at each fork the thicker branch carries the axis on, as foresters count.
/// Single radii err, and levelled taper makes them equal about a fork, so the branches are compared by the
/// median of `seen_radius` (of every node, before levelling) over the length of the same stretch, two to
/// eight of the bearer's radii beyond the crotch. Among equals the straighter one goes on, or the one with
/// more wood beyond it, which by the pipe relation tells thickness once more.
void name_axes(Tree& tree, const std::vector<double>& seen_radius);

}  // namespace dendrofit
