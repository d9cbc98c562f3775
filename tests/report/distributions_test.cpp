// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/report/distributions.h"

#include "core/metrics.h"
#include "tests/report/sample.h"

#include <numbers>
#include <numeric>

#include <gtest/gtest.h>

namespace dendrofit {
namespace {

Tree stem_with_level_branch() {
  Tree tree;
  TreeNode stem;
  stem.start = {0, 0, 1};
  stem.end = {0, 0, 3};
  stem.radius = 0.1;
  const std::int32_t foot = tree.add(stem);
  TreeNode branch;
  branch.start = {0.1, 0, 2.5};
  branch.end = {1.1, 0, 2.5};
  branch.radius = 0.02;
  branch.parent = foot;
  branch.axis = 1;
  branch.order = 1;
  tree.add(branch);
  return tree;
}

TEST(Distributions, ALevelBranchOnAnUprightStemStandsAtNinetyDegrees) {
  const BranchValues values = branch_values(stem_with_level_branch());
  ASSERT_EQ(values.angle_deg.size(), 1u);
  EXPECT_NEAR(values.angle_deg[0], 90, 1e-9);
  EXPECT_NEAR(values.length_m[0], 1, 1e-12);
  EXPECT_TRUE(branch_values(Tree{}).length_m.empty());
}

TEST(Distributions, HistogramSharesAddUpAndOutliersLandAtTheEnds) {
  const std::vector<double> shares = histogram({-5, 0.1, 0.9, 99}, 0, 1, 4);
  EXPECT_EQ(shares, (std::vector<double>{0.5, 0, 0, 0.5}));
  EXPECT_EQ(histogram({}, 0, 1, 2), (std::vector<double>{0, 0}));
}

double integral(const HeightProfile& profile, double step) {
  return step * std::accumulate(profile.area_per_m.begin(), profile.area_per_m.end(), 0.0);
}

TEST(Distributions, ProfilesHoldAllWoodAndAllLeaves) {
  const Tree tree = test::branching_tree(3, 5, {500000, 5000000, 300});
  EXPECT_NEAR(integral(wood_profile(tree, 0.2), 0.2), measure(tree).wood_area_m2, 1e-9);
  const Foliage foliage = test::diamond_leaves(tree, 200);
  EXPECT_NEAR(integral(leaf_profile(foliage, tree, 0.2), 0.2), foliage.total_area(), 1e-9);
  EXPECT_TRUE(wood_profile(Tree{}, 0.2).height_m.empty());
}

TEST(Distributions, HeightsCountFromTheFoot) {
  const HeightProfile profile = wood_profile(stem_with_level_branch(), 0.5);
  ASSERT_EQ(profile.height_m.size(), 4u);  // the stem is two metres high and stands at z = 1
  EXPECT_NEAR(profile.area_per_m[0], 2 * std::numbers::pi * 0.1, 1e-9);
  EXPECT_NEAR(profile.area_per_m[3], 2 * std::numbers::pi * 0.1 + 2 * std::numbers::pi * 0.02 / 0.5, 1e-9);
}

}  // namespace
}  // namespace dendrofit
