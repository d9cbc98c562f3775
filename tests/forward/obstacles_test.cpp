// SPDX-License-Identifier: GPL-3.0-or-later
#include "forward/environment/obstacles.h"

#include "core/errors.h"

#include <array>
#include <limits>

#include <gtest/gtest.h>

namespace dendrofit {
namespace {

const VoxelFrame kFrame{Vec3::Zero(), 0.05};

TriangleMesh closed_box(const Vec3& lo, const Vec3& hi) {
  TriangleMesh mesh;
  for (int corner = 0; corner < 8; ++corner)
    mesh.vertices.emplace_back(corner & 1 ? hi.x() : lo.x(), corner & 2 ? hi.y() : lo.y(),
                               corner & 4 ? hi.z() : lo.z());
  mesh.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                    {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  return mesh;
}

TEST(Obstacles, a_mesh_of_a_box_is_solid_and_shades_where_the_box_does) {
  const Vec3 lo(0.33, -0.41, 1.02), hi(0.91, 0.37, 1.31);
  Solids as_box, as_mesh;
  as_box.boxes.push_back({lo, hi});
  as_mesh.meshes.push_back(closed_box(lo, hi));
  const Obstacles box(as_box, kFrame, Vec3::Zero()), mesh(as_mesh, kFrame, Vec3::Zero());
  int solid = 0, dark = 0, penumbra = 0;
  for (int z = 0; z < 40; ++z)
    for (int y = -40; y < 40; ++y)
      for (int x = -30; x < 50; ++x) {
        const Voxel v{x, y, z};
        ASSERT_EQ(box.solid(v), mesh.solid(v)) << x << ' ' << y << ' ' << z;
        ASSERT_EQ(box.shade(v), mesh.shade(v)) << x << ' ' << y << ' ' << z;
        solid += box.solid(v);
        dark += box.shade(v) == kDark;
        penumbra += box.shade(v) > 0 && box.shade(v) < kDark;
      }
  EXPECT_GT(solid, 0);
  EXPECT_GT(dark, solid);  // all that lies straight below, down to the ground
  EXPECT_GT(penumbra, 1000);
}

TEST(Obstacles, a_half_space_is_the_limit_of_a_large_box) {
  Solids wall, block;
  wall.half_spaces.push_back({{1.0, 0, 0}, {-2, 0, 0}});  // open towards -x
  block.boxes.push_back({{1.0, -50, -50}, {90, 50, 50}});
  const Obstacles a(wall, kFrame, Vec3::Zero()), b(block, kFrame, Vec3::Zero());
  for (int z = 0; z < 30; ++z)
    for (int x = -10; x < 30; ++x) {
      ASSERT_EQ(a.solid({x, 3, z}), b.solid({x, 3, z})) << x;
      ASSERT_EQ(a.shade({x, 3, z}), b.shade({x, 3, z})) << x;
    }
  EXPECT_FALSE(a.solid({19, 0, 0}));  // ends at 0.975 m
  EXPECT_TRUE(a.solid({20, 0, 0}));
}

TEST(Obstacles, the_ground_as_a_half_space_shades_nothing_above_it) {
  Solids ground;
  ground.half_spaces.push_back({Vec3::Zero(), Vec3::UnitZ()});
  const Obstacles obstacles(ground, kFrame, Vec3::Zero());
  EXPECT_TRUE(obstacles.solid({0, 0, 0}));
  EXPECT_FALSE(obstacles.solid({0, 0, 1}));
  EXPECT_EQ(obstacles.shade({0, 0, 1}), 0);
}

TEST(Obstacles, no_piece_passes_a_board_thinner_than_a_step) {
  Solids board;
  board.boxes.push_back({{-1, -1, 0.98}, {1, 1, 0.985}});
  const Obstacles obstacles(board, kFrame, Vec3::Zero());
  EXPECT_TRUE(obstacles.blocks({0.1, 0.2, 0.93}, {0.12, 0.21, 1.07}));
  EXPECT_TRUE(obstacles.blocks({0.1, 0.2, 1.07}, {0.12, 0.21, 0.93}));
  EXPECT_FALSE(obstacles.blocks({0.1, 0.2, 0.7}, {0.12, 0.21, 0.8}));
  EXPECT_FALSE(obstacles.blocks({1.2, 0.2, 0.9}, {1.2, 0.3, 1.1}));
}

TEST(Obstacles, georeferenced_meshes_follow_the_sites_shift) {
  TriangleMesh mesh = closed_box({0, 0, 0}, {0.5, 0.5, 0.5});
  mesh.origin_shift = Vec3(400000, 5000000, 100);
  Solids solids;
  solids.meshes.push_back(mesh);
  const Obstacles obstacles(solids, kFrame, Vec3(399999, 5000000, 100));
  EXPECT_TRUE(obstacles.solid(kFrame.at({1.25, 0.25, 0.25})));
  EXPECT_FALSE(obstacles.solid(kFrame.at({0.25, 0.25, 0.25})));
}

TEST(Solids, refuses_what_is_no_body) {
  Solids solids;
  solids.boxes.push_back({{0, 0, 1}, {1, 1, 1}});
  EXPECT_THROW(solids.validate(), InputError);
  solids.boxes.clear();
  solids.half_spaces.push_back({Vec3::Zero(), Vec3::Zero()});
  EXPECT_THROW(solids.validate(), InputError);
  solids.half_spaces[0] = {Vec3(0, 0, std::numeric_limits<double>::quiet_NaN()), Vec3::UnitZ()};
  EXPECT_THROW(solids.validate(), InputError);
}

}  // namespace
}  // namespace dendrofit
