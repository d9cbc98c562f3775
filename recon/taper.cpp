// SPDX-License-Identifier: GPL-3.0-or-later
#include "recon/taper.h"

#include "core/errors.h"

#include <algorithm>
#include <utility>

namespace dendrofit {

std::vector<double> falling_towards_tips(const std::vector<double>& value, const std::vector<double>& weight,
                                         const std::vector<std::int32_t>& parent) {
  const std::size_t n = value.size();
  if (weight.size() != n || parent.size() != n) throw InputError("taper: columns of unequal length");
  // A block is named after the node nearest to the root in it; its heap holds the blocks that hang on it.
  std::vector<double> sum(n), total(n);
  std::vector<std::vector<std::pair<double, std::int32_t>>> heap(n);
  std::vector<std::int32_t> owner(n);
  for (std::size_t i = 0; i < n; ++i) {
    if (parent[i] >= static_cast<std::int32_t>(i))
      throw InputError("taper: a parent must come before its child");
    if (!(weight[i] > 0)) throw InputError("taper: weights must be positive");
  }
  for (std::size_t i = n; i-- > 0;) {
    sum[i] = value[i] * weight[i];
    total[i] = weight[i];
    owner[i] = static_cast<std::int32_t>(i);
    auto& mine = heap[i];
    while (!mine.empty() && mine.front().first > sum[i] / total[i]) {
      const auto j = static_cast<std::size_t>(mine.front().second);
      std::pop_heap(mine.begin(), mine.end());
      mine.pop_back();
      sum[i] += sum[j];
      total[i] += total[j];
      owner[j] = static_cast<std::int32_t>(i);
      auto& theirs = heap[j];
      if (theirs.size() > mine.size()) mine.swap(theirs);  // move the smaller heap
      for (const auto& entry : theirs) {
        mine.push_back(entry);
        std::push_heap(mine.begin(), mine.end());
      }
      theirs.clear();
    }
    if (parent[i] >= 0) {
      auto& up = heap[static_cast<std::size_t>(parent[i])];
      up.emplace_back(sum[i] / total[i], static_cast<std::int32_t>(i));
      std::push_heap(up.begin(), up.end());
    }
  }
  std::vector<double> fitted(n);
  for (std::size_t i = 0; i < n; ++i) {
    const auto o = static_cast<std::size_t>(owner[i]);
    fitted[i] = o == i ? sum[i] / total[i] : fitted[o];  // owners come first
  }
  return fitted;
}

}  // namespace dendrofit
