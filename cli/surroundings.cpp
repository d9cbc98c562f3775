// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/surroundings.h"

#include <algorithm>

#include <Eigen/Geometry>

namespace dendrofit::cli {
namespace {

void add_quad(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d, TriangleMesh& mesh) {
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  mesh.vertices.insert(mesh.vertices.end(), {a, b, c, d});
  mesh.triangles.push_back({first, first + 1, first + 2});
  mesh.triangles.push_back({first, first + 2, first + 3});
}

void add_box(const Vec3& lo, const Vec3& hi, TriangleMesh& mesh) {
  const auto at = [&](int x, int y, int z) {
    return Vec3(x ? hi.x() : lo.x(), y ? hi.y() : lo.y(), z ? hi.z() : lo.z());
  };
  add_quad(at(0, 0, 0), at(0, 1, 0), at(1, 1, 0), at(1, 0, 0), mesh);
  add_quad(at(0, 0, 1), at(1, 0, 1), at(1, 1, 1), at(0, 1, 1), mesh);
  add_quad(at(0, 0, 0), at(1, 0, 0), at(1, 0, 1), at(0, 0, 1), mesh);
  add_quad(at(0, 1, 0), at(0, 1, 1), at(1, 1, 1), at(1, 1, 0), mesh);
  add_quad(at(0, 0, 0), at(0, 0, 1), at(0, 1, 1), at(0, 1, 0), mesh);
  add_quad(at(1, 0, 0), at(1, 1, 0), at(1, 1, 1), at(1, 0, 1), mesh);
}

}  // namespace

TriangleMesh surroundings_of(const IgmSite& site, const Bounds& shown) {
  TriangleMesh out;
  out.origin_shift = site.origin_shift;
  const Vec3 lo = shown.lo - site.origin_shift, hi = shown.hi - site.origin_shift;
  const double reach = 0.75 * (hi - lo).norm();
  for (const SolidBox& box : site.solids.boxes) {
    const Vec3 foot(box.min.x(), box.min.y(), std::max(box.min.z(), lo.z()));
    if (foot.z() < box.max.z()) add_box(foot, box.max, out);
  }
  for (const SolidHalfSpace& half : site.solids.half_spaces) {
    const Vec3 normal = half.normal.normalized();
    const Vec3 middle = 0.5 * (lo + hi);
    const Vec3 centre = middle - (middle - half.point).dot(normal) * normal;
    const Vec3 along =
        std::abs(normal.z()) > 0.999 ? Vec3(Vec3::UnitX()) : Vec3(Vec3::UnitZ().cross(normal).normalized());
    const Vec3 up = normal.cross(along);
    if (normal.z() > 0.999 && centre.z() <= lo.z() + 1e-6) continue;
    add_quad(centre - reach * (along + up), centre + reach * (along - up), centre + reach * (along + up),
             centre - reach * (along - up), out);
  }
  for (const TriangleMesh& mesh : site.solids.meshes) {
    TriangleMesh moved = mesh;
    for (Vec3& vertex : moved.vertices) vertex += mesh.origin_shift - out.origin_shift;
    moved.origin_shift = out.origin_shift;
    out.append(moved);
  }
  return out;
}

}  // namespace dendrofit::cli
