// SPDX-License-Identifier: GPL-3.0-or-later
#include "forward/leaves/insert_leaves.h"

#include "core/errors.h"
#include "core/random.h"
#include "forward/leaves/leaf_shapes.h"
#include "tests/leaves/bushes.h"

#include <atomic>
#include <cmath>
#include <limits>
#include <numbers>

#include <gtest/gtest.h>

namespace dendrofit {
namespace {

using test::bush;
using test::coarse_fork;
using test::post;

LeafOptions with_count(std::size_t n, std::uint64_t seed = 1) {
  LeafOptions options;
  options.count = n;
  options.seed = seed;
  return options;
}

bool same(const Leaf& a, const Leaf& b) {
  return a.petiole_foot == b.petiole_foot && a.origin == b.origin && a.direction == b.direction &&
         a.normal == b.normal && a.length_m == b.length_m && a.node == b.node && a.shape == b.shape;
}

TEST(InsertLeaves, GivesTheSameLeavesForAnyNumberOfThreads) {
  LeafOptions options = with_count(4000);
  options.threads = 1;
  const LeafResult one = insert_leaves(bush(), options);
  for (const int threads : {2, 5}) {
    options.threads = threads;
    const LeafResult many = insert_leaves(bush(), options);
    ASSERT_EQ(one.foliage.size(), many.foliage.size());
    for (std::size_t i = 0; i < one.foliage.size(); ++i)
      ASSERT_TRUE(same(one.foliage.leaves[i], many.foliage.leaves[i])) << i;
    EXPECT_EQ(one.report.poses, many.report.poses);
  }
}

TEST(InsertLeaves, AnotherSeedGivesOtherLeaves) {
  const LeafResult a = insert_leaves(bush(), with_count(50, 1)), b = insert_leaves(bush(), with_count(50, 2));
  int equal = 0;
  for (std::size_t i = 0; i < 50; ++i)
    equal += a.foliage.leaves[i].origin == b.foliage.leaves[i].origin ? 1 : 0;
  EXPECT_EQ(equal, 0);
}

TEST(InsertLeaves, ReachesACountExactly) {
  for (const std::size_t n : {1U, 7U, 500U, 3000U})
    EXPECT_EQ(insert_leaves(bush(), with_count(n)).foliage.size(), n);
}

TEST(InsertLeaves, ReachesAnAreaWithinOneLeaf) {
  for (const char* species : {"broadleaf", "maple", "dogwood", "larch"})
    for (const double area : {0.05, 0.3}) {
      LeafOptions options;
      options.traits = leaf_traits(species);
      options.area_m2 = area;
      const LeafResult result = insert_leaves(bush(), options);
      EXPECT_NEAR(result.foliage.total_area(), area, options.traits.mean_leaf_area_m2()) << species;
      EXPECT_EQ(result.report.shortfall_m2, 0) << species;
      EXPECT_NEAR(result.report.achieved_area_m2, result.foliage.total_area(), 1e-9);
    }
}

TEST(InsertLeaves, ReachesALeafAreaIndex) {
  LeafOptions options;
  options.lai = 1.5;
  const LeafResult result = insert_leaves(bush(), options);
  EXPECT_NEAR(result.report.lai, 1.5, 0.01);
  EXPECT_NEAR(result.report.lai, result.foliage.total_area() / result.report.crown_area_m2, 1e-9);
}

TEST(InsertLeaves, SeasonThinsTheTarget) {
  LeafOptions options = with_count(400);
  options.season = 0.25;
  EXPECT_EQ(insert_leaves(bush(), options).foliage.size(), 100U);
}

TEST(InsertLeaves, WithoutATargetTakesTheUsualOne) {
  const LeafResult result = insert_leaves(bush());
  EXPECT_EQ(result.report.target, "usual");
  EXPECT_GT(result.foliage.size(), 100U);
  EXPECT_EQ(result.report.shortfall_m2, 0);
}

TEST(InsertLeaves, LeavesStandOnThinWoodAndKeepTheirPetioles) {
  const Tree tree = bush();
  const LeafOptions options = with_count(2000);
  const LeafResult result = insert_leaves(tree, options);
  for (const Leaf& leaf : result.foliage.leaves) {
    const auto i = static_cast<std::size_t>(leaf.node);
    const Vec3 d = leaf.petiole_foot - tree.start[i];
    const double t = d.dot(tree.direction(i)), away = (d - t * tree.direction(i)).norm() - tree.radius[i];
    EXPECT_LE(tree.radius[i], 0.02);
    EXPECT_GT(std::max(away, t - tree.length(i)), 1e-4);
    EXPECT_LT(away, 0.003);
    EXPECT_NEAR(leaf.direction.dot(leaf.normal), 0, 1e-12);
    EXPECT_NEAR(leaf.direction.norm(), 1, 1e-12);
    const double petiole = (leaf.origin - leaf.petiole_foot).norm();
    EXPECT_GE(petiole, options.traits.petiole_min_m - 1e-12);
    EXPECT_LE(petiole, options.traits.petiole_max_m + 1e-12);
  }
}

TEST(InsertLeaves, CandidatesFollowWhatWasRequestedAndTheDriftIsReported) {
  LeafOptions options = with_count(4000);
  options.profile.height = UnitDistribution::beta(4, 2);
  options.profile.compass = UnitDistribution::von_mises(0.25, 1);
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    options.seed = seed;
    const LeafResult result = insert_leaves(bush(), options);
    ASSERT_EQ(result.report.distributions.size(), 8U);
    for (const LeafDistribution& d : result.report.distributions) {
      EXPECT_GT(d.before.p_value, 0.05) << d.name;
      EXPECT_LT(d.after.distance, 0.12) << d.name;
      double sum = 0;
      for (double share : d.achieved) sum += share;
      EXPECT_NEAR(sum, 1, 1e-9) << d.name;
    }
    EXPECT_GT(result.report.distributions.back().after.distance, 0);
  }
}

TEST(InsertLeaves, AHeightProfileIsMetWhateverTheWood) {
  LeafOptions options = with_count(3000);
  options.profile.height = UnitDistribution::histogram({0, 0, 1, 3});
  const LeafResult result = insert_leaves(bush(), options);
  const LeafDistribution& height = result.report.distributions.front();
  double above = 0, below = 0;
  for (std::size_t b = 0; b < 20; ++b) (b < 10 ? below : above) += height.achieved[b];
  EXPECT_LT(below, 0.02);
  double top = 0;
  for (std::size_t b = 15; b < 20; ++b) top += height.achieved[b];
  EXPECT_NEAR(top / above, 0.75, 0.05);
}

TEST(InsertLeaves, AProfileWhereNoWoodIsIsRefused) {
  LeafOptions options = with_count(10);
  options.profile.height = UnitDistribution::histogram({1, 0, 0, 0, 0, 0, 0, 0, 0, 0});
  EXPECT_THROW(insert_leaves(bush(), options), InputError);
}

TEST(InsertLeaves, InclinationsFollowTheirLaw) {
  LeafOptions options = with_count(1500);
  options.traits.inclination = inclination_law("spherical");
  const LeafResult result = insert_leaves(bush(), options);
  double mean = 0;
  for (const Leaf& leaf : result.foliage.leaves) mean += std::acos(std::abs(leaf.normal.z()));
  EXPECT_NEAR(mean / 1500, 1.0, 0.03);  // radians, of a sphere
}

TEST(InsertLeaves, SunFacingLeavesLeanToTheSun) {
  LeafOptions options = with_count(1000);
  options.traits.azimuth = {AzimuthLaw::Kind::towards, 90, 8};  // the morning sun
  const LeafResult result = insert_leaves(bush(), options);
  Vec3 sum = Vec3::Zero();
  for (const Leaf& leaf : result.foliage.leaves)
    sum += Vec3(leaf.normal.x(), leaf.normal.y(), 0).normalized();
  EXPECT_GT(sum.x() / 1000, 0.7);
  EXPECT_LT(std::abs(sum.y()) / 1000, 0.1);
}

TEST(InsertLeaves, TurnsFromLeafToLeafRunOnAcrossCylinders) {
  // An upright twig in six cylinders; few small leaves, so that each takes its first pose.
  LeafOptions options = with_count(24);
  options.traits.phyllotaxis.jitter_deg = 0;
  options.traits.length = {LengthLaw::Kind::constant, 0.01, 0.001, 0.01, 0.01};
  options.traits.petiole_min_m = options.traits.petiole_max_m = 0.005;
  options.traits.bearing = {0.005, 0.02, 5, 1};
  const LeafResult result = insert_leaves(post(6, 0.25, 0.003), options);
  ASSERT_EQ(result.foliage.size(), 24U);
  std::vector<int> on_node(6, 0);
  for (std::size_t i = 0; i < 24; ++i) {
    const Leaf& leaf = result.foliage.leaves[i];
    ++on_node[static_cast<std::size_t>(leaf.node)];
    if (i == 0) continue;
    const Leaf& before = result.foliage.leaves[i - 1];
    const double turn = std::atan2(leaf.petiole_foot.y(), leaf.petiole_foot.x()) -
                        std::atan2(before.petiole_foot.y(), before.petiole_foot.x());
    const double off = std::abs(std::remainder(turn, 2 * std::numbers::pi));
    if (leaf.node == 5 && before.petiole_foot.z() > 1.49) continue;  // on the end's disc
    EXPECT_NEAR(off, 137.5 * std::numbers::pi / 180, 1e-3) << i;
  }
  for (const int n : on_node) EXPECT_EQ(n, 4);
}

TEST(InsertLeaves, MeasuredLeafPointsDrawTheLeaves) {
  const Tree tree = bush();
  const LeafResult everywhere = insert_leaves(tree, with_count(1000));
  LeafOptions options = with_count(1000);
  options.measured.emplace();
  dendrofit::Random draw(4);
  for (const Leaf& leaf : everywhere.foliage.leaves)
    if (leaf.origin.x() > 0.3) options.measured->points.push_back(leaf.origin + 0.03 * draw.direction());
  const LeafResult result = insert_leaves(tree, options);
  std::size_t there = 0, before = 0;
  for (const Leaf& leaf : result.foliage.leaves) there += leaf.origin.x() > 0.2 ? 1 : 0;
  for (const Leaf& leaf : everywhere.foliage.leaves) before += leaf.origin.x() > 0.2 ? 1 : 0;
  EXPECT_LT(before, 600U);
  EXPECT_GT(there, 950U);
}

TEST(InsertLeaves, ATargetBeyondWhatFitsEndsAndSaysWhereAndWhy) {
  LeafOptions options;
  options.area_m2 = 50;
  const LeafResult result = insert_leaves(post(3, 0.2, 0.003), options);
  const LeafReport& r = result.report;
  EXPECT_LT(r.achieved_area_m2, 10);
  EXPECT_NEAR(r.shortfall_m2, 50 - r.achieved_area_m2, 1e-6);
  EXPECT_NE(r.shortfall_reason.find("other leaves"), std::string::npos) << r.shortfall_reason;
  double requested = 0, achieved = 0;
  int named = 0;
  for (const LeafBudgetBin& bin : r.bins) {
    requested += bin.requested_m2;
    achieved += bin.achieved_m2;
    if (!bin.reason.empty()) ++named;
  }
  EXPECT_NEAR(requested, 50, 1e-9);
  EXPECT_NEAR(achieved, r.achieved_area_m2, 1e-9);
  EXPECT_GT(named, 0);
  EXPECT_LT(r.poses, 3'000'000U);
}

TEST(InsertLeaves, KeepsAboveTheGround) {
  Tree tree;
  TreeNode node;
  node.end = Vec3(0, 0, 0.06);
  node.radius = 0.003;
  tree.add(node);
  node.start = node.end;
  node.end = Vec3(1, 0, 0.06);
  node.parent = 0;
  tree.add(node);
  LeafOptions options = with_count(150);
  const auto lowest = [&](const LeafResult& result) {
    double low = 1e9;
    TriangleMesh mesh;
    for (std::size_t i = 0; i < result.foliage.size(); ++i) {
      result.foliage.append_blade(i, mesh);
      result.foliage.append_petiole(i, mesh);
    }
    for (const Vec3& v : mesh.vertices) low = std::min(low, v.z());
    return low;
  };
  const LeafResult result = insert_leaves(tree, options);
  EXPECT_GE(lowest(result), options.clearance_m);
  options.on_ground = false;
  EXPECT_LT(lowest(insert_leaves(tree, options)), 0);
  options.on_ground = true;
  options.ground_z_m = 0.03;
  EXPECT_GE(lowest(insert_leaves(tree, options)), 0.0301);
}

TEST(InsertLeaves, NoLeavesAreAnAnswer) {
  const LeafResult none = insert_leaves(bush(), with_count(0));
  EXPECT_TRUE(none.foliage.leaves.empty());
  EXPECT_EQ(none.report.shortfall_m2, 0);
  LeafOptions options;
  options.area_m2 = 0;
  EXPECT_TRUE(insert_leaves(bush(), options).foliage.leaves.empty());
  options = {};
  options.season = 0;
  EXPECT_TRUE(insert_leaves(bush(), options).foliage.leaves.empty());
}

TEST(InsertLeaves, OneCylinderBearsLeaves) {
  EXPECT_EQ(insert_leaves(post(1, 0.5, 0.004), with_count(5)).foliage.size(), 5U);
  // Thick wood alone: leaves sit on what there is, and that is said.
  LeafOptions options = with_count(20);
  options.complete_twigs = false;
  const LeafResult stump = insert_leaves(post(1, 0.5, 0.3), options);
  EXPECT_EQ(stump.foliage.size(), 20U);
  EXPECT_FALSE(stump.report.warnings.empty());
}

TEST(InsertLeaves, ALeafLargerThanTheTreeIsPlacedOrReported) {
  LeafOptions options = with_count(3);
  options.traits.length = {LengthLaw::Kind::constant, 2, 0.1, 2, 2};
  const LeafResult result = insert_leaves(post(1, 0.05, 0.002), options);
  EXPECT_LE(result.foliage.size(), 3U);
  if (result.foliage.size() < 3) {
    EXPECT_FALSE(result.report.shortfall_reason.empty());
  }
}

TEST(InsertLeaves, RefusesTreesThatCannotBe) {
  EXPECT_THROW(insert_leaves(Tree{}), InputError);
  Tree flat = post(2, 0.3, 0.004);
  flat.end[1] = flat.start[1];
  EXPECT_THROW(insert_leaves(flat), InputError);
  Tree lost = post(2, 0.3, 0.004);
  lost.end[1].x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(insert_leaves(lost), InputError);
}

TEST(InsertLeaves, RefusesOptionsThatCannotBe) {
  const auto refused = [](auto change) {
    LeafOptions options;
    change(options);
    EXPECT_THROW(insert_leaves(post(1, 0.5, 0.004), options), InputError);
  };
  refused([](LeafOptions& o) { o.area_m2 = -1; });
  refused([](LeafOptions& o) { o.area_m2 = std::numeric_limits<double>::quiet_NaN(); });
  refused([](LeafOptions& o) { o.area_m2 = 1, o.count = 1; });
  refused([](LeafOptions& o) { o.clearance_m = 0; });
  refused([](LeafOptions& o) { o.season = 2; });
  refused([](LeafOptions& o) { o.traits.shapes.clear(); });
  refused([](LeafOptions& o) { o.traits.length.mean_m = std::numeric_limits<double>::quiet_NaN(); });
  refused([](LeafOptions& o) { o.profile.height = UnitDistribution::beta(-1, 2); });
  refused([](LeafOptions& o) {
    LeafShape line;
    line.name = "line";
    line.vertices = {{0, 0, 0}, {0, 0.5, 0}, {0, 1, 0}};
    line.triangles = {{0, 1, 2}};
    o.traits.shapes = {{line, 1}};
  });
}

TEST(InsertLeaves, ACoarseModelIsGivenShootsOnlyWhereItsWoodWillNotDo) {
  const Tree tree = coarse_fork();
  LeafOptions much;
  much.area_m2 = 5;
  const LeafResult full = insert_leaves(tree, much);
  EXPECT_GT(full.report.added_twigs_m, 1);
  ASSERT_FALSE(full.foliage.twigs.empty());
  full.foliage.twigs.validate();
  for (const Leaf& leaf : full.foliage.leaves) ASSERT_LT(leaf.node, static_cast<std::int32_t>(tree.size()));
  const LeafResult few = insert_leaves(tree, with_count(40));
  EXPECT_EQ(few.report.added_twigs_m, 0);
  much.complete_twigs = false;
  much.area_m2 = 3;
  EXPECT_TRUE(insert_leaves(tree, much).foliage.twigs.empty());
  EXPECT_TRUE(insert_leaves(bush()).foliage.twigs.empty());
  // A tree scanned in leaf: its own twigs bear what they can, shoots the rest.
  LeafOptions in_leaf;
  in_leaf.area_m2 = 26;
  EXPECT_TRUE(insert_leaves(bush(), in_leaf).foliage.twigs.empty());
  PointCloud cloud;
  for (const Vec3& end : bush().end) cloud.points.push_back(end);
  in_leaf.measured = cloud;
  const LeafResult leafy = insert_leaves(bush(), in_leaf);
  EXPECT_FALSE(leafy.foliage.twigs.empty());
  EXPECT_GT(leafy.report.achieved_area_m2, 20);
  in_leaf.area_m2 = 2;
  EXPECT_TRUE(insert_leaves(bush(), in_leaf).foliage.twigs.empty());
}

TEST(InsertLeaves, StopsWhenAsked) {
  const std::atomic<bool> stop{true};
  Progress progress(&stop);
  EXPECT_THROW(insert_leaves(bush(), with_count(100), progress), Cancelled);
}

TEST(InsertLeaves, ProfileAndVoxelsAddUpToTheLeafArea) {
  const LeafResult result = insert_leaves(bush(), with_count(800));
  const LeafReport& r = result.report;
  double profile = 0, voxels = 0;
  for (double d : r.leaf_area_density) profile += d * r.profile_step_m;
  for (const LeafVoxel& v : r.voxels) voxels += v.density_m2_per_m3 * std::pow(r.voxel_m, 3);
  EXPECT_NEAR(profile, r.achieved_area_m2, 1e-9);
  EXPECT_NEAR(voxels, r.achieved_area_m2, 1e-9);
  EXPECT_GT(r.gap_fraction, 0);
  EXPECT_LT(r.gap_fraction, 1);
  EXPECT_GT(r.clumping, 0);
  EXPECT_LT(r.clumping, 1.1);  // leaves on twigs are never more even than random
}

}  // namespace
}  // namespace dendrofit
