// SPDX-License-Identifier: GPL-3.0-or-later
// Counter-based random numbers. A draw depends on the seed and the keys alone, never on which thread asks
// first, so the same seed gives the same bytes whatever the number of threads.
#pragma once

#include "core/types.h"

#include <cstdint>
#include <initializer_list>

namespace dendrofit {

/// A stream of draws identified by a seed and a path of keys. Cheap to make and to copy.
///
///     Random tree = Random(seed).child({tree_id});
///     double u = tree.child({cycle, node}).uniform();   // same value wherever and whenever it is asked for
///
/// Draw k of a stream is the SplitMix64 finaliser (Steele, Lea & Flood 2014) of key + k * golden ratio: a
/// bijection of the counter, of period 2^64.
class Random {
  __extension__ using Wide = unsigned __int128;

 public:
  explicit Random(std::uint64_t seed) : key_(mix(seed ^ 0x5851f42d4c957f2dULL)) {}

  /// The stream under these keys; independent of how far this one has been drawn from.
  Random child(std::initializer_list<std::uint64_t> keys) const {
    Random stream = *this;
    stream.counter_ = 0;
    for (std::uint64_t key : keys) stream.key_ = mix(stream.key_ + 0x9e3779b97f4a7c15ULL * (key + 1));
    return stream;
  }

  std::uint64_t bits() { return mix(key_ + 0x9e3779b97f4a7c15ULL * ++counter_); }
  /// In [0, 1).
  double uniform() { return static_cast<double>(bits() >> 11) * 0x1.0p-53; }
  double uniform(double lo, double hi) { return lo + (hi - lo) * uniform(); }
  /// In {0, ..., n-1}; n > 0.
  std::uint64_t below(std::uint64_t n) {
    return static_cast<std::uint64_t>((static_cast<Wide>(bits()) * n) >> 64);
  }
  /// Standard normal (Box-Muller, two draws).
  double normal();
  /// Uniform on the unit sphere.
  Vec3 direction();

 private:
  static std::uint64_t mix(std::uint64_t z) {
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ULL;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebULL;
    return z ^ (z >> 31);
  }
  std::uint64_t key_;
  std::uint64_t counter_ = 0;
};

}  // namespace dendrofit
