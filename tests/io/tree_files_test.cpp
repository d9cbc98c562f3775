// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/metrics.h"
#include "io/read_tree.h"
#include "io/write_tree.h"
#include "tests/io/samples.h"
#include "tests/support/shared_data.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace dendrofit {
namespace {

using test::content_of;
using test::refusal;
using test::TemporaryFolder;
using testing::HasSubstr;

const Vec3 kUtm(500017.25, 5412345.5, 1234.125);

void expect_same_tree(const Tree& a, const Tree& b, double tolerance) {
  ASSERT_EQ(a.size(), b.size());
  EXPECT_EQ(a.parent, b.parent);
  EXPECT_EQ(a.order, b.order);
  EXPECT_EQ(a.axis, b.axis);
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_LE((a.start[i] + a.origin_shift - b.start[i] - b.origin_shift).norm(), tolerance) << i;
    EXPECT_LE((a.end[i] + a.origin_shift - b.end[i] - b.origin_shift).norm(), tolerance) << i;
    EXPECT_DOUBLE_EQ(a.radius[i], b.radius[i]);
  }
}

TEST(QsmCsv, KeepsEveryFieldOfATree) {
  const TemporaryFolder folder;
  const Tree tree = test::sample_tree();
  write_qsm_csv(folder / "qsm.csv", tree);
  const Tree back = read_tree(folder / "qsm.csv");
  expect_same_tree(tree, back, 2e-9);
  EXPECT_EQ(tree.start, back.start);  // bit for bit
  EXPECT_EQ(tree.radius, back.radius);
  EXPECT_EQ(tree.quality, back.quality);
  for (std::size_t i = 0; i < tree.size(); ++i)
    EXPECT_TRUE(tree.radius_se[i] == back.radius_se[i] ||
                (std::isnan(tree.radius_se[i]) && std::isnan(back.radius_se[i])));
  EXPECT_EQ(back.end[0], back.start[1]) << "wood that goes on stays joined";
}

TEST(QsmCsv, HasTheHeaderThatScriptsRelyOn) {
  const TemporaryFolder folder;
  write_qsm_csv(folder / "qsm.csv", test::sample_tree());
  EXPECT_THAT(
      content_of(folder / "qsm.csv"),
      testing::StartsWith("id,parent,axis,order,start_x,start_y,start_z,axis_x,axis_y,axis_z,length,radius,"
                          "quality,radius_se\n1,0,1,0,0.1,0.2,0.3,"));
}

TEST(QsmCsv, IsTheSameByteForByteOnceReadAndWrittenAgain) {
  const TemporaryFolder folder;
  for (const Vec3& shift : {Vec3(0, 0, 0), kUtm, Vec3(-835.5, 690.1, 99.99), Vec3(1e6 / 3, 9e6 / 7, 50)}) {
    for (std::uint64_t seed = 1; seed <= 5; ++seed) {
      write_qsm_csv(folder / "a.csv", test::random_tree(400, shift, seed));
      write_qsm_csv(folder / "b.csv", read_tree(folder / "a.csv"));
      ASSERT_EQ(content_of(folder / "a.csv"), content_of(folder / "b.csv"))
          << shift.transpose() << " seed " << seed;
    }
  }
}

TEST(QsmCsv, LosesNothingOfLargeCoordinates) {
  const TemporaryFolder folder;
  const Tree tree = test::random_tree(300, kUtm);
  write_qsm_csv(folder / "qsm.csv", tree);
  const Tree back = read_tree(folder / "qsm.csv");
  expect_same_tree(tree, back, 3e-9);
  EXPECT_LT(back.start[0].norm(), 200);
  double volume = 0;
  double volume_back = 0;
  for (std::size_t i = 0; i < tree.size(); ++i) {
    volume += tree.volume(i);
    volume_back += back.volume(i);
  }
  EXPECT_NEAR(volume, volume_back, 1e-6 * volume);
}

