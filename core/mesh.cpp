// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/mesh.h"

#include "core/errors.h"
#include "core/tree_topology.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <string>
#include <utility>

#include <Eigen/Geometry>

namespace dendrofit {
namespace {

struct Ring {
  Vec3 centre;
  Vec3 tangent;
  double radius;
};

std::vector<Ring> rings_of(const Tree& tree, const Axis& axis) {
  std::vector<Ring> rings;
  const auto at = [&](std::size_t k) { return static_cast<std::size_t>(axis.nodes[k]); };
  const std::size_t n = axis.nodes.size();
  rings.push_back({tree.start[at(0)], tree.direction(at(0)), tree.radius[at(0)]});
  for (std::size_t k = 0; k < n; ++k) {
    Vec3 tangent = tree.direction(at(k));
    double radius = tree.radius[at(k)];
    if (k + 1 < n) {
      const Vec3 sum = tangent + tree.direction(at(k + 1));
      if (sum.norm() > 1e-6) tangent = sum.normalized();
      radius = 0.5 * (radius + tree.radius[at(k + 1)]);
    }
    rings.push_back({tree.end[at(k)], tangent, radius});
  }
  return rings;
}

void add_tube(const std::vector<Ring>& rings, int sides, TriangleMesh& mesh) {
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  const auto m = static_cast<std::uint32_t>(sides);
  Vec3 side = rings.front().tangent.unitOrthogonal();
  for (const Ring& ring : rings) {
    // Carry the frame along with the least rotation, so that the tube does not twist.
    Vec3 across = side - ring.tangent * ring.tangent.dot(side);
    side = across.norm() > 1e-9 ? Vec3(across.normalized()) : Vec3(ring.tangent.unitOrthogonal());
    const Vec3 other = ring.tangent.cross(side);
    for (std::uint32_t k = 0; k < m; ++k) {
      const double angle = 2 * std::numbers::pi * k / m;
      mesh.vertices.push_back(ring.centre + ring.radius * (std::cos(angle) * side + std::sin(angle) * other));
    }
  }
  const auto count = static_cast<std::uint32_t>(rings.size());
  for (std::uint32_t r = 0; r + 1 < count; ++r) {
    for (std::uint32_t k = 0; k < m; ++k) {
      const std::uint32_t a = first + r * m + k;
      const std::uint32_t b = first + r * m + (k + 1) % m;
      mesh.triangles.push_back({a, b, b + m});
      mesh.triangles.push_back({a, b + m, a + m});
    }
  }
  const std::uint32_t top = first + (count - 1) * m;
  for (std::uint32_t k = 1; k + 1 < m; ++k) {
    mesh.triangles.push_back({first, first + k + 1, first + k});
    mesh.triangles.push_back({top, top + k, top + k + 1});
  }
}

}  // namespace

void TriangleMesh::append(const TriangleMesh& other) {
  if (origin_shift != other.origin_shift)
    throw InputError("meshes to be joined have different origin shifts");
  const auto offset = static_cast<std::uint32_t>(vertices.size());
  vertices.insert(vertices.end(), other.vertices.begin(), other.vertices.end());
  for (const auto& t : other.triangles) triangles.push_back({t[0] + offset, t[1] + offset, t[2] + offset});
}

void TriangleMesh::validate() const {
  for (std::size_t i = 0; i < vertices.size(); ++i)
    if (!vertices[i].allFinite())
      throw InputError("mesh vertex " + std::to_string(i + 1) + ": a coordinate is not a finite number");
  for (std::size_t i = 0; i < triangles.size(); ++i)
    for (const std::uint32_t v : triangles[i])
      if (v >= vertices.size())
        throw InputError("mesh triangle " + std::to_string(i + 1) + ": vertex " + std::to_string(v + 1) +
                         " of " + std::to_string(vertices.size()));
}

void TreeMeshOptions::validate() const {
  require(min_sides >= 3, "min_sides", min_sides, "at least 3");
  require(max_sides >= min_sides, "max_sides", max_sides, "at least min_sides");
}

bool is_closed(const TriangleMesh& mesh) {
  if (mesh.triangles.empty()) return false;
  std::map<std::array<double, 3>, std::uint32_t> places;
  std::vector<std::uint32_t> place;  // of each vertex
  for (const Vec3& v : mesh.vertices)
    place.push_back(places.emplace(std::array{v.x(), v.y(), v.z()}, static_cast<std::uint32_t>(places.size()))
                        .first->second);
  std::vector<std::pair<std::uint32_t, std::uint32_t>> edges;
  for (const auto& triangle : mesh.triangles)
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = place[triangle[k]], b = place[triangle[(k + 1) % 3]];
      if (a != b) edges.push_back(std::minmax(a, b));
    }
  std::sort(edges.begin(), edges.end());
  for (std::size_t first = 0, last = 0; first < edges.size(); first = last) {
    while (last < edges.size() && edges[last] == edges[first]) ++last;
    if ((last - first) % 2 != 0) return false;
  }
  return true;
}

TriangleMesh tree_mesh(const Tree& tree, const TreeMeshOptions& options) {
  options.validate();
  TriangleMesh mesh;
  mesh.origin_shift = tree.origin_shift;
  for (const Axis& axis : axes_of(tree)) {
    if (axis.nodes.empty()) continue;
    const double radius = tree.radius[static_cast<std::size_t>(axis.nodes.front())];
    const int sides = std::clamp(static_cast<int>(std::lround(4 + 2.5 * std::log2(1 + radius / 0.005))),
                                 options.min_sides, options.max_sides);
    add_tube(rings_of(tree, axis), sides, mesh);
  }
  return mesh;
}

}  // namespace dendrofit
