// SPDX-License-Identifier: GPL-3.0-or-later
// Who gets what (Yi 2018, 4.1-4.3): light is collected from tips to bases, shared out from bases to tips by
// Borchert-Honda, re-weighted by priority within each axis, and turned into shoots under the growth
// equation's cap.
#pragma once

#include "forward/igm/stand.h"

#include <cstdint>
#include <vector>

namespace dendrofit::igm {

/// A node that sprouts in this cycle.
struct Sprout {
  std::int32_t node = -1;
  int shoots = 1;      ///< at a tip the first continues the axis, the others branch off
  int internodes = 0;  ///< of each shoot, at most
  double share = 0;    ///< resource of each shoot
};

struct Decision {
  std::vector<Sprout> sprouts;  ///< in the order of the nodes of each axis
  bool held_by_cap = false;     ///< some node had resource, but the growth equation allows no internode
};

/// The nodes that sprout in cycle T, of all trees. Needs index_axes() and current shade.
Decision decide(const Stand& stand, int cycle);

}  // namespace dendrofit::igm