TEST(QsmCsv, UnderstandsRowsInAnyOrderAndIdsWithGaps) {
  const TemporaryFolder folder;
  const std::string header =
      "id,parent,axis,order,start_x,start_y,start_z,axis_x,axis_y,axis_z,length,radius,quality,radius_se\n";
  const auto path = folder.file(
      "qsm.csv", header + "30,7,1,0,0,0,1,0,0,1,1,0.09,measured,\n7,0,1,0,0,0,0,0,0,1,1,0.1,measured,\n");
  const Tree tree = read_tree(path);
  ASSERT_EQ(tree.size(), 2u);
  EXPECT_EQ(tree.parent, (std::vector<std::int32_t>{-1, 0}));
  EXPECT_DOUBLE_EQ(tree.radius[0], 0.1);
  EXPECT_EQ(tree.axis, (std::vector<std::int32_t>{0, 0}));
}

TEST(QsmCsv, ReadsWindowsLineEndsAndDecimalCommas) {
  const TemporaryFolder folder;
  const auto path = folder.file("qsm.csv",
                                "\xef\xbb\xbfid;parent;axis;order;start_x;start_y;start_z;axis_x;axis_y;axis_"
                                "z;length;radius;quality;radius_se\r\n"
                                "1;0;1;0;0,5;0;0;0;0;1;1,5;0,1;measured;0,002\r\n");
  const Tree tree = read_tree(path);
  EXPECT_DOUBLE_EQ(tree.start[0].x(), 0.5);
  EXPECT_DOUBLE_EQ(tree.length(0), 1.5);
  EXPECT_DOUBLE_EQ(tree.radius_se[0], 0.002);
}

TEST(QsmCsv, RefusesWhatCannotBeWithLineAndRemedy) {
  const TemporaryFolder folder;
  const std::string header =
      "id,parent,axis,order,start_x,start_y,start_z,axis_x,axis_y,axis_z,length,radius,quality,radius_se\n";
  const std::string good = "1,0,1,0,0,0,0,0,0,1,1,0.1,measured,\n";
  const auto complaint = [&](const std::string& row) {
    const auto path = folder.file("qsm.csv", header + good + row);
    return refusal([&] { read_tree(path); });
  };
  EXPECT_THAT(complaint("2,1,1,0,0,0,1,0,0,1,1,-0.1,measured,\n"), HasSubstr("line 3: radius -0.1"));
  EXPECT_THAT(complaint("2,1,1,0,0,0,1,0,0,1,0,0.1,measured,\n"), HasSubstr("line 3: length 0"));
  EXPECT_THAT(complaint("2,1,1,0,0,0,1,0,0,2,1,0.1,measured,\n"), HasSubstr("unit vector"));
  EXPECT_THAT(complaint("2,9,1,0,0,0,1,0,0,1,1,0.1,measured,\n"), HasSubstr("line 3: parent 9"));
  EXPECT_THAT(complaint("1,0,1,0,0,0,1,0,0,1,1,0.1,measured,\n"), HasSubstr("a second time"));
  EXPECT_THAT(complaint("2,2,1,0,0,0,1,0,0,1,1,0.1,measured,\n"), HasSubstr("back to itself"));
  EXPECT_THAT(complaint("2,1,1,0,nan,0,1,0,0,1,1,0.1,measured,\n"), HasSubstr("'start_x': 'nan' found"));
  EXPECT_THAT(complaint("2,1,1,0,0,0,1,0,0,1,1,0.1,guessed,\n"), HasSubstr("'guessed'"));
  EXPECT_THAT(complaint("2,1,1,0,0,0,1,0,0,1,1\n"), HasSubstr("11 fields"));
  EXPECT_THAT(complaint("2,1,1,0,0,0,1,0,0,1,1,0.1,measured,0.0"), HasSubstr("truncated"));
  const auto short_header =
      folder.file("short.csv", "id,parent,axis,order,start_x,start_y,start_z,axis_x,axis_y,axis_z,radius\n");
  EXPECT_THAT(refusal([&] { read_tree(short_header); }),
              HasSubstr("column 'length' is missing; found: id, parent"));
}

class TreeFormats : public testing::TestWithParam<TreeFormat> {};

