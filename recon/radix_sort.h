// SPDX-License-Identifier: GPL-3.0-or-later
// Linear-time stable sort of 64-bit keys with an index.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

namespace dendrofit {

struct KeyedIndex {
  std::uint64_t key = 0;
  std::uint32_t index = 0;
};

/// Rising keys, equal keys in their former order (least significant digit first, 11 bits a pass, constant
/// digits skipped).
inline void radix_sort(std::vector<KeyedIndex>& items) {
  constexpr int kBits = 11;
  constexpr std::size_t kBuckets = std::size_t{1} << kBits;
  std::vector<KeyedIndex> other(items.size());
  for (int shift = 0; shift < 64; shift += kBits) {
    std::array<std::size_t, kBuckets> first{};
    for (const KeyedIndex& item : items) ++first[(item.key >> shift) & (kBuckets - 1)];
    std::size_t sum = 0;
    bool constant = false;
    for (std::size_t& f : first) {
      constant = constant || f == items.size();
      const std::size_t count = f;
      f = sum;
      sum += count;
    }
    if (constant) continue;
    for (const KeyedIndex& item : items) other[first[(item.key >> shift) & (kBuckets - 1)]++] = item;
    items.swap(other);
  }
}

}  // namespace dendrofit
