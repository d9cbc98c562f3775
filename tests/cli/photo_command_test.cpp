// SPDX-License-Identifier: GPL-3.0-or-later
// dendrofit reconstruct PHOTO, run as a user runs it.
#include "cli/report/image.h"
#include "tests/cli/run_program.h"
#include "tests/support/scratch_folder.h"

#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace dendrofit {
namespace {

/// A plain picture, and a forked tree as its mask: foot at row 390, tops at row 60.
class PhotoCommand : public ::testing::Test {
 protected:
  PhotoCommand() {
    write_png(folder / "photo.png", Image(300, 400, {210, 220, 235}));
    Image mask(300, 400, {0, 0, 0});
    fill_box(mask, 140, 200, 160, 390, {255, 255, 255});
    draw_line(mask, 150, 200, 70, 65, 10, {255, 255, 255});
    draw_line(mask, 150, 200, 230, 65, 10, {255, 255, 255});
    write_png(folder / "mask.png", mask);
  }
  std::string path(const std::string& name) const { return (folder / name).string(); }
  std::string photo() const { return path("photo.png") + " --mask " + path("mask.png"); }
  nlohmann::json json_of(const std::string& name) const {
    return nlohmann::json::parse(test::content_of(folder / name));
  }
  test::ScratchFolder folder;
};

TEST_F(PhotoCommand, writes_model_skeleton_metrics_and_overlay) {
  ASSERT_EQ(test::run_program("reconstruct " + photo() + " --height 6.6m -o " + path("a")).code, 0);
  for (const char* name :
       {"qsm.csv", "skeleton.csv", "metrics.json", "reconstruction.json", "overlay.png", "run.toml"})
    EXPECT_TRUE(std::filesystem::exists(folder / "a" / name)) << name;
  const auto metrics = json_of("a/metrics.json");
  EXPECT_NEAR(metrics.at("height_m").get<double>(), 6.6, 1e-6);
  EXPECT_NEAR(metrics.at("dbh_m").get<double>(), 0.4, 0.05);
  EXPECT_TRUE(metrics.at("crown_volume_m3").is_null());
  ASSERT_EQ(test::run_program("reconstruct " + photo() + " --height 6.6m --threads 1 -o " + path("b")).code,
            0);
  EXPECT_EQ(test::content_of(folder / "a/qsm.csv"), test::content_of(folder / "b/qsm.csv"));
  EXPECT_EQ(test::content_of(folder / "a/overlay.png"), test::content_of(folder / "b/overlay.png"));
}

TEST_F(PhotoCommand, works_without_a_scale_and_with_a_scale_bar) {
  ASSERT_EQ(test::run_program("reconstruct " + photo() + " -o " + path("none")).code, 0);
  EXPECT_EQ(json_of("none/reconstruction.json").at("unit"), "tree heights");
  EXPECT_TRUE(json_of("none/metrics.json").at("dbh_m").is_null());
  ASSERT_EQ(
      test::run_program("reconstruct " + photo() + " --scale-bar 170,380,170,280,2m -o " + path("bar")).code,
      0);
  // 330 pixels of 2 cm, but the lowest of them is the foot's near rim: it is 10 pixels of 0.72 * 400 nearer
  // to the camera than the stem's middle, which is higher by that share of the 190 pixels below the horizon.
  // The highest wood is taken to lean to the camera by the share told.
  const double lead = json_of("bar/reconstruction.json").at("top_lead").get<double>();
  EXPECT_NEAR(json_of("bar/metrics.json").at("height_m").get<double>() * (1 + lead),
              0.02 * (330 - 190 * 10 / (0.72 * 400)), 0.03);
  EXPECT_GT(lead, 0);
  EXPECT_LT(lead, 0.1);
  EXPECT_EQ(test::run_program("fit " + photo() + " -o " + path("fit")).code, 4);
  EXPECT_EQ(test::run_program("reconstruct " + photo() + " --tree-at 1,2 -o " + path("at")).code, 2);
}

TEST_F(PhotoCommand, says_what_is_wrong_by_its_exit_code) {
  const test::Outcome empty =
      test::run_program("reconstruct " + path("photo.png") + " --height 5m -o " + path("r"));
  EXPECT_EQ(empty.code, 4);
  EXPECT_NE(empty.err.find("no tree found: nothing darker than the sky"), std::string::npos) << empty.err;
  EXPECT_EQ(test::run_program("reconstruct " + path("missing.jpg") + " --height 5m -o " + path("r")).code, 3);
  EXPECT_EQ(test::run_program("reconstruct " + photo() + " --root 500,20 -o " + path("r")).code, 3);
  EXPECT_EQ(test::run_program("reconstruct " + photo() + " --scale-bar 1,2,3 -o " + path("r")).code, 2);
  EXPECT_EQ(
      test::run_program("reconstruct " + photo() + " --height 5m --scale-bar 1,2,3,9,1m -o " + path("r"))
          .code,
      2);
  EXPECT_EQ(test::run_program("reconstruct --height 5m -o " + path("r")).code, 2);
  std::ofstream(folder / "scan.xyz") << "0 0 0\n0 0 1\n";
  EXPECT_EQ(test::run_program("reconstruct " + path("scan.xyz") + " --height 5m -o " + path("r")).code, 2);
  EXPECT_FALSE(std::filesystem::exists(folder / "r"));
}

}  // namespace
}  // namespace dendrofit
