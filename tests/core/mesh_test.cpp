// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/mesh.h"

#include "core/errors.h"
#include "tests/support/tiny_trees.h"

#include <cmath>
#include <map>
#include <numbers>

#include <gtest/gtest.h>

namespace dendrofit {
namespace {

double enclosed_volume(const TriangleMesh& mesh) {
  double six = 0;
  for (const auto& t : mesh.triangles) {
    const Vec3& a = mesh.vertices[t[0]];
    const Vec3& b = mesh.vertices[t[1]];
    const Vec3& c = mesh.vertices[t[2]];
    six += a.x() * (b.y() * c.z() - b.z() * c.y()) + a.y() * (b.z() * c.x() - b.x() * c.z()) +
           a.z() * (b.x() * c.y() - b.y() * c.x());
  }
  return six / 6;
}

TEST(TreeMesh, tubes_are_closed_and_face_outwards) {
  const TriangleMesh mesh = tree_mesh(test::small_tree());
  mesh.validate();
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
  for (const auto& t : mesh.triangles)
    for (int k = 0; k < 3; ++k)
      ++edges[{t[static_cast<std::size_t>(k)], t[static_cast<std::size_t>((k + 1) % 3)]}];
  for (const auto& [edge, count] : edges) {
    ASSERT_EQ(count, 1);
    ASSERT_TRUE(edges.count({edge.second, edge.first}));
  }
  EXPECT_GT(enclosed_volume(mesh), 0);
}

TEST(TreeMesh, encloses_nearly_the_cylinders_volume) {
  const double radius = 0.1;
  const TriangleMesh mesh = tree_mesh(test::pole(3, radius), {.min_sides = 64, .max_sides = 64});
  EXPECT_NEAR(enclosed_volume(mesh), std::numbers::pi * radius * radius * 3, 0.002 * 0.0942);
}

TEST(TreeMesh, refuses_nonsense_options) {
  EXPECT_THROW(tree_mesh(test::pole(1), {.min_sides = 2}), InputError);
}

TEST(TreeMesh, of_no_tree_is_empty) {
  EXPECT_TRUE(tree_mesh(Tree{}).triangles.empty());
}

TEST(TriangleMesh, append_and_validate) {
  TriangleMesh a;
  a.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  a.triangles = {{0, 1, 2}};
  TriangleMesh b = a;
  a.append(b);
  EXPECT_EQ(a.triangles[1][0], 3u);
  a.validate();
  a.triangles.push_back({0, 1, 99});
  EXPECT_THROW(a.validate(), InputError);
  b.origin_shift.x() = 1;
  EXPECT_THROW(a.append(b), InputError);
}

TEST(TriangleMesh, a_body_is_closed_and_a_sheet_or_a_body_with_a_hole_is_not) {
  TriangleMesh body;
  body.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  body.triangles = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}};
  EXPECT_TRUE(is_closed(body));
  TriangleMesh loose;  // as STL-like files have it: no vertex shared
  for (const auto& triangle : body.triangles) {
    const auto first = static_cast<std::uint32_t>(loose.vertices.size());
    for (const std::uint32_t vertex : triangle) loose.vertices.push_back(body.vertices[vertex]);
    loose.triangles.push_back({first, first + 1, first + 2});
  }
  EXPECT_TRUE(is_closed(loose));
  body.triangles.pop_back();
  EXPECT_FALSE(is_closed(body));
  body.triangles.resize(1);
  EXPECT_FALSE(is_closed(body));
  EXPECT_FALSE(is_closed({}));
  EXPECT_TRUE(is_closed(tree_mesh(test::small_tree())));
}

}  // namespace
}  // namespace dendrofit
