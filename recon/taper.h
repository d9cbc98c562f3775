// SPDX-License-Identifier: GPL-3.0-or-later
// Taper as a constraint over a whole tree: wood never gets thicker towards the tips.
#pragma once

#include <cstdint>
#include <vector>

namespace dendrofit {

/// Isotonic regression on a rooted forest: the values nearest to `value` in weighted squares such that no
/// node exceeds its parent. parent[i] < i, or -1. Violating blocks are pooled from the tips down (Pardalos &
/// Xue 1999), O(n log^2 n). Throws InputError for columns of unequal length, a parent that does not come
/// before its child or a weight <= 0.
std::vector<double> falling_towards_tips(const std::vector<double>& value, const std::vector<double>& weight,
                                         const std::vector<std::int32_t>& parent);

}  // namespace dendrofit
