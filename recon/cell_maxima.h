// SPDX-License-Identifier: GPL-3.0-or-later
// The largest value noted near a place, found in constant time.
#pragma once

#include "core/types.h"

#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

namespace dendrofit {

/// A sparse grid of cells `side` metres wide that keeps the largest of the values put into each.
class CellMaxima {
 public:
  explicit CellMaxima(double side) : side_(side), slots_(1024) {}

  void raise(const Vec3& place, float value) {
    Slot& slot = slots_[find(cell(place))];
    if (!slot.used) {
      slot = {cell(place), value, true};
      if (2 * ++count_ > slots_.size()) grow();
    } else if (value > slot.value) {
      slot.value = value;
    }
  }

  /// The largest value in the place's cell and the 26 about it; 0 where there is none.
  float about(const Vec3& place) const {
    const Cell middle = cell(place);
    float most = 0;
    for (int x = -1; x <= 1; ++x)
      for (int y = -1; y <= 1; ++y)
        for (int z = -1; z <= 1; ++z) {
          const Slot& slot = slots_[find({middle[0] + x, middle[1] + y, middle[2] + z})];
          if (slot.used && slot.value > most) most = slot.value;
        }
    return most;
  }

 private:
  using Cell = std::array<std::int32_t, 3>;
  struct Slot {
    Cell at{};
    float value = 0;
    bool used = false;
  };

  Cell cell(const Vec3& p) const {
    const auto index = [&](double x) { return static_cast<std::int32_t>(std::floor(x / side_)); };
    return {index(p.x()), index(p.y()), index(p.z())};
  }

  /// The cell's slot, or the free one where it would go.
  std::size_t find(const Cell& at) const {
    std::uint64_t h = 0;
    for (const std::int32_t k : at) h = (h ^ static_cast<std::uint32_t>(k)) * 0x9e3779b97f4a7c15ULL;
    std::size_t i = static_cast<std::size_t>(h ^ (h >> 29)) & (slots_.size() - 1);
    while (slots_[i].used && slots_[i].at != at) i = (i + 1) & (slots_.size() - 1);
    return i;
  }

  void grow() {
    std::vector<Slot> old(2 * slots_.size());
    old.swap(slots_);
    for (const Slot& slot : old)
      if (slot.used) slots_[find(slot.at)] = slot;
  }

  double side_;
  std::vector<Slot> slots_;  // a power of two of them, at most half used
  std::size_t count_ = 0;
};

}  // namespace dendrofit