TEST_P(TreeFormats, KeepGeometryParentsAndOrders) {
  const TemporaryFolder folder;
  for (const Vec3& shift : {Vec3(0, 0, 0), kUtm}) {
    const Tree tree = test::random_tree(200, shift);
    write_tree(folder / "x", tree, GetParam());
    EXPECT_EQ(tree_format_of(folder / "x"), GetParam());
    const Tree back = read_tree(folder / "x");
    back.validate();
    ASSERT_EQ(back.size(), tree.size());
    EXPECT_EQ(back.parent, tree.parent);
    EXPECT_EQ(back.order, tree.order);
    EXPECT_EQ(back.axis, tree.axis);
    for (std::size_t i = 0; i < tree.size(); ++i) {
      EXPECT_EQ(back.radius[i], tree.radius[i]);
      EXPECT_LT((back.end[i] + back.origin_shift - tree.end[i] - tree.origin_shift).norm(), 4e-9) << i;
      if (GetParam() == TreeFormat::treefile) continue;  // its cylinders start at their parent's tip
      EXPECT_LT((back.start[i] + back.origin_shift - tree.start[i] - tree.origin_shift).norm(), 4e-9) << i;
    }
  }
}

TEST_P(TreeFormats, KeepSeveralRoots) {
  const TemporaryFolder folder;
  write_tree(folder / "x", test::sample_tree(), GetParam());
  const Tree back = read_tree(folder / "x");
  EXPECT_EQ(back.parent, test::sample_tree().parent);
}

INSTANTIATE_TEST_SUITE_P(All, TreeFormats,
                         testing::Values(TreeFormat::ours, TreeFormat::treeqsm_text, TreeFormat::treeqsm_mat,
                                         TreeFormat::treefile, TreeFormat::simpleforest_csv,
                                         TreeFormat::archi_csv, TreeFormat::arbor_csv));

TEST(TreeFiles, JoinOverCylindersWithoutLength) {
  const TemporaryFolder folder;
  const auto path =
      folder.file("sf.csv",
                  "ID, parentID, startX, startY, startZ, endX, endY, endZ, radius, length, branchOrder\n"
                  "0,-1,0,0,0,0,0,1,0.1,1,0\n1,0,0,0,1,0,0,1,0.1,0,0\n2,1,0,0,1,0,0,2,0.1,1,0\n");
  const Tree tree = read_tree(path);
  EXPECT_EQ(tree.size(), 2u);
  EXPECT_EQ(tree.parent, (std::vector<std::int32_t>{-1, 0}));
}

TEST(TreeFiles, TreefileWithTreeAttributesAndSeveralTrees) {
  const TemporaryFolder folder;
  const auto path = folder.file("trees.txt",
                                "# treefile\nheight,crown_radius, x,y,z,radius,parent_id,section_id\n"
                                "3,1, 0,0,0,0.2,-1,0, 0,0,1,0.2,0,1, 0,0,2,0.1,1,2, 0.5,0,1.5,0.05,1,3\n"
                                "2,1, 5,0,0,0.2,-1,0, 5,0,1,0.2,0,1\n");
  const Tree tree = read_tree(path);
  ASSERT_EQ(tree.size(), 4u);
  EXPECT_EQ(tree.parent, (std::vector<std::int32_t>{-1, 0, 0, -1}));
  EXPECT_EQ(tree.order, (std::vector<std::int32_t>{0, 0, 1, 0}));
  EXPECT_EQ(tree.start[2], Vec3(0, 0, 1));
}

TEST(TreeFiles, SaysWhatWasExpectedOfAnUnknownFile) {
  const TemporaryFolder folder;
  EXPECT_THAT(refusal([&] { read_tree(folder.file("a.csv", "time,value\n1,2\n")); }),
              HasSubstr("expected a tree model"));
  EXPECT_THAT(
      refusal([&] { read_tree(folder.file("b.mat", "MATLAB 7.3 MAT-file" + std::string(200, ' '))); }),
      HasSubstr("'-v7'"));
}

TEST(TreeFiles, RealModelsSurviveEveryFormat) {
  const auto path = test::shared_data("real/coffeetree/qsm_treeqsm.mat");
  DENDROFIT_NEED(path);
  const TemporaryFolder folder;
  const Tree tree = read_tree(path);
  for (int f = 0; f < 7; ++f) {
    const auto format = static_cast<TreeFormat>(f);
    if (format == TreeFormat::treefile) continue;
    write_tree(folder / "x", tree, format);
    write_qsm_csv(folder / "again.csv", read_tree(folder / "x"));
    expect_same_tree(tree, read_tree(folder / "again.csv"), 4e-9);
  }
}

}  // namespace
}  // namespace dendrofit
