// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/read_cloud.h"
#include "io/write_cloud.h"
#include "io/write_tree.h"
#include "tests/io/samples.h"
#include "tests/io/text_samples.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace dendrofit {
namespace {

using test::refusal;
using test::TemporaryFolder;
using testing::HasSubstr;

const Vec3 kUtm(500017.25, 5412345.5, 1234.125);

Vec3 world(const PointCloud& cloud, std::size_t i) {
  return cloud.points[i] + cloud.origin_shift;
}

class CloudFormats : public testing::TestWithParam<std::pair<const char*, double>> {};

TEST_P(CloudFormats, KeepPointsIntensityAndClass) {
  const TemporaryFolder folder;
  const auto [name, tolerance] = GetParam();
  for (const Vec3& shift : {Vec3(0, 0, 0), kUtm, Vec3(-1e6, 7e6, 0)}) {
    const PointCloud cloud = test::sample_cloud(300, shift);
    write_point_cloud(folder / name, cloud);
    const PointCloud back = read_point_cloud(folder / name);
    ASSERT_EQ(back.size(), cloud.size());
    EXPECT_EQ(back.intensity, cloud.intensity);
    EXPECT_EQ(back.classification, cloud.classification);
    EXPECT_LT(back.points[0].norm(), 200);
    for (std::size_t i = 0; i < cloud.size(); ++i)
      EXPECT_LE((world(back, i) - world(cloud, i)).cwiseAbs().maxCoeff(), tolerance);
  }
}

INSTANTIATE_TEST_SUITE_P(All, CloudFormats,
                         testing::Values(std::pair("a.las", 5.01e-6), std::pair("a.ply", 0.0),
                                         std::pair("a.pcd", 0.0), std::pair("a.xyz", 0.0),
                                         std::pair("a.csv", 0.0), std::pair("a.txt", 0.0),
                                         std::pair("a.asc", 0.0)));

TEST(Clouds, AShiftInTheFileIsAShiftInTheResultAndNothingElse) {
  const TemporaryFolder folder;
  const PointCloud near_cloud = test::sample_cloud(200);
  PointCloud far_cloud = near_cloud;
  far_cloud.origin_shift = Vec3(500000, 5400000, 300);
  write_point_cloud(folder / "near.las", near_cloud);
  write_point_cloud(folder / "far.las", far_cloud);
  const PointCloud a = read_point_cloud(folder / "near.las");
  const PointCloud b = read_point_cloud(folder / "far.las");
  EXPECT_EQ(b.origin_shift, far_cloud.origin_shift);
  for (std::size_t i = 0; i < a.size(); ++i) EXPECT_LT((a.points[i] - b.points[i]).norm(), 1e-8);
}

TEST(Las, KeepsTheCoordinateSystem) {
  const TemporaryFolder folder;
  PointCloud cloud = test::sample_cloud(20, kUtm);
  const std::string wkt = "PROJCRS[\"ETRS89 / UTM zone 32N\",ID[\"EPSG\",25832]]";
  for (const std::string& crs :
       {std::string("EPSG:25832"), std::string("EPSG:4258"), std::string("EPSG:25832+7837"),
        std::string("Local grid of the forest office"), wkt, std::string()}) {
    cloud.crs_wkt = crs;
    write_point_cloud(folder / "a.las", cloud);
    EXPECT_EQ(read_point_cloud(folder / "a.las").crs_wkt, crs);
  }
}

TEST(Las, KeepsClassesAbove31) {
  const TemporaryFolder folder;
  PointCloud cloud = test::sample_cloud(5);
  cloud.classification = {1, 2, 31, 64, 255};
  write_point_cloud(folder / "a.las", cloud);
  EXPECT_EQ(read_point_cloud(folder / "a.las").classification, cloud.classification);
}

// A LAS file of one point format, its header written field by field.
std::string las_file(int minor, int format, std::uint32_t claimed, std::uint32_t written) {
  const std::uint16_t lengths[] = {20, 28, 26, 34, 57, 63, 30, 36, 38, 59, 67};
  const std::uint16_t header_size = minor == 4 ? 375 : minor == 3 ? 235 : 227;
  std::string file(header_size, '\0');
  const auto put = [&](std::size_t at, auto value) { std::memcpy(file.data() + at, &value, sizeof(value)); };
  file.replace(0, 4, "LASF");
  put(24, std::uint8_t{1});
  put(25, static_cast<std::uint8_t>(minor));
  put(94, header_size);
  put(96, std::uint32_t{header_size});
  put(104, static_cast<std::uint8_t>(format));
  put(105, static_cast<std::uint16_t>(lengths[format] + 3));  // three extra bytes a point
  if (minor == 4)
    put(247, std::uint64_t{claimed});
  else
    put(107, claimed);
  for (std::size_t k = 0; k < 3; ++k) {
    put(131 + 8 * k, 0.001);
    put(155 + 8 * k, 1000.0 * static_cast<double>(k));
  }
  for (std::uint32_t i = 0; i < written; ++i) {
    std::string record(lengths[format] + 3u, '\x55');
    for (std::int32_t k = 0; k < 3; ++k) {
      const std::int32_t value = static_cast<std::int32_t>(i) * 10 - k;
      std::memcpy(record.data() + 4 * k, &value, 4);
    }
    const auto intensity = static_cast<std::uint16_t>(60000 + i);
    std::memcpy(record.data() + 12, &intensity, 2);
    record[format >= 6 ? 16 : 15] =
        static_cast<char>(format >= 6 ? 200 : 0xe0 + 5);  // old formats: flags in the high bits
    file += record;
  }
  return file;
}

TEST(Las, ReadsEveryVersionAndPointFormat) {
  const TemporaryFolder folder;
  for (int minor = 0; minor <= 4; ++minor) {
    for (int format = 0; format <= 10; ++format) {
      const PointCloud cloud = read_point_cloud(folder.file("a.las", las_file(minor, format, 3, 3)));
      ASSERT_EQ(cloud.size(), 3u);
      EXPECT_LT((world(cloud, 2) - Vec3(0.02, 1000.019, 2000.018)).norm(), 1e-9);
      EXPECT_EQ(cloud.intensity[2], 60002);
      EXPECT_EQ(cloud.classification[1], format >= 6 ? 200 : 5);
    }
  }
}

TEST(Las, RefusesClaimsTheFileDoesNotHold) {
  const TemporaryFolder folder;
  EXPECT_THAT(refusal([&] { read_point_cloud(folder.file("a.las", las_file(2, 3, 100000000, 3))); }),
              HasSubstr("claims 100000000 points, the file ends after 3"));
  EXPECT_THAT(refusal([&] { read_point_cloud(folder.file("a.las", las_file(4, 6, 0, 3))); }),
              HasSubstr("no points"));
  std::string scale = las_file(2, 0, 3, 3);
  scale.replace(131, 8, std::string(8, '\0'));
  EXPECT_THAT(refusal([&] { read_point_cloud(folder.file("a.las", scale)); }),
              HasSubstr("byte 131: scale 0"));
  std::string format = las_file(2, 0, 3, 3);
  format[104] = 11;
  EXPECT_THAT(refusal([&] { read_point_cloud(folder.file("a.las", format)); }),
              HasSubstr("byte 104: point format 11"));
  std::string version = las_file(2, 0, 3, 3);
  version[24] = 2;
  EXPECT_THAT(refusal([&] { read_point_cloud(folder.file("a.las", version)); }), HasSubstr("version 2.2"));
}

TEST(Ply, ReadsAsciiWithOtherElementsAndTypes) {
  const TemporaryFolder folder;
  const PointCloud cloud = read_point_cloud(folder.file("a.ply", test::ascii_ply()));
  ASSERT_EQ(cloud.size(), 4u);
  EXPECT_EQ(world(cloud, 1), Vec3(500001.25, -2.5, 4));
  EXPECT_THAT(cloud.intensity, testing::ElementsAre(10, 11, 12, 13.5f));
}

TEST(Ply, ReadsBigEndian) {
  const TemporaryFolder folder;
  const PointCloud cloud = read_point_cloud(folder.file("a.ply", test::big_endian_ply()));
  ASSERT_EQ(cloud.size(), 3u);
  EXPECT_EQ(world(cloud, 2).x(), 5400000.375);
  EXPECT_EQ(world(cloud, 1).y(), -2);
  EXPECT_THAT(cloud.classification, testing::ElementsAre(2, 3, 4));
}

TEST(Ply, RefusesCommasNaNAndClaims) {
  const TemporaryFolder folder;
  const std::string head =
      "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\nproperty float "
      "z\nend_header\n";
  EXPECT_THAT(refusal([&] { read_point_cloud(folder.file("a.ply", head + "1 2 3\n1,5 2 3\n")); }),
              HasSubstr("line 9: '1,5' found"));
  EXPECT_THAT(refusal([&] { read_point_cloud(folder.file("a.ply", head + "1 2 3\n1 nan 3\n")); }),
              HasSubstr("not a finite number"));
  EXPECT_THAT(refusal([&] { read_point_cloud(folder.file("a.ply", head + "1 2 3\n1 2\n")); }),
              HasSubstr("truncated"));
  EXPECT_THAT(refusal([&] {
                read_point_cloud(folder.file(
                    "a.ply",
                    "ply\nformat binary_little_endian 1.0\nelement vertex 100000000\nproperty float x\n"
                    "property float y\nproperty float z\nend_header\n" +
                        std::string(500, 'x')));
              }),
              HasSubstr("claims 100000000"));
  EXPECT_THAT(refusal([&] {
                read_point_cloud(folder.file("a.ply",
                                             "ply\nformat ascii 1.0\nelement vertex 1\nproperty float "
                                             "x\nproperty float y\nend_header\n1 2\n"));
              }),
              HasSubstr("no property 'z'"));
}

TEST(Pcd, ReadsAsciiAndLeavesOutWhatDidNotReturn) {
  const TemporaryFolder folder;
  const PointCloud cloud = read_point_cloud(folder.file("a.pcd", test::ascii_pcd()));
  ASSERT_EQ(cloud.size(), 3u);
  EXPECT_EQ(world(cloud, 1).x(), 500000.5);
  EXPECT_THAT(cloud.intensity, testing::ElementsAre(9, 8, 6));
}

TEST(Pcd, ReadsCompressed) {
  const TemporaryFolder folder;
  const PointCloud cloud = read_point_cloud(folder.file("a.pcd", test::packed_pcd()));
  ASSERT_EQ(cloud.size(), 3u);
  for (std::size_t i = 0; i < 3; ++i)
    EXPECT_EQ(world(cloud, i), Vec3(static_cast<double>(i + 1), 0, static_cast<double>(i + 1)));
}

TEST(Ptx, HonoursMatricesGridsAndScannerPlaces) {
  const TemporaryFolder folder;
  const PointCloud cloud = read_point_cloud(folder.file("a.ptx", test::ptx()));
  ASSERT_EQ(cloud.size(), 5u);  // one of six had no return
  EXPECT_LT((world(cloud, 0) - Vec3(1, 2, 3)).norm(), 1e-12);
  EXPECT_LT((world(cloud, 3) - Vec3(10, 21, 1)).norm(), 1e-12);  // x turned to y
  EXPECT_LT((world(cloud, 4) - Vec3(8, 20, 6)).norm(), 1e-12);   // y turned to -x
  ASSERT_EQ(cloud.scanner_positions.size(), 2u);
  EXPECT_LT((cloud.scanner_positions[1] + cloud.origin_shift - Vec3(10, 20, 1)).norm(), 1e-12);
  EXPECT_FLOAT_EQ(cloud.intensity[4], 0.125f);
}

struct TextCase {
  const char* name;
  std::string content;
};

class TextClouds : public testing::TestWithParam<TextCase> {};

// Each of these holds (500000.25, 1.5, 2.25), (500001.25, -1.5, 3.25) and (500002.25, 0, 4.25).
TEST_P(TextClouds, AreUnderstood) {
  const TemporaryFolder folder;
  const PointCloud cloud = read_point_cloud(folder.file("a.txt", GetParam().content));
  ASSERT_EQ(cloud.size(), 3u);
  EXPECT_EQ(world(cloud, 0), Vec3(500000.25, 1.5, 2.25));
  EXPECT_EQ(world(cloud, 1), Vec3(500001.25, -1.5, 3.25));
  EXPECT_EQ(world(cloud, 2), Vec3(500002.25, 0, 4.25));
}

INSTANTIATE_TEST_SUITE_P(
    All, TextClouds,
    testing::Values(
        TextCase{"blanks", "500000.25 1.5 2.25\n500001.25 -1.5 3.25\n500002.25 0 4.25\n"},
        TextCase{"no_last_line_end", "500000.25 1.5 2.25\n500001.25 -1.5 3.25\n500002.25 0 4.25"},
        TextCase{"blanks_around",
                 "  500000.25\t 1.5  2.25  \r\n\r\n 500001.25 -1.5 3.25\r\n500002.25 0 4.25\r\n\r\n"},
        TextCase{"commas", "500000.25,1.5,2.25\n500001.25,-1.5,3.25\n500002.25,0,4.25\n"},
        TextCase{"commas_and_blanks", "500000.25, 1.5, 2.25\n500001.25, -1.5, 3.25\n500002.25, 0, 4.25\n"},
        TextCase{"decimal_commas_semicolons", test::decimal_comma_text()},
        TextCase{"decimal_commas_tabs", "500000,25\t1,5\t2,25\n500001,25\t-1,5\t3,25\n500002,25\t0\t4,25\n"},
        TextCase{"header",
                 "\xef\xbb\xbf\"X\",\"Y\",\"Z\",\"R\"\n500000.25,1.5,2.25,9\n500001.25,-1.5,3.25,9\n500002."
                 "25,0,4.25,9\n"},
        TextCase{"other_order",
                 "id;Z;Northing [m];Easting "
                 "[m]\n1;2.25;1.5;500000.25\n2;3.25;-1.5;500001.25\n3;4.25;0;500002.25\n"},
        TextCase{"comment_header",
                 "//X Y Z Intensity\n# by hand\n500000.25 1.5 2.25 1\n500001.25 -1.5 3.25 2\n500002.25 0 "
                 "4.25 3\n"},
        TextCase{"exponents", "5.0000025e5 1.5e+0 225E-2\n+500001.25 -1.5 3.25\n500002.25 0e0 4.25\n"},
        TextCase{"count_first",
                 "3\n500000.25 1.5 2.25 0 1 2 3\n500001.25 -1.5 3.25 0 1 2 3\n500002.25 0 4.25 0 1 2 3\n"},
        TextCase{"quoted_numbers",
                 "x,y,z\n\"500000.25\",\"1.5\",\"2.25\"\n\"500001.25\",\"-1.5\",\"3.25\"\n\"500002.25\","
                 "\"0\",\"4.25\"\n"}),
    [](const auto& parameter) { return parameter.param.name; });

TEST(TextCloud, ReadsIntensityAndClassByName) {
  const TemporaryFolder folder;
  const PointCloud cloud =
      read_point_cloud(folder.file("a.csv", "class,x,y,z,Intensity\n2,1,2,3,0.5\n5,1,2,4,0.75\n"));
  EXPECT_THAT(cloud.intensity, testing::ElementsAre(0.5f, 0.75f));
  EXPECT_THAT(cloud.classification, testing::ElementsAre(2, 5));
}

TEST(TextCloud, FollowsWhatItIsTold) {
  const TemporaryFolder folder;
  const auto path = folder.file("a.csv", "1,5,2,5,3,5\n1,25,2,5,3,5\n");
  EXPECT_THAT(refusal([&] { read_point_cloud(path); }), HasSubstr("cannot be told"));
  const PointCloud cloud = read_point_cloud(path, {.delimiter = ',', .columns = "z,-,x,-,y,-"});
  EXPECT_EQ(world(cloud, 1), Vec3(2, 3, 1));
  EXPECT_THAT(refusal([&] { read_point_cloud(path, {.columns = "x,y"}); }),
              HasSubstr("expected a list with x, y and z"));
  EXPECT_THROW(read_point_cloud(path, {.delimiter = '|'}), InputError);
}

TEST(TextCloud, RefusesTreeModels) {
  const TemporaryFolder folder;
  const std::filesystem::path path = folder / "model.txt";
  for (const TreeFormat format :
       {TreeFormat::ours, TreeFormat::treeqsm_text, TreeFormat::treefile, TreeFormat::simpleforest_csv,
        TreeFormat::archi_csv, TreeFormat::arbor_csv}) {
    write_tree(path, test::sample_tree(), format);
    EXPECT_THAT(refusal([&] { read_point_cloud(path); }),
                HasSubstr("is a tree model (" + std::string(to_string(format)) + "), not a point cloud"));
  }
  // Points with a normal and much else stay points, and so does whatever the user names columns of.
  std::string points;
  for (int i = 0; i < 3; ++i) points += "1 2 3 4 5 0 0 1 0.5 7 8 9 10 11 12\n";
  EXPECT_EQ(read_point_cloud(folder.file("normals.xyz", points)).size(), 3U);
  EXPECT_EQ(read_point_cloud(folder.file("ends.csv", "x,y,z,radius,parent_id\n1,2,3,4,5\n"),
                             {.columns = "x,y,z,-,-"})
                .size(),
            1U);
}

TEST(TextCloud, RefusesWithLineAndColumn) {
  const TemporaryFolder folder;
  const auto complaint = [&](const std::string& content) {
    return refusal([&] { read_point_cloud(folder.file("a.xyz", content)); });
  };
  EXPECT_THAT(complaint("1 2 3\n1 2 x\n"), HasSubstr("line 2: column 3: 'x' found, a number expected"));
  EXPECT_THAT(complaint("1 2 3\n1 2\n"), HasSubstr("line 2: 2 columns; the first line has 3"));
  EXPECT_THAT(complaint("1 2 3\n1 2 3 4\n"), HasSubstr("line 2: more than the 3 columns"));
  EXPECT_THAT(complaint("1 2 3\n1 nan 3\n"), HasSubstr("line 2: a coordinate that is not a finite number"));
  EXPECT_THAT(complaint("1 2 3\n1 1e999 3\n"), HasSubstr("line 2"));
  EXPECT_THAT(complaint("1 2\n3 4\n"), HasSubstr("2 columns; expected x, y and z"));
  EXPECT_THAT(complaint("x,y,height_of_tree\n1,2,3\n"), HasSubstr("names no columns x, y and z"));
  EXPECT_THAT(complaint("x,y,z\n1,5,2,5,3,5\n"), HasSubstr("6 fields; the header names 3"));
  EXPECT_THAT(complaint("1,5 2.5 3,5\n"), HasSubstr("line 1"));
  EXPECT_THAT(complaint("100000000\n1 2 3\n"), HasSubstr("says it holds 100000000 points, 1 are there"));
  EXPECT_THAT(complaint("1 2 2000000000\n"), HasSubstr("beyond 1e9 m"));
  EXPECT_THAT(complaint(std::string("\xff\xfe"
                                    "1\0 \0",
                                    6)),
              HasSubstr("UTF-16"));
}

TEST(Clouds, WritersRefuseWhatTheyCannotWrite) {
  const TemporaryFolder folder;
  EXPECT_THAT(refusal([&] { write_point_cloud(folder / "a.doc", test::sample_cloud(3)); }),
              HasSubstr("'.doc'"));
  EXPECT_THROW(write_point_cloud(folder / "a.las", PointCloud{}), InputError);
  PointCloud cloud = test::sample_cloud(3);
  cloud.points[1].x() = std::nan("");
  EXPECT_THROW(write_point_cloud(folder / "a.las", cloud), InputError);
  EXPECT_THROW(write_point_cloud(folder / "no" / "folder" / "a.las", test::sample_cloud(3)), IoError);
  EXPECT_FALSE(std::filesystem::exists(folder / "a.las"));
}

}  // namespace
}  // namespace dendrofit
