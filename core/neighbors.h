// SPDX-License-Identifier: GPL-3.0-or-later
// Nearest neighbours among points (k-d tree).
#pragma once

#include "core/types.h"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

namespace dendrofit {

struct Neighbor {
  std::uint32_t index = 0;
  double distance_squared = 0;  ///< metres squared
};

/// A k-d tree over a copy of the points' coordinates in single precision: give it local (shifted)
/// coordinates. Queries are const and safe from several threads; equal distances are returned in rising
/// index.
class Neighbors {
 public:
  explicit Neighbors(const std::vector<Vec3>& points);
  ~Neighbors();
  Neighbors(Neighbors&&) noexcept;
  Neighbors& operator=(Neighbors&&) noexcept;

  std::size_t size() const;
  /// The k nearest points, nearest first (fewer where there are fewer points). Replaces `out`.
  void nearest(const Vec3& query, std::size_t k, std::vector<Neighbor>& out) const;
  /// The nearest of the points within `radius` metres for which `wanted(index)` holds.
  std::optional<Neighbor> nearest_where(const Vec3& query, double radius,
                                        const std::function<bool(std::uint32_t)>& wanted) const;
  /// All points within `radius` metres, nearest first. Replaces `out`.
  void within(const Vec3& query, double radius, std::vector<Neighbor>& out) const;

 private:
  struct Index;
  std::unique_ptr<Index> index_;
};

}  // namespace dendrofit
