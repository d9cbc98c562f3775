// SPDX-License-Identifier: GPL-3.0-or-later
// A point cloud as a value: double coordinates about a stored shift, with intensity and class where the file
// had them.
#pragma once

#include "core/types.h"

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace dendrofit {

/// Invariants: intensity and classification are empty or as long as points; every coordinate is finite.
struct PointCloud {
  /// World position = origin_shift + local position (metres). Readers choose it near the first point, so that
  /// local coordinates stay small and georeferenced ones lose nothing.
  Vec3 origin_shift = Vec3::Zero();
  std::vector<Vec3> points;                  ///< local, metres
  std::vector<float> intensity;              ///< as in the file, no unit
  std::vector<std::uint8_t> classification;  ///< ASPRS codes where the file is LAS
  std::vector<Vec3> scanner_positions;       ///< where the file states them; local, metres
  std::string crs_wkt;                       ///< coordinate system as the file states it, else empty

  std::size_t size() const { return points.size(); }
  bool empty() const { return points.empty(); }
  /// Points where keep[i] != 0, attributes with them. `keep` has size() entries.
  PointCloud subset(const std::vector<char>& keep) const;
  /// Throws InputError at the first broken invariant.
  void validate() const;
};

/// Axis-aligned box; empty() while lo > hi.
struct Bounds {
  Vec3 lo = Vec3::Constant(1e300);
  Vec3 hi = Vec3::Constant(-1e300);
  void add(const Vec3& point) {
    lo = lo.cwiseMin(point);
    hi = hi.cwiseMax(point);
  }
  bool empty() const { return lo.x() > hi.x(); }
  Vec3 size() const { return hi - lo; }
};

Bounds bounds_of(const std::vector<Vec3>& points);

}  // namespace dendrofit
