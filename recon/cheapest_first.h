// SPDX-License-Identifier: GPL-3.0-or-later
// The queue of Dijkstra's algorithm.
#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

namespace dendrofit {

/// Points by rising cost, and at equal cost by rising index. Costs are not negative, and none is pushed that
/// is below the last one popped. Those to come lie unsorted in buckets of a `step` of cost each (Dial 1969),
/// so that only the few of the nearest bucket are kept in order: choose a step below what most pushes add.
class CheapestFirst {
 public:
  explicit CheapestFirst(double step) : per_step_(1 / step), later_(kBuckets) {}

  void push(float cost, std::uint32_t point) {
    // The bits of a float that is not negative rise with it.
    put(Entry{std::bit_cast<std::uint32_t>(cost)} << 32 | point);
  }

  bool empty() const { return now_.empty() && waiting_ == 0 && far_.empty(); }

  /// Takes the first point out. Not of an empty queue.
  std::uint32_t pop() {
    while (now_.empty()) advance();
    std::pop_heap(now_.begin(), now_.end(), std::greater<>());
    const auto point = static_cast<std::uint32_t>(now_.back());
    now_.pop_back();
    return point;
  }

 private:
  using Entry = std::uint64_t;                     // a cost's bits, then the point
  static constexpr std::uint64_t kBuckets = 4096;  // beyond them entries wait in one heap of all sorts

  std::uint64_t bucket_of(Entry entry) const {
    constexpr double kLast = 1e18;
    return static_cast<std::uint64_t>(
        std::min(kLast, std::bit_cast<float>(static_cast<std::uint32_t>(entry >> 32)) * per_step_));
  }

  void put(Entry entry) {
    const std::uint64_t bucket = bucket_of(entry);
    if (bucket <= bucket_) {
      now_.push_back(entry);
      std::push_heap(now_.begin(), now_.end(), std::greater<>());
    } else if (bucket < bucket_ + kBuckets) {
      later_[bucket % kBuckets].push_back(entry);
      ++waiting_;
    } else {
      far_.push_back(entry);
    }
  }

  /// Goes on to the next bucket, or to the next that holds something where all within reach are empty.
  void advance() {
    if (waiting_ > 0)
      ++bucket_;
    else
      bucket_ = bucket_of(*std::min_element(far_.begin(), far_.end()));
    if (waiting_ == 0 || bucket_ % (kBuckets / 2) == 0) {
      std::vector<Entry> far;
      far.swap(far_);
      for (const Entry entry : far) put(entry);
    }
    std::vector<Entry>& next = later_[bucket_ % kBuckets];
    waiting_ -= next.size();
    now_.insert(now_.end(), next.begin(), next.end());
    next.clear();
    std::make_heap(now_.begin(), now_.end(), std::greater<>());
  }

  double per_step_;
  std::uint64_t bucket_ = 0;
  std::vector<Entry> now_;  // a heap
  std::vector<std::vector<Entry>> later_;
  std::size_t waiting_ = 0;  // in all of `later_`
  std::vector<Entry> far_;
};

}  // namespace dendrofit
