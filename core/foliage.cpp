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

}  // namespace

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
  const Leaf& leaf = leaves[i];
  const LeafShape& shape = shapes[leaf.shape];
  const Vec3 across = leaf.direction.cross(leaf.normal);
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  for (const Vec3& v : shape.vertices) {
    const Vec3 exact =
        leaf.origin + leaf.length_m * (v.x() * across + v.y() * leaf.direction + v.z() * leaf.normal);
    mesh.vertices.emplace_back(std::round(exact.x() * kGrid) / kGrid, std::round(exact.y() * kGrid) / kGrid,
                               std::round(exact.z() * kGrid) / kGrid);
  }
  for (const auto& t : shape.triangles) mesh.triangles.push_back({first + t[0], first + t[1], first + t[2]});
}

}  // namespace dendrofit
