// SPDX-License-Identifier: GPL-3.0-or-later
// Trees of known parameters for the recovery bench.
#pragma once

#include "core/tree.h"
#include "forward/igm/parameters.h"

#include <cstdint>

namespace dendrofit {

struct Truth {
  int index = 0;
  IgmParameters parameters;
  std::uint64_t seed = 1;
  Tree tree;
};

/// Radius of the thinnest wood that arm b hands over, metres.
inline constexpr double kThinnestSeen = 0.004;

/// Truth number `index`: its parameters lie in the middle 80 % of every searched range, in one stratum of a
/// Latin hypercube each of two hundred; its tree is 40 to 110 internodes of 0.1 m tall (else the next draw).
Truth grow_truth(int index);

/// The tree as arm 'a' (itself), 'b' (without thinner wood than kThinnestSeen) or 'c' (virtual scan from four
/// stations, reconstructed) has it.
Tree as_seen(const Truth& truth, char arm);

}  // namespace dendrofit
