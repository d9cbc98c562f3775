// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/convex_hull.h"

#include <array>
#include <cmath>
#include <iterator>

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/convex_hull_2.h>
#include <CGAL/convex_hull_3.h>
#include <Eigen/Geometry>

namespace dendrofit {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
__extension__ using Wide = __int128;
constexpr double kPerMetre = 1e6;

}  // namespace

PlanHull plan_hull(const std::vector<Vec3>& points) {
  std::vector<Kernel::Point_2> plan;
  plan.reserve(points.size());
  for (const Vec3& p : points) plan.emplace_back(p.x(), p.y());
  std::vector<Kernel::Point_2> hull;
  CGAL::convex_hull_2(plan.begin(), plan.end(), std::back_inserter(hull));
  PlanHull result;
  if (hull.size() < 3) return result;
  for (std::size_t i = 0; i < hull.size(); ++i) {
    const auto& a = hull[i];
    const auto& b = hull[(i + 1) % hull.size()];
    result.area_m2 +=
        0.5 * ((a.x() - hull[0].x()) * (b.y() - hull[0].y()) - (b.x() - hull[0].x()) * (a.y() - hull[0].y()));
    result.perimeter_m += std::hypot(b.x() - a.x(), b.y() - a.y());
  }
  return result;
}

double hull_volume(const std::vector<Vec3>& points) {
  if (points.size() < 4) return 0;
  // In whole micrometres and summed exactly: the order in which the hull lists its faces follows addresses in
  // memory, and must not show in the result.
  std::vector<Kernel::Point_3> space;
  space.reserve(points.size());
  for (const Vec3& p : points) {
    const Vec3 about = ((p - points.front()) * kPerMetre).array().round();
    space.emplace_back(about.x(), about.y(), about.z());
  }
  CGAL::Surface_mesh<Kernel::Point_3> hull;
  CGAL::convex_hull_3(space.begin(), space.end(), hull);
  using Exact = std::array<Wide, 3>;
  const auto exact = [](const Kernel::Point_3& p) {
    return Exact{static_cast<Wide>(p.x()), static_cast<Wide>(p.y()), static_cast<Wide>(p.z())};
  };
  Wide six_volumes = 0;
  for (const auto face : hull.faces()) {
    const auto h = hull.halfedge(face);
    const Exact a = exact(hull.point(hull.source(h)));
    const Exact b = exact(hull.point(hull.target(h)));
    const Exact c = exact(hull.point(hull.target(hull.next(h))));
    six_volumes += a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) +
                   a[2] * (b[0] * c[1] - b[1] * c[0]);
  }
  return std::abs(static_cast<double>(six_volumes)) / (6 * kPerMetre * kPerMetre * kPerMetre);
}

}  // namespace dendrofit
