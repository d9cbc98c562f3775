// SPDX-License-Identifier: GPL-3.0-or-later
// What a picture shows, as coloured triangles and points about one origin (single precision, metres).
#pragma once

#include "cli/report/colours.h"
#include "core/foliage.h"
#include "core/mesh.h"
#include "core/point_cloud.h"
#include "core/tree.h"

#include <array>
#include <cstdint>
#include <vector>

namespace dendrofit {

struct Scene {
  enum class Surface : std::uint8_t { wood, leaf, ground };

  std::vector<Eigen::Vector3f> vertices;
  std::vector<Eigen::Vector3f> normals;  ///< one a vertex
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::vector<Rgb> colours;       ///< one a triangle
  std::vector<Surface> surfaces;  ///< one a triangle
  std::vector<Eigen::Vector3f> points;
  std::vector<Rgb> point_colours;
  std::vector<std::array<Eigen::Vector3f, 3>> panes;  ///< see-through triangles, of what stands about

  std::uint32_t vertex(const Vec3& position, const Vec3& normal);
  void triangle(std::uint32_t a, std::uint32_t b, std::uint32_t c, Rgb colour, Surface surface);
};

/// Tubes along each axis (smooth) or one closed cylinder a node; radii below `min_radius_m` are drawn at it,
/// so that twigs thinner than a pixel do not break up. `shift` is added to the tree's local positions.
void add_wood(const Tree& tree, const Vec3& shift, const std::vector<Rgb>& colours, bool smooth,
              double min_radius_m, Scene& scene);
void add_leaves(const Foliage& foliage, const Vec3& shift, Scene& scene);
void add_points(const PointCloud& cloud, const Vec3& shift, const std::vector<Rgb>* colours, Scene& scene);
void add_panes(const TriangleMesh& mesh, const Vec3& shift, Scene& scene);
/// A level disc at z = 0 about (x, y).
void add_ground(double x, double y, double radius_m, Scene& scene);

}  // namespace dendrofit
