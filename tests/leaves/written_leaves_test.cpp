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

/// Writes tree and leaves, reads both back, and looks.
leafcheck::Verdict check_written(const Tree& tree, const Foliage& foliage) {
  const ScratchFolder folder;
  write_qsm_csv(folder / "qsm.csv", tree);
  write_foliage_obj(folder / "leaves.obj", foliage);
  double ground = 0;
  const auto wood = leafcheck::read_cylinders(folder / "qsm.csv", &ground);
  EXPECT_EQ(wood.size(), tree.size());
  return leafcheck::check(leafcheck::read_obj(folder / "leaves.obj"), wood, &ground);
}

/// Blades and petioles together, and the shoots that were added, without files.
leafcheck::Verdict check_with_petioles(const Tree& tree, const Foliage& foliage) {
  std::vector<leafcheck::Triangle> triangles;
  for (std::size_t i = 0; i < foliage.size(); ++i) {
    TriangleMesh mesh;
    foliage.append_blade(i, mesh);
    foliage.append_petiole(i, mesh);
    for (const auto& t : mesh.triangles) {
      leafcheck::Triangle triangle;
      triangle.leaf = i;
      for (std::size_t k = 0; k < 3; ++k)
        triangle.corner[k] = {mesh.vertices[t[k]].x(), mesh.vertices[t[k]].y(), mesh.vertices[t[k]].z()};
      triangles.push_back(triangle);
    }
  }
  std::vector<leafcheck::Cylinder> wood;
  for (const Tree* part : {&tree, &foliage.twigs})
    for (std::size_t i = 0; i < part->size(); ++i) {
      const Vec3 &s = part->start[i], d = part->direction(i);
      wood.push_back({{s.x(), s.y(), s.z()}, {d.x(), d.y(), d.z()}, part->length(i), part->radius[i]});
    }
  return leafcheck::check(triangles, wood, nullptr);
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
    expect_clean(check_with_petioles(bush(), result.foliage), species + " with petioles");
  }
}

TEST(WrittenLeaves, OfADenseCrownMeetNothing) {
  LeafOptions options;
  options.area_m2 = 25;
  const LeafResult result = insert_leaves(bush(), options);
  const leafcheck::Verdict verdict = check_written(bush(), result.foliage);
  expect_clean(verdict, "dense");
  EXPECT_GT(verdict.leaf_boxes, 40000U);
  expect_clean(check_with_petioles(bush(), result.foliage), "dense, with petioles");
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
  expect_clean(check_with_petioles(tree, result.foliage), "coarse, with shoots");
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
      const leafcheck::Verdict verdict = check_written(tree, result.foliage);
      expect_clean(verdict, std::string(file) + " seed " + std::to_string(seed));
      EXPECT_EQ(verdict.leaves, 5000U);
    }
  }
}

}  // namespace
}  // namespace dendrofit
