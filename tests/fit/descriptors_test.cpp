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

std::map<std::string, double> named(const Tree& tree, const DescribeOptions& options = {}) {
  std::map<std::string, double> values;
  const auto list = describe(tree, options);
  for (std::size_t i = 0; i < list.size(); ++i) values[std::string(descriptor_table()[i].name)] = list[i];
  return values;
}

TEST(Descriptors, of_a_tree_measured_by_hand) {
  auto d = named(test::small_tree());
  EXPECT_NEAR(d["height"], std::log(4), 1e-12);
  EXPECT_NEAR(d["length"], std::log(6.5 / 4), 1e-12);
  EXPECT_NEAR(d["branches_1"], std::log(2), 1e-12);
  EXPECT_NEAR(d["branches_2_per_1"], std::log(2), 1e-12);
  EXPECT_NEAR(d["branch_length_1"], std::log(2.0 / 4), 1e-12);
  EXPECT_NEAR(d["insertion_1"], 90, 1e-9);
  EXPECT_NEAR(d["insertion_2"], 90, 1e-9);
  EXPECT_NEAR(d["elevation_1"], 0, 1e-9);
  EXPECT_NEAR(d["crown_base"], 0.5, 1e-12);
  // middles of the pieces below half the height: two stem pieces of radius 0.2 and 0.15, the branch at z = 2
  const double all = 0.04 + 0.0225 + 0.01 + 0.0025 + 0.0016 + 0.0004 + 0.00005;
  EXPECT_NEAR(d["volume_below_50"], (0.04 + 0.0225 + 0.0016 + 0.0004) / all, 1e-12);
  EXPECT_TRUE(std::isnan(d["insertion_spread_1"]));
}

TEST(Descriptors, thin_wood_and_short_axes_play_no_part) {
  Tree tree = test::small_tree();
  auto whole = named(tree, {.visible_radius_m = 0.015});
  EXPECT_NEAR(whole["branches_2_per_1"], 0, 1e-12);
  EXPECT_NEAR(named(tree, {.visible_radius_m = 0.005, .shortest_axis_m = 0.6})["branches_2_per_1"], 0, 1e-12);
  const Tree part = comparable_tree(tree, {.visible_radius_m = 0.03, .shortest_axis_m = 0});
  EXPECT_EQ(part.size(), 5u);
  part.validate();
}

TEST(Descriptors, do_not_depend_on_the_simulators_own_orders_or_on_where_the_tree_stands) {
  Tree tree = test::small_tree();
  const auto before = describe(tree, {});
  std::swap(tree.axis[5], tree.axis[6]);
  std::swap(tree.order[5], tree.order[6]);
  for (std::size_t i = 0; i < tree.size(); ++i) {
    tree.start[i] += Vec3(3, -4, 100);
    tree.end[i] += Vec3(3, -4, 100);
  }
  const auto after = describe(tree, {});
  for (std::size_t i = 0; i < before.size(); ++i) {
    if (std::isnan(before[i]))
      EXPECT_TRUE(std::isnan(after[i]));
    else
      EXPECT_NEAR(before[i], after[i], 1e-9) << descriptor_table()[i].name;
  }
}

TEST(Descriptors, a_bare_stem_lacks_what_branches_tell) {
  auto d = named(test::pole(3));
  EXPECT_NEAR(d["height"], std::log(3), 1e-12);
  EXPECT_TRUE(std::isnan(d["insertion_1"]));
  EXPECT_TRUE(std::isnan(d["branches_2_per_1"]));
  EXPECT_EQ(d["branches_1"], 0);
  EXPECT_THROW(describe(Tree{}, {}), InputError);
  EXPECT_THROW(describe(test::pole(1), {.visible_radius_m = -1}), InputError);
}

TEST(Descriptors, names_are_unique_and_rows_complete) {
  std::map<std::string_view, int> seen;
  for (const DescriptorRow& row : descriptor_table()) {
    EXPECT_EQ(++seen[row.name], 1);
    EXPECT_GT(row.scan_error, 0);
    EXPECT_FALSE(row.meaning.empty());
  }
}

}  // namespace
}  // namespace dendrofit
