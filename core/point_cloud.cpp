// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/point_cloud.h"

#include "core/errors.h"

#include <string>

namespace dendrofit {

PointCloud PointCloud::subset(const std::vector<char>& keep) const {
  PointCloud part;
  part.origin_shift = origin_shift;
  part.crs_wkt = crs_wkt;
  part.scanner_positions = scanner_positions;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!keep[i]) continue;
    part.points.push_back(points[i]);
    if (!intensity.empty()) part.intensity.push_back(intensity[i]);
    if (!classification.empty()) part.classification.push_back(classification[i]);
  }
  return part;
}

void PointCloud::validate() const {
  if (!intensity.empty() && intensity.size() != points.size())
    throw InputError("point cloud: intensity has " + std::to_string(intensity.size()) + " values for " +
                     std::to_string(points.size()) + " points");
  if (!classification.empty() && classification.size() != points.size())
    throw InputError("point cloud: classification has " + std::to_string(classification.size()) +
                     " values for " + std::to_string(points.size()) + " points");
  for (std::size_t i = 0; i < points.size(); ++i)
    if (!points[i].allFinite())
      throw InputError("point " + std::to_string(i + 1) + ": a coordinate is not a finite number");
}

Bounds bounds_of(const std::vector<Vec3>& points) {
  Bounds bounds;
  for (const Vec3& point : points) bounds.add(point);
  return bounds;
}

}  // namespace dendrofit
