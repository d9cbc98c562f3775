// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/foliage.h"

#include "core/errors.h"

#include <cmath>
#include <string>

#include <Eigen/Geometry>

namespace dendrofit {
namespace {

constexpr double kGrid = 1e6;  // blade vertices lie on whole micrometres

double area_of(const LeafShape& shape, const std::array<std::uint32_t, 3>& t) {
  const Vec3 a = shape.vertices[t[1]] - shape.vertices[t[0]];
  const Vec3 b = shape.vertices[t[2]] - shape.vertices[t[0]];
  return 0.5 * a.cross(b).norm();
}

/// The nearest multiple of 1 / kGrid: adding 1.5 * 2^52 leaves no bits for a fraction (|x| < 2e9 m).
double on_grid(double x) {
  constexpr double kNoFraction = 6755399441055744.0;
  return ((x * kGrid + kNoFraction) - kNoFraction) / kGrid;
}

Vec3 on_grid(const Vec3& exact) {
  return {on_grid(exact.x()), on_grid(exact.y()), on_grid(exact.z())};
}

}  // namespace

void blade_vertices(const Leaf& leaf, const LeafShape& shape, std::vector<Vec3>& out) {
  const Vec3 across = leaf.direction.cross(leaf.normal);
  out.clear();
  for (const Vec3& v : shape.vertices)
    out.push_back(on_grid(leaf.origin +
                          leaf.length_m * (v.x() * across + v.y() * leaf.direction + v.z() * leaf.normal)));
}

bool petiole_corners(const Leaf& leaf, const LeafShape& shape, std::array<Vec3, 4>& out) {
  const Vec3 along = leaf.origin - leaf.petiole_foot;
  if (!(along.squaredNorm() > 1e-10) || !(shape.petiole_width > 0)) return false;
  Vec3 across = along.cross(leaf.normal);
  if (across.squaredNorm() < 1e-6 * along.squaredNorm()) across = along.cross(leaf.direction);
  const Vec3 half = (0.5 * shape.petiole_width * leaf.length_m) * across.normalized();
  out = {on_grid(leaf.petiole_foot - half), on_grid(leaf.petiole_foot + half), on_grid(leaf.origin + half),
         on_grid(leaf.origin - half)};
  return true;
}

double LeafShape::unit_area() const {
  double area = 0;
  for (const auto& t : triangles) area += area_of(*this, t);
  return area;
}

void LeafShape::validate() const {
  if (triangles.empty()) throw InputError("leaf shape '" + name + "': it has no triangle");
  for (std::size_t i = 0; i < vertices.size(); ++i)
    if (!vertices[i].allFinite())
      throw InputError("leaf shape '" + name + "', vertex " + std::to_string(i + 1) +
                       ": a coordinate is not a finite number");
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    for (const std::uint32_t v : triangles[i])
      if (v >= vertices.size())
        throw InputError("leaf shape '" + name + "', triangle " + std::to_string(i + 1) + ": no such vertex");
    if (area_of(*this, triangles[i]) < 1e-9)
      throw InputError("leaf shape '" + name + "', triangle " + std::to_string(i + 1) + ": its area is zero");
  }
}

double Foliage::leaf_area(std::size_t i) const {
  const Leaf& leaf = leaves[i];
  return leaf.length_m * leaf.length_m * shapes[leaf.shape].unit_area();
}

double Foliage::total_area() const {
  std::vector<double> unit;
  for (const LeafShape& shape : shapes) unit.push_back(shape.unit_area());
  double total = 0;
  for (const Leaf& leaf : leaves) total += leaf.length_m * leaf.length_m * unit[leaf.shape];
  return total;
}

void Foliage::append_blade(std::size_t i, TriangleMesh& mesh) const {
  const LeafShape& shape = shapes[leaves[i].shape];
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  std::vector<Vec3> vertices;
  blade_vertices(leaves[i], shape, vertices);
  mesh.vertices.insert(mesh.vertices.end(), vertices.begin(), vertices.end());
  for (const auto& t : shape.triangles) mesh.triangles.push_back({first + t[0], first + t[1], first + t[2]});
}

void Foliage::append_petiole(std::size_t i, TriangleMesh& mesh) const {
  std::array<Vec3, 4> corners;
  if (!petiole_corners(leaves[i], shapes[leaves[i].shape], corners)) return;
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  mesh.vertices.insert(mesh.vertices.end(), corners.begin(), corners.end());
  mesh.triangles.push_back({first, first + 1, first + 2});
  mesh.triangles.push_back({first, first + 2, first + 3});
}

}  // namespace dendrofit
