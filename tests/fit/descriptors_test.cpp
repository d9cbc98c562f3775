// SPDX-License-Identifier: GPL-3.0-or-later
#include "fit/descriptors.h"

#include "core/errors.h"
#include "core/tree_topology.h"
#include "tests/support/tiny_trees.h"

#include <cmath>
#include <map>
#include <string>

#include <gtest/gtest.h>

namespace dendrofit {
namespace {

const DescribeOptions kFine{.visible_share = 0.02};

std::map<std::string, double> named(const Tree& tree, const DescribeOptions& options = kFine) {
  std::map<std::string, double> values;
  const auto list = describe(tree, options);
  for (std::size_t i = 0; i < list.size(); ++i) values[std::string(descriptor_table()[i].name)] = list[i];
  return values;
}

/// The tree `factor` times as large, turned by a right angle about the vertical and set down elsewhere.
Tree transformed(Tree tree, double factor) {
  const auto move = [&](Vec3& p) { p = factor * Vec3(-p.y(), p.x(), p.z()) + Vec3(3, -4, 100); };
  for (std::size_t i = 0; i < tree.size(); ++i) {
    move(tree.start[i]);
    move(tree.end[i]);
    tree.radius[i] *= factor;
  }
  return tree;
}

TEST(Descriptors, of_a_tree_measured_by_hand) {
  auto d = named(test::small_tree());
  EXPECT_NEAR(d["internodes"], std::log(40), 1e-12);
  EXPECT_NEAR(d["slenderness"], std::log(0.4 / 4), 1e-12);
  EXPECT_NEAR(d["length"], std::log(6.5 / 4), 1e-12);
  EXPECT_NEAR(d["branches_1"], std::log(2), 1e-12);
  EXPECT_NEAR(d["branches_2_per_1"], std::log(2), 1e-12);
  EXPECT_NEAR(d["branch_length_1_50"], std::log(2.0 / 4), 1e-12);
  EXPECT_NEAR(d["branch_height"], 0.5, 1e-12);
  EXPECT_NEAR(d["insertion_1"], 90, 1e-9);
  EXPECT_NEAR(d["insertion_2"], 90, 1e-9);
  EXPECT_NEAR(d["elevation_1"], 0, 1e-9);
  EXPECT_NEAR(d["bend_1"], 0, 1e-9);
  EXPECT_NEAR(d["crown_base"], 0.5, 1e-12);
  EXPECT_NEAR(d["taper_50"], 0.125 / 0.2, 1e-12);  // between the middles at 1.5 and 2.5 m
  EXPECT_NEAR(d["radius_ratio_1"], 0.04 / 0.15, 1e-12);
  EXPECT_NEAR(d["straightness_1"], 1, 1e-12);
  EXPECT_NEAR(d["path_length"], (4 + 4 + 3.5) / 3 / 4, 1e-12);  // to the tips of stem, branch and twig
  // middles of the pieces below half the height: two stem pieces of radius 0.2 and 0.15, the branch at z = 2
  const double all = 0.04 + 0.0225 + 0.01 + 0.0025 + 0.0016 + 0.0004 + 0.00005;
  EXPECT_NEAR(d["volume_below_50"], (0.04 + 0.0225 + 0.0016 + 0.0004) / all, 1e-12);
  EXPECT_TRUE(std::isnan(d["insertion_spread_1"]));
  EXPECT_TRUE(std::isnan(d["pipe_exponent"]));
}

TEST(Descriptors, a_drooping_branch_bends_below_zero) {
  Tree tree = test::pole(4);
  for (int b = 0; b < 3; ++b) {
    const double z = 1 + b;
    const auto node = static_cast<std::int32_t>(tree.size());
    tree.add(
        {.start = {0, 0, z}, .end = {1, 0, z + 1}, .parent = b, .radius = 0.05, .axis = 1 + b, .order = 1});
    tree.add({.start = {1, 0, z + 1},
              .end = {2, 0, z + 1},
              .parent = node,
              .radius = 0.04,
              .axis = 1 + b,
              .order = 1});
  }
  // halves of equal length: the first rises by nearly 45 degrees, the last is nearly level
  EXPECT_LT(named(tree)["bend_1"], -30);
  EXPECT_GT(named(tree)["elevation_1"], 35);
}

TEST(Descriptors, thin_wood_and_short_axes_play_no_part) {
  Tree tree = test::small_tree();
  EXPECT_NEAR(named(tree, {.visible_share = 0.075})["branches_2_per_1"], 0, 1e-12);
  EXPECT_NEAR(named(tree, {.visible_share = 0.02, .shortest_axis_share = 0.15})["branches_2_per_1"], 0,
              1e-12);
  const Tree part = comparable_tree(tree, {.visible_share = 0.15, .shortest_axis_share = 0});
  EXPECT_EQ(part.size(), 5u);
  part.validate();
}

TEST(Descriptors, the_truncation_is_the_finest_that_shows) {
  EXPECT_EQ(comparison_level(test::pole(4, 0.1), ObservedFrom::scan), 0u);   // 7 mm
  EXPECT_EQ(comparison_level(test::pole(4, 0.03), ObservedFrom::scan), 1u);  // 2.1 mm would not show
  EXPECT_EQ(comparison_level(test::pole(4, 0.03), ObservedFrom::exact), 0u);
  EXPECT_EQ(comparison_level(test::pole(4, 0.1), ObservedFrom::one_view), 1u);
  const auto all = describe_at_all_levels(test::small_tree(), {});
  const auto last = describe(test::small_tree(), {.visible_share = kVisibleShares.back()});
  ASSERT_EQ(all.size(), kVisibleShares.size() * last.size());
  EXPECT_EQ(all[all.size() - last.size()], last[0]);
}

TEST(Descriptors, are_free_of_scale_place_and_azimuth) {
  DescribeOptions options = kFine;
  const auto before = describe(test::small_tree(), options);
  options.internode_length_m *= 7;
  const auto after = describe(transformed(test::small_tree(), 7), options);
  for (std::size_t i = 0; i < before.size(); ++i) {
    if (std::isnan(before[i]))
      EXPECT_TRUE(std::isnan(after[i]));
    else
      // a sample of the wood on the edge of a height band may fall on either side
      EXPECT_NEAR(before[i], after[i], descriptor_table()[i].name.starts_with("reach_") ? 0.02 : 1e-6)
          << descriptor_table()[i].name;
  }
}

TEST(Descriptors, do_not_depend_on_the_simulators_own_orders) {
  Tree tree = test::small_tree();
  const auto before = describe(tree, kFine);
  std::swap(tree.axis[5], tree.axis[6]);
  std::swap(tree.order[5], tree.order[6]);
  const auto after = describe(tree, kFine);
  for (std::size_t i = 0; i < before.size(); ++i)
    EXPECT_TRUE(before[i] == after[i] || std::isnan(before[i])) << descriptor_table()[i].name;
}

TEST(Descriptors, a_bare_stem_lacks_what_branches_tell) {
  auto d = named(test::pole(3));
  EXPECT_NEAR(d["internodes"], std::log(30), 1e-12);
  EXPECT_TRUE(std::isnan(d["insertion_1"]));
  EXPECT_TRUE(std::isnan(d["branches_2_per_1"]));
  EXPECT_EQ(d["branches_1"], 0);
  EXPECT_THROW(describe(Tree{}, {}), InputError);
  EXPECT_THROW(describe(test::pole(1), {.visible_share = -1}), InputError);
}

TEST(Descriptors, names_are_unique_and_rows_complete) {
  EXPECT_THROW(descriptor_row("volume_of_fruit"), InputError);
  std::map<std::string_view, int> seen;
  for (const DescriptorRow& row : descriptor_table()) {
    EXPECT_EQ(++seen[row.name], 1);
    EXPECT_GT(row.scan_error, 0);
    EXPECT_FALSE(row.meaning.empty());
    EXPECT_EQ(descriptor_table()[descriptor_row(row.name)].name, row.name);
  }
}

}  // namespace
}  // namespace dendrofit
