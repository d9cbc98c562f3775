// SPDX-License-Identifier: GPL-3.0-or-later
#include "forward/environment/light_field.h"

#include "core/errors.h"
#include "core/random.h"

#include <algorithm>
#include <cstdlib>
#include <vector>

#include <gtest/gtest.h>

namespace dendrofit {
namespace {

// Voxel by voxel, from the sentence in the paper: b^-q on (2q+1)^2 down to 20 layers, then on 41^2 to the
// ground.
Fixed brute_force(const std::vector<Voxel>& nodes, const ShadeProfile& profile, const Voxel& at) {
  Fixed sum = 0;
  for (const Voxel& node : nodes) {
    const int q = node.z - at.z;
    if (q < 0 || q >= profile.layers() || node.z < 0) continue;
    const int half = q < 20 ? q : 20;
    if (std::abs(node.x - at.x) <= half && std::abs(node.y - at.y) <= half) sum += profile[q];
  }
  return sum;
}

std::vector<Voxel> random_voxels(int count, int spread, int low, int high, std::uint64_t seed) {
  Random random(seed);
  std::vector<Voxel> voxels;
  for (int i = 0; i < count; ++i)
    voxels.push_back(
        {static_cast<std::int32_t>(random.below(static_cast<std::uint64_t>(2 * spread))) - spread,
         static_cast<std::int32_t>(random.below(static_cast<std::uint64_t>(2 * spread))) - spread,
         low + static_cast<std::int32_t>(random.below(static_cast<std::uint64_t>(high - low)))});
  return voxels;
}

TEST(LightField, equals_voxel_by_voxel_addition_to_the_last_bit) {
  LightField field;
  const ShadeProfile dark(1.8), light(2.2);
  const auto first = random_voxels(60, 30, 0, 90, 1), second = random_voxels(80, 70, 20, 120, 2);
  field.cast(first, dark);
  field.cast(second, light);
  const auto at = random_voxels(4000, 110, -3, 140, 3);
  std::vector<Fixed> shade(at.size());
  field.read(at, shade);
  for (std::size_t i = 0; i < at.size(); ++i) {
    const Fixed expected =
        at[i].z < 0 ? 0 : brute_force(first, dark, at[i]) + brute_force(second, light, at[i]);
    ASSERT_EQ(shade[i], expected) << at[i].x << ' ' << at[i].y << ' ' << at[i].z;
  }
}

TEST(LightField, does_not_depend_on_the_order_and_can_be_taken_back) {
  const ShadeProfile profile(1.9);
  auto nodes = random_voxels(200, 40, 0, 80, 4);
  const auto extra = random_voxels(50, 60, 0, 100, 5);
  const auto at = random_voxels(1000, 70, 0, 100, 6);
  std::vector<Fixed> one(at.size()), other(at.size());
  LightField a, b;
  a.cast(nodes, profile);
  a.read(at, one);
  std::reverse(nodes.begin(), nodes.end());
  b.cast(extra, profile);
  for (const Voxel& node : nodes) b.cast({&node, 1}, profile);
  b.cast(extra, profile, -1);
  b.read(at, other);
  EXPECT_EQ(one, other);
}

// Few voxels of a layer are summed, many are read from the drawn field; known ones get what is new.
TEST(LightField, an_update_gives_what_reading_in_full_gives) {
  LightField field;
  const ShadeProfile dark(1.8), light(2.2);
  std::vector<Voxel> at;
  std::vector<Fixed> shade;
  Random random(9);
  for (std::uint64_t cycle = 0; cycle < 6; ++cycle) {
    const ShadeProfile& profile = cycle % 2 == 0 ? dark : light;
    const auto made = random_voxels(300, 40, 20, 110, 10 + cycle);
    field.cast(made, profile);
    if (cycle == 3) field.cast(random_voxels(300, 40, 20, 110, 10), dark, -1);
    const std::size_t known = at.size();
    // One or two a layer near the ground, many further up.
    for (int i = 0; i < 30 + static_cast<int>(cycle) * 400; ++i)
      at.push_back({static_cast<std::int32_t>(random.below(120)) - 60,
                    static_cast<std::int32_t>(random.below(120)) - 60,
                    static_cast<std::int32_t>(i < 30 ? random.below(60) : 60 + random.below(60))});
    shade.resize(at.size(), 7);
    field.update(at, shade, known);
    std::vector<Fixed> full(at.size());
    LightField afresh;
    for (std::uint64_t past = 0; past <= cycle; ++past)
      afresh.cast(random_voxels(300, 40, 20, 110, 10 + past), past % 2 == 0 ? dark : light);
    if (cycle >= 3) afresh.cast(random_voxels(300, 40, 20, 110, 10), dark, -1);
    afresh.read(at, full);
    ASSERT_EQ(shade, full) << "cycle " << cycle;
    field.read(std::span(at).first(10),
               std::span(full).first(10));  // reading between updates changes nothing
  }
}

TEST(LightField, a_single_node_shades_a_pyramid_of_12341_voxels_then_a_column) {
  LightField field;
  const ShadeProfile profile(1.8);
  const Voxel node{3, -2, 60};
  field.cast({&node, 1}, profile);
  std::vector<Voxel> box;
  for (int z = 0; z <= 61; ++z)
    for (int y = -30; y <= 30; ++y)
      for (int x = -30; x <= 30; ++x) box.push_back({x, y, z});
  std::vector<Fixed> shade(box.size());
  field.read(box, shade);
  int pyramid = 0, column = 0;
  for (std::size_t i = 0; i < box.size(); ++i)
    if (shade[i] > 0) ++(60 - box[i].z <= 20 ? pyramid : column);
  EXPECT_EQ(pyramid, 12341);
  EXPECT_EQ(column, 1681 * (profile.layers() - 21));
  EXPECT_EQ(profile.layers(), 49);  // b^-48 is the last weight above half a unit of 2^-40
}

TEST(LightField, darkens_one_voxel_alone) {
  LightField field;
  field.darken({2, 3, 4}, kFullLight);
  const std::vector<Voxel> at{{2, 3, 4}, {3, 3, 4}, {2, 4, 4}, {2, 3, 3}, {1, 3, 4}};
  std::vector<Fixed> shade(at.size());
  field.read(at, shade);
  EXPECT_EQ(shade, (std::vector<Fixed>{kFullLight, 0, 0, 0, 0}));
}

TEST(LightField, an_empty_field_is_fully_lit_and_far_extents_are_refused) {
  LightField field(0.01);
  const std::vector<Voxel> at{{0, 0, 0}, {5, 5, 500}};
  std::vector<Fixed> shade(2, 7);
  field.read(at, shade);
  EXPECT_EQ(shade, (std::vector<Fixed>{0, 0}));
  EXPECT_THROW(field.cast(std::vector<Voxel>{{0, 0, 5}, {20000, 20000, 5}}, ShadeProfile(2)), InputError);
  EXPECT_THROW(ShadeProfile(1.0), InputError);
}

TEST(LightField, far_nodes_cost_memory_where_they_stand_and_the_limit_holds) {
  std::vector<Voxel> nodes;
  for (int y = 0; y < 30; ++y)
    for (int x = 0; x < 30; ++x) nodes.push_back({40 * x, 40 * y, 5});
  std::vector<Voxel> at;
  for (const Voxel& node : nodes)
    for (int z = 0; z <= 5; ++z) at.push_back({node.x, node.y, z});
  std::vector<Fixed> shade(at.size());
  LightField wide(1), narrow(0.03);
  wide.cast(nodes, ShadeProfile(2));
  wide.read(at, shade);
  for (std::size_t i = 0; i < at.size(); ++i) ASSERT_EQ(shade[i], ShadeProfile(2)[5 - at[i].z]);
  narrow.cast(nodes, ShadeProfile(2));
  EXPECT_THROW(narrow.read(at, shade), InputError);
}

}  // namespace
}  // namespace dendrofit
