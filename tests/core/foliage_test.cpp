// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/foliage.h"

#include "core/errors.h"

#include <cmath>

#include <gtest/gtest.h>

namespace dendrofit {
namespace {

LeafShape square() {
  LeafShape shape;
  shape.name = "square";
  shape.vertices = {{-0.5, 0, 0}, {0.5, 0, 0}, {0.5, 1, 0}, {-0.5, 1, 0}};
  shape.triangles = {{0, 1, 2}, {0, 2, 3}};
  return shape;
}

TEST(Foliage, area_goes_with_the_square_of_length) {
  Foliage foliage;
  foliage.shapes = {square()};
  foliage.leaves.resize(2);
  foliage.leaves[0].length_m = 0.1;
  foliage.leaves[1].length_m = 0.2;
  EXPECT_DOUBLE_EQ(foliage.leaf_area(0), 0.01);
  EXPECT_DOUBLE_EQ(foliage.total_area(), 0.05);
}

TEST(Foliage, a_blade_lies_where_origin_and_directions_say) {
  Foliage foliage;
  foliage.shapes = {square()};
  foliage.leaves.push_back(
      {.origin = {1, 2, 3}, .direction = Vec3::UnitX(), .normal = Vec3::UnitZ(), .length_m = 0.1});
  TriangleMesh mesh;
  foliage.append_blade(0, mesh);
  ASSERT_EQ(mesh.vertices.size(), 4u);
  // +y of the shape runs along direction = +x; +x of the shape along direction x normal = -y
  EXPECT_LT((mesh.vertices[2] - Vec3(1.1, 1.95, 3)).norm(), 1e-9);
  for (const Vec3& v : mesh.vertices)
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(v[k] * 1e6, std::round(v[k] * 1e6), 1e-6);
}

TEST(LeafShape, validate_refuses_what_has_no_area) {
  EXPECT_NO_THROW(square().validate());
  LeafShape shape = square();
  shape.vertices[2] = shape.vertices[1];
  EXPECT_THROW(shape.validate(), InputError);
  shape = square();
  shape.triangles.clear();
  EXPECT_THROW(shape.validate(), InputError);
  shape = square();
  shape.vertices[0].x() = NAN;
  EXPECT_THROW(shape.validate(), InputError);
}

}  // namespace
}  // namespace dendrofit
