// SPDX-License-Identifier: GPL-3.0-or-later
// LAS and LAZ to each other: nothing may get lost, though our own clouds do not hold everything.
#include "io/file_info.h"
#include "io/las_format.h"
#include "io/read_cloud.h"
#include "io/write_cloud.h"
#include "tests/io/samples.h"
#include "tests/support/shared_data.h"

#include <cstring>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace dendrofit {
namespace {

using test::content_of;
using test::refusal;
using test::shared_data;
using test::TemporaryFolder;
using testing::HasSubstr;

template <class Number>
void poke(std::string& bytes, std::size_t at, Number value) {
  std::memcpy(bytes.data() + at, &value, sizeof(value));
}

// A file with attributes that our clouds do not hold: returns, angle, user data, source.
std::string rich_las(const TemporaryFolder& folder, const std::string& crs) {
  PointCloud cloud = test::sample_cloud(200, {500000, 5400000, 300});
  cloud.crs_wkt = crs;
  write_point_cloud(folder / "made.las", cloud);
  std::string bytes = content_of(folder / "made.las");
  const LasHeader h = read_las_header(FileBytes(folder / "made.las"));
  for (std::size_t i = 0; i < h.point_count; ++i)
    for (std::size_t k = 16; k < 20; ++k)
      if (h.point_format == 0)
        bytes[h.points_offset + i * h.record_length + k] = static_cast<char>(7 * i + k);
  for (std::size_t k = 0; k < 3; ++k) poke(bytes, 131 + 8 * k, 0.00025);  // an unusual step
  return bytes;
}

TEST(LasCopy, LasToLasIsTheSameFile) {
  for (const std::string crs : {"", "EPSG:25832", "PROJCS[\"local\"]"}) {
    const TemporaryFolder folder;
    const std::string bytes = rich_las(folder, crs);
    copy_las(folder.file("in.las", bytes), folder / "out.las", Vec3::Zero(), no_progress());
    EXPECT_EQ(content_of(folder / "out.las") == bytes, true) << crs;
  }
}

TEST(LasCopy, ShiftMovesOffsetAndBoundsAndNoRecord) {
  const TemporaryFolder folder;
  const std::string bytes = rich_las(folder, "EPSG:25832");
  const Vec3 shift(-500000, -5400000, 12.5);
  copy_las(folder.file("in.las", bytes), folder / "out.las", shift, no_progress());
  const LasHeader a = read_las_header(FileBytes(folder / "in.las")),
                  b = read_las_header(FileBytes(folder / "out.las"));
  EXPECT_EQ(content_of(folder / "out.las").substr(227), bytes.substr(227));
  for (int k = 0; k < 3; ++k) {
    EXPECT_EQ(b.offset[k], a.offset[k] + shift[k]);
    EXPECT_EQ(b.scale[k], 0.00025);
  }
  const FileInfo before = describe_file(folder / "in.las"), after = describe_file(folder / "out.las");
  EXPECT_LT((after.bounds.lo - before.bounds.lo - shift).norm(), 1e-8);
  EXPECT_EQ(after.crs_wkt, "EPSG:25832");
}

TEST(LasCopy, ExtendedRecordsComeAlong) {
  const TemporaryFolder folder;
  std::string bytes = rich_las(folder, "PROJCS[\"local\"]");
  poke(bytes, 235, static_cast<std::uint64_t>(bytes.size()));
  poke(bytes, 243, std::uint32_t{1});
  std::string record(60, '\0');
  std::memcpy(record.data() + 2, "somebody", 8);
  poke(record, 20, std::uint64_t{5});
  bytes += record + "hello";
  copy_las(folder.file("in.las", bytes), folder / "out.las", Vec3::Zero(), no_progress());
  EXPECT_EQ(content_of(folder / "out.las") == bytes, true);
  EXPECT_THAT(refusal([&] {
                copy_las(folder.file("cut.las", bytes.substr(0, bytes.size() - 3)), folder / "b.las",
                         Vec3::Zero(), no_progress());
              }),
              HasSubstr("cut.las"));
  EXPECT_FALSE(std::filesystem::exists(folder / "b.las"));
}

TEST(LasCopy, LazToLasGivesTheRecordsOfTheSameLas) {
  const auto path = shared_data("real/pine/pine.laz");
  DENDROFIT_NEED(path);
  const TemporaryFolder folder;
  try {
    copy_las(path, folder / "pine.las", Vec3::Zero(), no_progress());
  } catch (const IoError& error) {
    if (std::string(error.what()).find("not installed") == std::string::npos) throw;
    GTEST_SKIP() << error.what();
  }
  const auto points = [](const std::filesystem::path& file) {
    const FileBytes bytes(file);
    const LasHeader h = read_las_header(bytes);
    return std::string(bytes.view().substr(h.points_offset, h.point_count * h.record_length));
  };
  EXPECT_EQ(points(folder / "pine.las") == points(shared_data("real/pine/pine.las")), true);
  EXPECT_EQ(describe_file(folder / "pine.las").format, "las");
}

TEST(LasCopy, LazIsWrittenWithoutALossOrRefusedWithTheReason) {
  const TemporaryFolder folder;
  const PointCloud cloud = test::sample_cloud(50);
  if (!can_write_laz()) {
    const std::string why = refusal([&] { write_point_cloud(folder / "a.laz", cloud); });
    EXPECT_THAT(why,
                testing::AllOf(HasSubstr("LASzip"), HasSubstr("write .las"), HasSubstr("liblaszip-dev")));
    EXPECT_FALSE(std::filesystem::exists(folder / "a.laz"));
    return;
  }
  for (const std::string crs : {"EPSG:25832", "PROJCS[\"local\"]"}) {
    const std::string bytes = rich_las(folder, crs);
    copy_las(folder.file("in.las", bytes), folder / "a.laz", Vec3::Zero(), no_progress());
    EXPECT_EQ(describe_file(folder / "a.laz").format, "laz");
    EXPECT_EQ(read_point_cloud(folder / "a.laz").points, read_point_cloud(folder / "in.las").points);
    copy_las(folder / "a.laz", folder / "back.las", Vec3::Zero(), no_progress());
    const LasHeader h = read_las_header(FileBytes(folder / "in.las"));
    const LasHeader back = read_las_header(FileBytes(folder / "back.las"));
    EXPECT_EQ(content_of(folder / "back.las").substr(back.points_offset) == bytes.substr(h.points_offset),
              true);
    EXPECT_EQ(back.crs_wkt, crs);
  }
  write_point_cloud(folder / "b.laz", cloud);
  EXPECT_EQ(read_point_cloud(folder / "b.laz").size(), cloud.size());
  std::size_t files = 0;
  for ([[maybe_unused]] const auto& entry : std::filesystem::directory_iterator(folder / "")) ++files;
  EXPECT_EQ(files, 5u);  // made, in, a, back, b: nothing temporary is left
}

TEST(WriteLas, KeepsTheFrameItIsGiven) {
  const TemporaryFolder folder;
  const PointCloud cloud = test::sample_cloud(50, {500000, 5400000, 300});
  LasFrame frame;
  frame.step = Vec3(0.001, 0.002, 0.004);
  frame.offset = Vec3(499000, 5399000, -7);
  frame.projection = {{34735, std::string(24, '\1')}, {34737, "a name|"}};
  write_point_cloud(folder / "a.las", cloud, {frame});
  const FileInfo info = describe_file(folder / "a.las");
  ASSERT_TRUE(info.frame);
  EXPECT_EQ(info.frame->step, frame.step);
  EXPECT_EQ(info.frame->offset, frame.offset);
  EXPECT_EQ(info.frame->projection, frame.projection);
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const Vec3 off = info.cloud->points[i] + info.cloud->origin_shift - cloud.points[i] - cloud.origin_shift;
    EXPECT_LE((off.cwiseAbs() - 0.5 * frame.step).maxCoeff(), 1e-9);
  }
  frame.step = Vec3::Constant(1e-9);  // too fine for 32 bits: one of our own instead
  write_point_cloud(folder / "b.las", cloud, {frame});
  EXPECT_EQ(describe_file(folder / "b.las").frame->step, Vec3::Constant(1e-5));
}

}  // namespace
}  // namespace dendrofit
