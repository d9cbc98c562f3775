// SPDX-License-Identifier: GPL-3.0-or-later
// Convex hulls, for crown measures.
#pragma once

#include "core/types.h"

#include <vector>

namespace dendrofit {

/// Plan-view hull of points' (x, y).
struct PlanHull {
  double area_m2 = 0;
  double perimeter_m = 0;
};

/// Area and perimeter of the hull of the points' horizontal positions; zeros for fewer than three distinct
/// points.
PlanHull plan_hull(const std::vector<Vec3>& points);

/// Volume (cubic metres) of the 3-D hull; 0 for fewer than four points or points in one plane.
/// Coordinates count to the micrometre; the extent must stay below 1,000 km.
double hull_volume(const std::vector<Vec3>& points);

}  // namespace dendrofit
