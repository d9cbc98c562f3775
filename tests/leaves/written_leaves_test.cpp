// SPDX-License-Identifier: GPL-3.0-or-later
// The promise itself: leaves as written meet nothing, by the checker that knows nothing of how they were
// placed.
#include "forward/leaves/insert_leaves.h"
#include "forward/leaves/leaf_shapes.h"
#include "io/read_tree.h"
#include "io/write_mesh.h"
#include "io/write_tree.h"
#include "tests/leaves/bushes.h"
#include "tests/leaves/exact_check.h"
#include "tests/support/scratch_folder.h"
#include "tests/support/shared_data.h"

#include <cstdlib>
#include <numeric>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

namespace dendrofit {
namespace {

using test::bush;
using test::ScratchFolder;

/// Writes tree and leaves (with petioles and added shoots where asked for), reads all back, and looks.
leafcheck::Verdict check_written(const Tree& tree, const Foliage& foliage, bool with_petioles = false) {
  const ScratchFolder folder;
  write_qsm_csv(folder / "qsm.csv", tree);
  write_foliage_obj(folder / "leaves.obj", foliage);
  double ground = 0;
  auto wood = leafcheck::read_cylinders(folder / "qsm.csv", &ground);
  EXPECT_EQ(wood.size(), tree.size());
  if (!with_petioles) return leafcheck::check(leafcheck::read_obj(folder / "leaves.obj"), wood, &ground);
  auto triangles = leafcheck::read_obj(folder / "leaves.obj", foliage.size());
  write_petioles_obj(folder / "petioles.obj", foliage);
  const auto petioles = leafcheck::read_grouped_obj(folder / "petioles.obj");
  EXPECT_EQ(petioles.size(), 2 * foliage.size());
  triangles.insert(triangles.end(), petioles.begin(), petioles.end());
  if (!foliage.twigs.empty()) {
    write_qsm_csv(folder / "shoots.csv", foliage.twigs);
    const auto shoots = leafcheck::read_cylinders(folder / "shoots.csv");
    wood.insert(wood.end(), shoots.begin(), shoots.end());
  }
  return leafcheck::check(triangles, wood, &ground);
}

void expect_clean(const leafcheck::Verdict& verdict, const std::string& what) {
  EXPECT_TRUE(verdict.leaf_hits.empty()) << what << ": " << verdict.leaf_hits.size() << " leaves meet leaves";
  EXPECT_TRUE(verdict.wood_hits.empty()) << what << ": " << verdict.wood_hits.size() << " leaves meet wood";
  EXPECT_TRUE(verdict.ground_hits.empty()) << what;
  EXPECT_TRUE(verdict.degenerate.empty()) << what;
}

TEST(WrittenLeaves, OfEverySpeciesMeetNothing) {
  for (const std::string& species : leaf_species()) {
    LeafOptions options;
    options.traits = leaf_traits(species);
    const LeafResult result = insert_leaves(bush(), options);
    ASSERT_GT(result.foliage.size(), 20U) << species;
    const leafcheck::Verdict verdict = check_written(bush(), result.foliage);
    expect_clean(verdict, species);
    EXPECT_GT(verdict.leaf_boxes, 100U) << species;  // or nothing was looked at
    expect_clean(check_written(bush(), result.foliage, true), species + " with petioles");
  }
}

TEST(WrittenLeaves, OfADenseCrownMeetNothing) {
  LeafOptions options;
  options.area_m2 = 25;
  const LeafResult result = insert_leaves(bush(), options);
  const leafcheck::Verdict verdict = check_written(bush(), result.foliage);
  expect_clean(verdict, "dense");
  EXPECT_GT(verdict.leaf_boxes, 40000U);
  expect_clean(check_written(bush(), result.foliage, true), "dense, with petioles");
}

TEST(WrittenLeaves, WithCurvedBladesMeetNothing) {
  LeafOptions options;
  options.traits.shapes = {{simple_leaf(0.6, 0.4, {35, 100}), 1}};
  options.area_m2 = 8;
  expect_clean(check_written(bush(), insert_leaves(bush(), options).foliage), "curved");
}

TEST(WrittenLeaves, InMapCoordinatesMeetNothing) {
  // Neither a whole number of micrometres nor of anything else.
  Tree tree = bush();
  tree.origin_shift = Vec3(452345.1234567, 5411234.7654321, 312.3333333);
  LeafOptions options;
  options.area_m2 = 8;
  const LeafResult result = insert_leaves(tree, options);
  const leafcheck::Verdict verdict = check_written(tree, result.foliage);
  expect_clean(verdict, "map");
  EXPECT_GT(verdict.leaf_boxes, 10000U);
  // Without the shift taken apart, coordinates as large must do too.
  Tree far = bush();
  for (std::size_t i = 0; i < far.size(); ++i) {
    far.start[i] += tree.origin_shift;
    far.end[i] += tree.origin_shift;
  }
  expect_clean(check_written(far, insert_leaves(far, options).foliage), "far");
}

TEST(WrittenLeaves, OnAddedShootsMeetNothing) {
  const Tree tree = test::coarse_fork();
  LeafOptions options;
  options.area_m2 = 6;
  const LeafResult result = insert_leaves(tree, options);
  ASSERT_FALSE(result.foliage.twigs.empty());
  expect_clean(check_written(tree, result.foliage), "coarse");
  expect_clean(check_written(tree, result.foliage, true), "coarse, with shoots");
}

TEST(WrittenLeaves, AMovedLeafIsCaught) {
  LeafOptions options;
  options.area_m2 = 2;
  LeafResult result = insert_leaves(bush(), options);
  Foliage pushed = result.foliage;
  Leaf& first = pushed.leaves[3];
  first = pushed.leaves[40];
  first.origin += 0.3 * first.length_m * first.normal.unitOrthogonal();
  EXPECT_FALSE(check_written(bush(), pushed).leaf_hits.empty());
  pushed = result.foliage;
  pushed.leaves[0].origin = bush().start[0] + Vec3(0, 0, 0.1);
  EXPECT_FALSE(check_written(bush(), pushed).wood_hits.empty());
  // A stalk that starts on the other side of its twig.
  pushed = result.foliage;
  const auto node = static_cast<std::size_t>(pushed.leaves[0].node);
  const Vec3 along = bush().direction(node), from_axis = pushed.leaves[0].petiole_foot - bush().start[node];
  pushed.leaves[0].petiole_foot -= 2 * (from_axis - from_axis.dot(along) * along);
  EXPECT_TRUE(check_written(bush(), pushed).clean());
  EXPECT_FALSE(check_written(bush(), pushed, true).wood_hits.empty());
}

/// $DENDROFIT_LEAF_SEEDS seeds (default 3) with 5000 leaves on three cylinder models of real trees.
TEST(WrittenLeaves, OnRealTreesMeetNothing) {
  const char* wanted = std::getenv("DENDROFIT_LEAF_SEEDS");
  const std::uint64_t seeds = wanted ? std::strtoull(wanted, nullptr, 10) : 3;
  for (const char* file : {"real/young_broadleaf/qsm_archi.csv", "real/coffeetree/qsm_simpleforest.csv",
                           "real/large_broadleaf/qsm_treeqsm.txt"}) {
    DENDROFIT_NEED(test::shared_data(file));
    const Tree tree = read_tree(test::shared_data(file));
    for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
      LeafOptions options;
      options.count = 5000;
      options.seed = seed;
      const LeafResult result = insert_leaves(tree, options);
      EXPECT_EQ(result.foliage.size(), 5000U);
      for (const LeafDistribution& d : result.report.distributions)
        EXPECT_GT(d.before.p_value, 0.05) << d.name;
      const leafcheck::Verdict verdict = check_written(tree, result.foliage, true);
      expect_clean(verdict, std::string(file) + " seed " + std::to_string(seed));
      EXPECT_EQ(verdict.leaves, 5000U);
    }
  }
}

}  // namespace
}  // namespace dendrofit
