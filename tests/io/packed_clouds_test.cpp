// SPDX-License-Identifier: GPL-3.0-or-later
// LAZ and E57.
#include "io/read_cloud.h"
#include "tests/io/e57_sample.h"
#include "tests/io/samples.h"
#include "tests/support/shared_data.h"

#include <cstdlib>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace dendrofit {
namespace {

using test::content_of;
using test::refusal;
using test::shared_data;
using test::TemporaryFolder;
using testing::HasSubstr;

// The reader, or a skip where the decompressor is not installed.
#define READ_LAZ_OR_SKIP(cloud, path)                                                \
  PointCloud cloud;                                                                  \
  try {                                                                              \
    cloud = read_point_cloud(path);                                                  \
  } catch (const IoError& error) {                                                   \
    if (std::string(error.what()).find("not installed") == std::string::npos) throw; \
    GTEST_SKIP() << error.what();                                                    \
  }

TEST(Laz, HoldsThePointsOfTheSameLas) {
  const auto path = shared_data("real/pine/pine.laz");
  DENDROFIT_NEED(path);
  READ_LAZ_OR_SKIP(laz, path);
  const PointCloud las = read_point_cloud(shared_data("real/pine/pine.las"));
  EXPECT_EQ(laz.points, las.points);
  EXPECT_EQ(laz.intensity, las.intensity);
  EXPECT_EQ(laz.classification, las.classification);
  EXPECT_EQ(laz.origin_shift, las.origin_shift);
}

TEST(Laz, ReadsVersion14AndKeepsTheCoordinateSystem) {
  const auto path = shared_data("real/plots/MLS_Clip.laz");
  DENDROFIT_NEED(path);
  READ_LAZ_OR_SKIP(cloud, path);
  EXPECT_EQ(cloud.size(), 301477u);
  EXPECT_GT(cloud.origin_shift.x(), 100000);
  const PointCloud airborne = read_point_cloud(shared_data("real/plots/airborne_mixedconifer.laz"));
  EXPECT_EQ(airborne.size(), 37657u);
  EXPECT_EQ(airborne.crs_wkt, "EPSG:26912");
  EXPECT_EQ(read_point_cloud(shared_data("real/plots/pine_plot.laz")).size(), 114024u);
}

TEST(Laz, RefusesTruncatedAndLyingFiles) {
  const auto path = shared_data("real/pine/pine.laz");
  DENDROFIT_NEED(path);
  READ_LAZ_OR_SKIP(cloud, path);
  const TemporaryFolder folder;
  const std::string content = content_of(path);
  for (std::size_t k = 1; k < 10; ++k)
    EXPECT_THAT(refusal([&] {
                  read_point_cloud(folder.file("cut.laz", content.substr(0, content.size() * k / 10)));
                }),
                HasSubstr("cut.laz"));
  std::string lie = content;
  const std::uint32_t claimed = 100000000;
  std::memcpy(lie.data() + 107, &claimed, 4);
  EXPECT_THAT(refusal([&] { read_point_cloud(folder.file("lie.laz", lie)); }),
              HasSubstr("claims 100000000 points"));
}

TEST(Laz, SaysHowToInstallTheDecompressor) {
  const auto path = shared_data("real/pine/pine.laz");
  DENDROFIT_NEED(path);
  const char* before = std::getenv("PATH");
  const std::string saved = before ? before : "";
  ::setenv("PATH", "/nonexistent", 1);
  std::string message;
  try {
    read_point_cloud(path);
  } catch (const IoError& error) {
    message = error.what();
  }
  ::setenv("PATH", saved.c_str(), 1);
  if (message.empty()) GTEST_SKIP() << "LAZ is read natively here";
  EXPECT_THAT(message, HasSubstr("npm ci --prefix"));
}

TEST(E57, ReadsEveryKindOfField) {
  const TemporaryFolder folder;
  const PointCloud cloud = read_point_cloud(folder.file("a.e57", test::e57_file()));
  ASSERT_EQ(cloud.size(), 40u + 39u + 2u);
  const auto world = [&](std::size_t i) { return Vec3(cloud.points[i] + cloud.origin_shift); };
  EXPECT_EQ(world(39), Vec3(139.125, -19.5, 0.1 * 39));
  EXPECT_FLOAT_EQ(cloud.intensity[39], 0.39f);
  for (int k = 0; k < 39; ++k) {
    const int id = k < 7 ? k : k + 1;  // point 7 is invalid
    const Vec3 expected(15 + 0.001 * (id - 1000), 20 + 5.0 * id, 30 + id - 3e-8);
    EXPECT_LT((world(static_cast<std::size_t>(40 + k)) - expected).norm(), 1e-9) << id;
    EXPECT_FLOAT_EQ(cloud.intensity[static_cast<std::size_t>(40 + k)], 50000.0f * static_cast<float>(id));
  }
  EXPECT_LT((world(79) - Vec3(0, 2, 1)).norm(), 1e-6);
  EXPECT_LT((world(80) - Vec3(-2 * std::sqrt(3.0), 0, 3)).norm(), 1e-6);
  ASSERT_EQ(cloud.scanner_positions.size(), 2u);
  EXPECT_LT((cloud.scanner_positions[0] + cloud.origin_shift - Vec3(10, 20, 30)).norm(), 1e-9);
  EXPECT_EQ(cloud.crs_wkt, "LOCAL_CS[\"yard\"]");
}

TEST(E57, RefusesDamagedPagesAndClaims) {
  const TemporaryFolder folder;
  const std::string good = test::e57_file();
  std::string bad = good;
  bad[1500] ^= 4;
  EXPECT_THAT(refusal([&] { read_point_cloud(folder.file("a.e57", bad)); }),
              HasSubstr("byte 1024: the checksum"));
  EXPECT_THAT(refusal([&] { read_point_cloud(folder.file("a.e57", good.substr(0, 2000))); }),
              HasSubstr("truncated"));
  test::E57Sample sample;
  const std::vector<double> two = {1, 2};
  sample.add_scan(
      100000000,
      {test::E57Sample::reals("cartesianX", two, false), test::E57Sample::reals("cartesianY", two, false),
       test::E57Sample::reals("cartesianZ", two, false)},
      "", 100);
  EXPECT_THAT(refusal([&] { read_point_cloud(folder.file("a.e57", sample.file())); }),
              HasSubstr("claims 100000000 points, its data end after 2"));
}

TEST(E57, ChecksumIsTheCastagnoliOne) {
  EXPECT_EQ(crc32c("123456789", 9), 0xe3069283u);
}

}  // namespace
}  // namespace dendrofit
