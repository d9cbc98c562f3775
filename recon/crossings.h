// SPDX-License-Identifier: GPL-3.0-or-later
// Branches that touch: where the paths left one branch for another that crosses it.
#pragma once

#include "recon/graph.h"
#include "recon/sections.h"

#include <vector>

namespace dendrofit {

/// A branch that ends where wood goes on straight ahead, reached across another branch that touches it there,
/// has lost its outer part to that other: the paths along both met in the middle. One gate for each such
/// place: the wood about the contact is to be entered from the branch's end.
std::vector<Gate> gates_at_crossings(const std::vector<Section>& sections, double spacing_m);

}  // namespace dendrofit
