// SPDX-License-Identifier: GPL-3.0-or-later
// Facts of real files that other programs wrote.
#include "core/metrics.h"
#include "io/file_info.h"
#include "io/read_cloud.h"
#include "io/read_tree.h"
#include "tests/support/shared_data.h"

#include <cmath>
#include <numeric>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace dendrofit {
namespace {

using test::shared_data;

struct CloudFact {
  const char* file;
  std::size_t points;
};

class RealClouds : public testing::TestWithParam<CloudFact> {};

TEST_P(RealClouds, HaveTheirNumberOfPoints) {
  const auto path = shared_data(GetParam().file);
  DENDROFIT_NEED(path);
  const PointCloud cloud = read_point_cloud(path);
  EXPECT_EQ(cloud.size(), GetParam().points);
  cloud.validate();
  const Bounds bounds = bounds_of(cloud.points);
  EXPECT_LT(bounds.lo.cwiseAbs().maxCoeff(), 2000);
  EXPECT_LT(bounds.hi.cwiseAbs().maxCoeff(), 2000);
}

INSTANTIATE_TEST_SUITE_P(Files, RealClouds,
                         testing::Values(CloudFact{"real/young_broadleaf/cloud.las", 58219},
                                         CloudFact{"real/large_broadleaf/cloud.las", 20198},
                                         CloudFact{"real/coffeetree/cloud.txt", 14667},
                                         CloudFact{"real/pine/pine.las", 73851},
                                         CloudFact{"real/palm/cloud.txt", 30826},
                                         CloudFact{"real/palm/cloud.las", 30826},
                                         CloudFact{"real/palm/cloud.ply", 30826},
                                         CloudFact{"real/street_tree/lille_11.xyz", 19337},
                                         CloudFact{"real/street_tree/gap_in_stem.xyz", 10005},
                                         CloudFact{"real/impolite/crown_only_no_stem.las", 11119}));

TEST(RealClouds, ThreeFormatsOfOnePalmAgree) {
  const auto path = shared_data("real/palm/cloud.txt");
  DENDROFIT_NEED(path);
  const PointCloud text = read_point_cloud(path);
  for (const char* name : {"real/palm/cloud.las", "real/palm/cloud.ply"}) {
    const PointCloud other = read_point_cloud(shared_data(name));
    ASSERT_EQ(other.size(), text.size());
    double worst = 0;
    for (std::size_t i = 0; i < text.size(); ++i)
      worst = std::max(
          worst,
          (text.points[i] + text.origin_shift - other.points[i] - other.origin_shift).cwiseAbs().maxCoeff());
    EXPECT_LT(worst, 5.01e-4) << name;  // the LAS file stores millimetres
  }
}

struct TreeFact {
  const char* file;
  TreeFormat format;
  std::size_t cylinders;
  double volume_m3;
  double tolerance;
  double dbh_m;  ///< as its program reports it, by a definition of its own
  double height_m;
};

class RealTrees : public testing::TestWithParam<TreeFact> {};

TEST_P(RealTrees, HaveTheirCylindersAndVolume) {
  const TreeFact& fact = GetParam();
  const auto path = shared_data(fact.file);
  DENDROFIT_NEED(path);
  EXPECT_EQ(tree_format_of(path), fact.format);
  const Tree tree = read_tree(path);
  tree.validate();
  EXPECT_EQ(tree.size(), fact.cylinders);
  double volume = 0;
  for (std::size_t i = 0; i < tree.size(); ++i) volume += tree.volume(i);
  EXPECT_NEAR(volume, fact.volume_m3, fact.tolerance);
  const TreeMetrics metrics = measure(tree);
  EXPECT_NEAR(metrics.total_volume_m3, volume, 1e-9 * volume);
  if (fact.dbh_m > 0) {
    EXPECT_NEAR(metrics.dbh_m.value_or(0), fact.dbh_m, 0.05 * fact.dbh_m);
  }
  if (fact.height_m > 0) {
    EXPECT_NEAR(metrics.height_m, fact.height_m, 0.005);
  }
}

TEST(RealTrees, HaveTheirBranches) {
  const std::vector<std::pair<const char*, int>> facts = {
      {"real/young_broadleaf/qsm_archi.csv", 276},
      {"real/large_broadleaf/qsm_treeqsm.txt", 233},
      {"real/coffeetree/qsm_treeqsm.mat", 82}};  // TreeQSM says 85: three of them have no cylinder
  for (const auto& [file, branches] : facts) {
    const auto path = shared_data(file);
    DENDROFIT_NEED(path);
    EXPECT_EQ(read_tree(path).axis_count(), branches) << file;
  }
}

INSTANTIATE_TEST_SUITE_P(
    Files, RealTrees,
    testing::Values(
        TreeFact{"real/young_broadleaf/qsm_archi.csv", TreeFormat::archi_csv, 1990, 0.01425, 5e-6, 0.070,
                 6.18},
        TreeFact{"real/large_broadleaf/qsm_treeqsm.txt", TreeFormat::treeqsm_text, 2271, 3.899, 5e-4, 0.494,
                 22.04},
        TreeFact{"real/coffeetree/qsm_treeqsm.mat", TreeFormat::treeqsm_mat, 1136, 0.02157, 5e-6, 0.0741,
                 3.718},
        TreeFact{"real/coffeetree/qsm_simpleforest.csv", TreeFormat::simpleforest_csv, 1149, 0.02997, 5e-6,
                 0.0786, 0},
        TreeFact{"real/coffeetree/qsm_archi.csv", TreeFormat::archi_csv, 1231, 0.02179, 5e-6, 0.0729, 0},
        TreeFact{"real/palm/qsm_treeqsm.mat", TreeFormat::treeqsm_mat, 66, 0.264, 5e-4, 0.153, 0},
        TreeFact{"real/palm/big_qsm_treeqsm.mat", TreeFormat::treeqsm_mat, 3791, 12.9, 0.05, 0, 0}));

}  // namespace
}  // namespace dendrofit
