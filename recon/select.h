// SPDX-License-Identifier: GPL-3.0-or-later
// Medians and other order statistics of short lists, many times over.
#pragma once

#include <algorithm>
#include <cstddef>
#include <span>

namespace dendrofit {

/// The value that would stand at place `k` (< values.size(), which holds no NaN) if the values were sorted;
/// their order is lost. Quickselect (Hoare 1961) that moves values without branching on them: whether a value
/// lies below the pivot is a coin toss, which a processor guesses wrongly half the time.
inline double kth_smallest(std::span<double> values, std::size_t k) {
  constexpr std::size_t kFew = 8;
  double* low = values.data();
  std::size_t n = values.size();
  while (n > kFew) {
    const double a = low[0], b = low[n / 2], c = low[n - 1];
    const double pivot = std::max(std::min(a, b), std::min(std::max(a, b), c));
    std::size_t below = 0;
    for (std::size_t i = 0; i < n; ++i) {
      const double value = low[i];
      low[i] = low[below];
      low[below] = value;
      below += value < pivot;
    }
    if (k < below) {
      n = below;
      continue;
    }
    // The pivots themselves, one at least.
    std::size_t to = below;
    for (std::size_t i = below; i < n; ++i) {
      const double value = low[i];
      low[i] = low[to];
      low[to] = value;
      to += value == pivot;
    }
    if (k < to) return pivot;
    low += to;
    n -= to;
    k -= to;
  }
  std::sort(low, low + n);
  return low[k];
}

}  // namespace dendrofit
