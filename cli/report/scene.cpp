// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/report/scene.h"

#include "core/tree_topology.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <Eigen/Geometry>

namespace dendrofit {
namespace {

constexpr Rgb kGround = {226, 226, 214};

struct Ring {
  Vec3 centre;
  Vec3 tangent;
  double radius = 0;
};

/// Rings joined to a tube closed at both ends; segment k (between rings k and k + 1) has colours[k].
void add_tube(const std::vector<Ring>& rings, const std::vector<Rgb>& colours, Scene& scene) {
  double thickest = 0;
  for (const Ring& ring : rings) thickest = std::max(thickest, ring.radius);
  const int sides = std::clamp(static_cast<int>(std::lround(6 + 60 * thickest)), 6, 24);
  Vec3 across = rings[0].tangent.unitOrthogonal();
  std::uint32_t previous = 0;
  for (std::size_t k = 0; k < rings.size(); ++k) {
    const Ring& ring = rings[k];
    across -= across.dot(ring.tangent) * ring.tangent;
    across = across.norm() > 1e-9 ? across.normalized() : ring.tangent.unitOrthogonal();
    const Vec3 beside = ring.tangent.cross(across);
    const auto first = static_cast<std::uint32_t>(scene.vertices.size());
    for (int s = 0; s < sides; ++s) {
      const double angle = 2 * std::numbers::pi * s / sides;
      const Vec3 out = std::cos(angle) * across + std::sin(angle) * beside;
      scene.vertex(ring.centre + ring.radius * out, out);
    }
    const auto n = static_cast<std::uint32_t>(sides);
    if (k > 0)
      for (std::uint32_t s = 0; s < n; ++s) {
        const std::uint32_t t = (s + 1) % n;
        scene.triangle(previous + s, previous + t, first + t, colours[k - 1], Scene::Surface::wood);
        scene.triangle(previous + s, first + t, first + s, colours[k - 1], Scene::Surface::wood);
      }
    if (k == 0 || k + 1 == rings.size()) {
      const Vec3 outward = k == 0 ? Vec3(-ring.tangent) : ring.tangent;
      const std::uint32_t centre = scene.vertex(ring.centre, outward);
      for (std::uint32_t s = 0; s < n; ++s)
        scene.triangle(centre, first + s, first + (s + 1) % n, colours[k == 0 ? 0 : k - 1],
                       Scene::Surface::wood);
    }
    previous = first;
  }
}

}  // namespace

std::uint32_t Scene::vertex(const Vec3& position, const Vec3& normal) {
  vertices.push_back(position.cast<float>());
  normals.push_back(normal.cast<float>());
  return static_cast<std::uint32_t>(vertices.size() - 1);
}

void Scene::triangle(std::uint32_t a, std::uint32_t b, std::uint32_t c, Rgb colour, Surface surface) {
  triangles.push_back({a, b, c});
  colours.push_back(colour);
  surfaces.push_back(surface);
}

void add_wood(const Tree& tree, const Vec3& shift, const std::vector<Rgb>& colours, bool smooth,
              double min_radius_m, Scene& scene) {
  const auto drawn = [&](double radius) { return std::max(radius, min_radius_m); };
  if (!smooth) {
    for (std::size_t i = 0; i < tree.size(); ++i)
      add_tube({{tree.start[i] + shift, tree.direction(i), drawn(tree.radius[i])},
                {tree.end[i] + shift, tree.direction(i), drawn(tree.radius[i])}},
               {colours[i]}, scene);
    return;
  }
  for (const Axis& axis : axes_of(tree)) {
    if (axis.nodes.empty()) continue;
    std::vector<Ring> rings;
    std::vector<Rgb> of_segment;
    const auto first = static_cast<std::size_t>(axis.nodes[0]);
    // A branch begins on its parent's surface: sink its first ring by its own radius, so that no gap shows.
    const double sunk = axis.parent_node >= 0 ? tree.radius[first] : 0.0;
    rings.push_back({tree.start[first] + shift - sunk * tree.direction(first), tree.direction(first),
                     drawn(tree.radius[first])});
    for (std::size_t k = 0; k < axis.nodes.size(); ++k) {
      const auto i = static_cast<std::size_t>(axis.nodes[k]);
      Ring ring{tree.end[i] + shift, tree.direction(i), drawn(0.6 * tree.radius[i])};
      if (k + 1 < axis.nodes.size()) {
        const auto next = static_cast<std::size_t>(axis.nodes[k + 1]);
        const Vec3 bisector = tree.direction(i) + tree.direction(next);
        if (bisector.norm() > 1e-6) ring.tangent = bisector.normalized();
        ring.radius = drawn(0.5 * (tree.radius[i] + tree.radius[next]));
      }
      rings.push_back(ring);
      of_segment.push_back(colours[i]);
    }
    add_tube(rings, of_segment, scene);
  }
}

void add_leaves(const Foliage& foliage, const Vec3& shift, Scene& scene) {
  TriangleMesh blade;
  for (std::size_t i = 0; i < foliage.size(); ++i) {
    blade.vertices.clear();
    blade.triangles.clear();
    foliage.append_blade(i, blade);
    // Three tints, so that neighbouring leaves part.
    const double tint = 0.88 + 0.12 * static_cast<double>(i * 2654435761u % 3);
    const auto tinted = [&](std::uint8_t c) { return static_cast<std::uint8_t>(std::min(255.0, c * tint)); };
    const Rgb colour = {tinted(kLeaf.r), tinted(kLeaf.g), tinted(kLeaf.b)};
    const std::size_t of_blade = blade.triangles.size();
    foliage.append_petiole(i, blade);
    for (std::size_t k = 0; k < blade.triangles.size(); ++k) {
      const auto& t = blade.triangles[k];
      const Vec3& a = blade.vertices[t[0]];
      const Vec3& b = blade.vertices[t[1]];
      const Vec3& c = blade.vertices[t[2]];
      Vec3 normal = (b - a).cross(c - a);
      normal = normal.norm() > 0 ? normal.normalized() : foliage.leaves[i].normal;
      const std::uint32_t first = scene.vertex(a + shift, normal);
      scene.vertex(b + shift, normal);
      scene.vertex(c + shift, normal);
      scene.triangle(first, first + 1, first + 2, k < of_blade ? colour : kPetiole, Scene::Surface::leaf);
    }
  }
  if (!foliage.twigs.empty()) {
    const std::vector<Rgb> bark(foliage.twigs.size(), kPetiole);
    add_wood(foliage.twigs, shift, bark, true, 0, scene);
  }
}

void add_points(const PointCloud& cloud, const Vec3& shift, const std::vector<Rgb>* colours, Scene& scene) {
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    scene.points.push_back((cloud.points[i] + shift).cast<float>());
    scene.point_colours.push_back(colours && i < colours->size() ? (*colours)[i] : kScan);
  }
}

void add_panes(const TriangleMesh& mesh, const Vec3& shift, Scene& scene) {
  const auto corner = [&](std::uint32_t i) {
    return Eigen::Vector3f((mesh.vertices[i] + shift).cast<float>());
  };
  for (const auto& [a, b, c] : mesh.triangles) scene.panes.push_back({corner(a), corner(b), corner(c)});
}

void add_ground(double x, double y, double radius_m, Scene& scene) {
  constexpr int kSides = 72;
  const std::uint32_t centre = scene.vertex(Vec3(x, y, 0), Vec3::UnitZ());
  for (int s = 0; s < kSides; ++s) {
    const double angle = 2 * std::numbers::pi * s / kSides;
    scene.vertex(Vec3(x + radius_m * std::cos(angle), y + radius_m * std::sin(angle), 0), Vec3::UnitZ());
  }
  for (std::uint32_t s = 0; s < kSides; ++s)
    scene.triangle(centre, centre + 1 + s, centre + 1 + (s + 1) % kSides, kGround, Scene::Surface::ground);
}

}  // namespace dendrofit
