// SPDX-License-Identifier: GPL-3.0-or-later
#include "forward/leaves/leaf_shapes.h"

#include "core/errors.h"
#include "forward/leaves/leaf_traits.h"
#include "tests/leaves/exact_check.h"

#include <algorithm>
#include <set>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

namespace dendrofit {
namespace {

TEST(LeafShapes, AreOneLongAndSound) {
  for (const std::string& species : leaf_species()) {
    const LeafTraits traits = leaf_traits(species);
    traits.validate();
    EXPECT_EQ(traits.name, species);
    EXPECT_FALSE(traits.source.empty());
    for (const LeafShapeShare& s : traits.shapes) {
      double reach = 0;
      for (const Vec3& v : s.shape.vertices) reach = std::max(reach, v.y());
      EXPECT_NEAR(reach, 1, 1e-12) << species;
      EXPECT_GT(s.shape.unit_area(), 0.05) << species;
      EXPECT_LT(s.shape.unit_area(), 2) << species;
    }
  }
}

TEST(LeafShapes, PartsThatShareNoVertexDoNotMeet) {
  // So that a checker that takes them for leaves of their own finds nothing either.
  for (const std::string& species : leaf_species())
    for (const LeafShapeShare& s : leaf_traits(species).shapes) {
      const auto corners = [&](std::size_t k) {
        leafcheck::Triangle t;
        for (std::size_t c = 0; c < 3; ++c) {
          const Vec3& v = s.shape.vertices[s.shape.triangles[k][c]];
          t.corner[c] = {v.x(), v.y(), v.z()};
        }
        return t;
      };
      for (std::size_t i = 0; i < s.shape.triangles.size(); ++i)
        for (std::size_t j = i + 1; j < s.shape.triangles.size(); ++j) {
          std::set<std::uint32_t> all(s.shape.triangles[i].begin(), s.shape.triangles[i].end());
          all.insert(s.shape.triangles[j].begin(), s.shape.triangles[j].end());
          if (all.size() < 6) continue;
          EXPECT_FALSE(leafcheck::meet(corners(i), corners(j))) << species << " " << i << " " << j;
        }
    }
}

TEST(LeafShapes, FaceUp) {
  for (const LeafShape& shape :
       {simple_leaf(0.6), simple_leaf(0.6, 0.4, {10, 40}), lobed_leaf(0.6, 3), palmately_lobed_leaf(0.9, 5),
        pinnate_leaf(3, 0.3, 0.1), palmate_leaf(5, 0.3)})
    for (const auto& t : shape.triangles) {
      const Vec3 n =
          (shape.vertices[t[1]] - shape.vertices[t[0]]).cross(shape.vertices[t[2]] - shape.vertices[t[0]]);
      EXPECT_GT(n.z(), 0) << shape.name;
    }
}

TEST(LeafShapes, OfOneSpeciesHaveOneNumberOfTriangles) {
  for (const std::string& species : leaf_species()) {
    std::set<std::size_t> counts;
    for (const LeafShapeShare& s : leaf_traits(species).shapes) counts.insert(s.shape.triangles.size());
    EXPECT_EQ(counts.size(), 1U) << species;
  }
}

TEST(LeafShapes, TakeTheUsersMesh) {
  TriangleMesh mesh;
  mesh.vertices = {{-1, 0, 0}, {1, 0, 0}, {0, 4, 0}, {0, 2, 0}, {0, 3, 0}};
  mesh.triangles = {{0, 1, 2}, {2, 3, 4}};  // the second has no area
  const LeafShape shape = leaf_shape_from_mesh(mesh, "mine");
  EXPECT_EQ(shape.triangles.size(), 1U);
  EXPECT_NEAR(shape.unit_area(), 0.25, 1e-12);
  mesh.triangles = {{2, 3, 4}};
  EXPECT_THROW(leaf_shape_from_mesh(mesh, "thin"), InputError);
  mesh.triangles = {{0, 1, 7}};
  EXPECT_THROW(leaf_shape_from_mesh(mesh, "torn"), InputError);
  for (Vec3& v : mesh.vertices) v.y() = -v.y();
  mesh.triangles = {{0, 1, 2}};
  EXPECT_THROW(leaf_shape_from_mesh(mesh, "upside down"), InputError);
  EXPECT_THROW(leaf_shape_from_mesh({}, "empty"), InputError);
}

TEST(LeafTraits, RefuseAnUnknownSpeciesAndNameTheNearest) {
  try {
    leaf_traits("beach");
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("'beech'"), std::string::npos);
  }
}

TEST(LeafTraits, MeanAreaIsThatOfTheLaw) {
  LeafTraits traits = leaf_traits("broadleaf");
  traits.length = {LengthLaw::Kind::uniform, 0.05, 0.01, 0.04, 0.06};
  const double squares = (0.06 * 0.06 * 0.06 - 0.04 * 0.04 * 0.04) / 3 / 0.02;
  EXPECT_NEAR(traits.mean_leaf_area_m2(), squares * traits.shapes[0].shape.unit_area(), 1e-9);
}

}  // namespace
}  // namespace dendrofit
