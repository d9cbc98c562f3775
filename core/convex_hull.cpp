// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/convex_hull.h"

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
  std::vector<Kernel::Point_3> space;
  space.reserve(points.size());
  for (const Vec3& p : points) space.emplace_back(p.x(), p.y(), p.z());
  if (space.size() < 4) return 0;
  CGAL::Surface_mesh<Kernel::Point_3> hull;
  CGAL::convex_hull_3(space.begin(), space.end(), hull);
  if (hull.number_of_faces() == 0) return 0;
  const auto vec = [](const Kernel::Point_3& p) { return Vec3(p.x(), p.y(), p.z()); };
  const Vec3 apex = vec(hull.point(*hull.vertices().begin()));
  double six_volumes = 0;
  for (const auto face : hull.faces()) {
    auto h = hull.halfedge(face);
    const Vec3 a = vec(hull.point(hull.source(h))) - apex;
    const Vec3 b = vec(hull.point(hull.target(h))) - apex;
    const Vec3 c = vec(hull.point(hull.target(hull.next(h)))) - apex;
    six_volumes += a.dot(b.cross(c));
  }
  return std::abs(six_volumes) / 6;
}

}  // namespace dendrofit
