// SPDX-License-Identifier: GPL-3.0-or-later
// More than 200 systematic corruptions of each format: bytes cut off, turned over, and put in place of
// others. A reader may read what is left or refuse it with an IoError that names the file; nothing else, and
// never with much memory.
#include "io/birth_cycles.h"
#include "io/file_info.h"
#include "io/metrics_json.h"
#include "io/read_cameras.h"
#include "io/read_cloud.h"
#include "io/read_foliage.h"
#include "io/read_mesh.h"
#include "io/read_table.h"
#include "io/read_tree.h"
#include "io/toml.h"
#include "io/write_cloud.h"
#include "io/write_mesh.h"
#include "io/write_tree.h"
#include "tests/io/allocations.h"
#include "tests/io/e57_sample.h"
#include "tests/io/samples.h"
#include "tests/io/text_samples.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace dendrofit {
namespace {

using test::content_of;
using test::TemporaryFolder;

void read_cloud_checked(const std::filesystem::path& path) {
  read_point_cloud(path).validate();
}
void read_tree_checked(const std::filesystem::path& path) {
  read_tree(path).validate();
}
void read_mesh_checked(const std::filesystem::path& path) {
  read_mesh(path).validate();
}
void read_table_checked(const std::filesystem::path& path) {
  for (const MeasurementSeries& s : read_measurements(path)) {
    ASSERT_EQ(s.time.size(), s.value.size());
    for (std::size_t i = 0; i < s.time.size(); ++i)
      ASSERT_TRUE(std::isfinite(s.time[i]) && std::isfinite(s.value[i]));
  }
}

struct Format {
  std::string name;
  std::function<void(const std::filesystem::path&)> write;
  void (*read)(const std::filesystem::path&);
  bool binary;  ///< then every truncation must be refused
};

std::function<void(const std::filesystem::path&)> text(const std::string& content) {
  return [content](const std::filesystem::path& path) { std::ofstream(path, std::ios::binary) << content; };
}

std::function<void(const std::filesystem::path&)> cloud_with_crs(const std::string& crs) {
  return [crs](const std::filesystem::path& path) {
    PointCloud cloud = test::sample_cloud(50, {500000, 5400000, 300});
    cloud.crs_wkt = crs;
    write_point_cloud(path, cloud);
  };
}

std::function<void(const std::filesystem::path&)> tree_as(TreeFormat format) {
  return [format](const std::filesystem::path& path) { write_tree(path, test::sample_tree(), format); };
}

const std::string kCameras = R"({"format": "dendrofit-cameras", "version": 1, "units": "m", "up": [0, 0, 1],
 "pixel_origin": "corner", "cameras": [{"id": 0, "model": "radial2", "width": 80, "height": 60, "fx": 90,
 "fy": 90, "cx": 40, "cy": 30}], "images": [{"file": "a.jpg", "camera": 0, "camera_from_world":
 [[1, 0, 0, 0], [0, 0, -1, 1], [0, 1, 0, 10]]}]})";

std::vector<Format> formats() {
  const auto cloud = [](const std::filesystem::path& path) { write_point_cloud(path, test::sample_cloud()); };
  return {
      {"old.las", cloud_with_crs("EPSG:25832"), read_cloud_checked, true},
      {"new.las", cloud_with_crs("PROJCS[\"local\"]"), read_cloud_checked, true},
      {"cloud.ply", cloud, read_cloud_checked, true},
      {"big_endian.ply", text(test::big_endian_ply()), read_cloud_checked, true},
      {"ascii.ply", text(test::ascii_ply()), read_cloud_checked, false},
      {"cloud.pcd", cloud, read_cloud_checked, true},
      {"ascii.pcd", text(test::ascii_pcd()), read_cloud_checked, false},
      {"packed.pcd", text(test::packed_pcd()), read_cloud_checked, true},
      {"cloud.e57", text(test::e57_file()), read_cloud_checked, true},
      {"cloud.ptx", text(test::ptx()), read_cloud_checked, false},
      {"cloud.pts", text(test::pts()), read_cloud_checked, false},
      {"cloud.xyz", cloud, read_cloud_checked, false},
      {"cloud.csv", cloud, read_cloud_checked, false},
      {"comma.txt", text(test::decimal_comma_text()), read_cloud_checked, false},
      {"qsm.csv", tree_as(TreeFormat::ours), read_tree_checked, false},
      {"treeqsm.txt", tree_as(TreeFormat::treeqsm_text), read_tree_checked, false},
      {"treeqsm.mat", tree_as(TreeFormat::treeqsm_mat), read_tree_checked, true},
      {"treefile.txt", tree_as(TreeFormat::treefile), read_tree_checked, false},
      {"simpleforest.csv", tree_as(TreeFormat::simpleforest_csv), read_tree_checked, false},
      {"archi.csv", tree_as(TreeFormat::archi_csv), read_tree_checked, false},
      {"arbor.csv", tree_as(TreeFormat::arbor_csv), read_tree_checked, false},
      {"tree.obj", [](const auto& path) { write_tree_obj(path, test::sample_tree()); }, read_mesh_checked,
       false},
      {"tree.ply", [](const auto& path) { write_tree_ply(path, test::sample_tree()); }, read_mesh_checked,
       true},
      {"leaves.glb", [](const auto& path) { write_foliage_glb(path, test::sample_foliage()); },
       [](const auto& path) { ASSERT_GT(read_foliage_glb(path).size(), 0U); }, true},
      {"birth_cycles.csv", text("id,birth_cycle\n1,-1\n2,0\n3,1\n4,2\n5,2\n6,3\n7,3\n"),
       [](const auto& path) {
         Tree tree = test::sample_tree();
         read_birth_cycles(path, tree);
       },
       false},
      {"tree.glb", [](const auto& path) { write_tree_glb(path, test::sample_tree()); },
       [](const auto& path) { describe_file(path); }, true},
      {"heights.csv", text("series,time,value\na,1,2.5\na,2,NA\nb,1,3\nb,2.5,4e1\n"), read_table_checked,
       false},
      {"metrics.json", [](const auto& path) { write_metrics(path, measure(test::sample_tree())); },
       [](const auto& path) { metrics_from_json(path); }, false},
      {"cameras.json", text(kCameras),
       [](const auto& path) {
         try {
           read_cameras_json(path, {.load_photos = false});
         } catch (const InputError& error) {  // names the file and the field
           ASSERT_THAT(error.what(), testing::StartsWith(path.filename().string()));
           throw IoError(path.parent_path().string() + "/" + error.what());
         }
       },
       false},
      {"run.toml", text("a = 1\nb = 2.5\n[t]\nc = \"x\"\nd = [1, 2.5]\n[[u]]\ne = true\n[[u]]\ne = false\n"),
       [](const auto& path) { read_toml(path); }, false},
  };
}

std::string name_of(const testing::TestParamInfo<Format>& parameter) {
  std::string name = parameter.param.name;
  for (char& c : name)
    if (c == '.') c = '_';
  return name;
}

void PrintTo(const Format& format, std::ostream* out) {
  *out << format.name;
}

class Corruption : public testing::TestWithParam<Format> {
 protected:
  void SetUp() override {
    good_ = folder_ / GetParam().name;
    GetParam().write(good_);
    content_ = content_of(good_);
    ASSERT_FALSE(content_.empty());
    GetParam().read(good_);  // sound to begin with
    test::forget_allocations();
  }

  /// True when it was read, false when it was refused.
  bool try_read(const std::string& content, const std::string& what) {
    SCOPED_TRACE(what);
    ++tried_;
    const auto path = folder_.file("bad_" + GetParam().name, content);
    try {
      GetParam().read(path);
      return true;
    } catch (const IoError& error) {
      EXPECT_THAT(error.what(), testing::StartsWith(path.string()));
      EXPECT_GT(std::string(error.what()).size(), path.string().size() + 10);
    } catch (const std::exception& error) {
      ADD_FAILURE() << "another exception: " << error.what();
    }
    return false;
  }

  void TearDown() override {
    EXPECT_GE(tried_, 200);
    EXPECT_LT(test::largest_allocation(), 64u << 20) << "bytes asked for at once";
  }

  TemporaryFolder folder_;
  std::filesystem::path good_;
  std::string content_;
  int tried_ = 0;
};

TEST_P(Corruption, EndsInAResultOrARefusal) {
  const std::size_t n = content_.size();
  for (std::size_t k = 0; k < 80; ++k) {
    const std::size_t keep = n * k / 80;
    const bool read = try_read(content_.substr(0, keep), "cut after " + std::to_string(keep) + " bytes");
    EXPECT_FALSE(read && GetParam().binary) << "cut after " << keep << " of " << n;
  }
  // Headers are where lies do harm: half of the places lie in the first 400 bytes.
  const auto place = [&](std::size_t k, std::size_t count) {
    return k % 2 ? std::min<std::size_t>(n, 400) * k / count : n * k / count;
  };
  for (std::size_t k = 0; k < 60; ++k) {
    std::string bad = content_;
    bad[place(k, 60)] ^= static_cast<char>(1 << (k % 8));
    try_read(bad, "bit turned at byte " + std::to_string(place(k, 60)));
  }
  const std::vector<std::string> lies = {std::string(4, '\xff'),
                                         std::string(8, '\0'),
                                         "\xff\xff\xff\x7f",
                                         "99999999",
                                         "-",
                                         ",",
                                         "nan",
                                         "1e309",
                                         "\n",
                                         "\"",
                                         "[[",
                                         "100000000000"};
  for (std::size_t k = 0; k < 10 * lies.size(); ++k) {
    const std::string& lie = lies[k % lies.size()];
    const std::size_t at = place(k, 10 * lies.size());
    std::string bad = content_;
    bad.replace(at, std::min(lie.size(), n - at), lie);
    try_read(bad, "'" + lie + "' at byte " + std::to_string(at));
  }
}

INSTANTIATE_TEST_SUITE_P(Formats, Corruption, testing::ValuesIn(formats()), name_of);

class EveryReader : public testing::TestWithParam<Format> {};

TEST_P(EveryReader, RefusesWhatIsNoFile) {
  const TemporaryFolder folder;
  const Format& format = GetParam();
  EXPECT_THAT(test::refusal([&] { format.read(folder / "absent"); }), testing::HasSubstr("no such file"));
  EXPECT_THAT(test::refusal([&] { format.read(folder / ""); }), testing::HasSubstr("folder"));
  EXPECT_THAT(test::refusal([&] { format.read(folder.file("empty", "")); }), testing::HasSubstr("empty"));
  if (format.name == "run.toml") return;
  for (const char* junk : {"\x7f"
                           "ELF\2\1\1",
                           "PK\3\4", "hello world\n", "\xff\xd8\xff\xe0", "\n\n\n", "a,b,c\n1,2,3\n"})
    EXPECT_THAT(test::refusal([&] { format.read(folder.file("junk", junk)); }), testing::HasSubstr("junk"));
}

INSTANTIATE_TEST_SUITE_P(Formats, EveryReader, testing::ValuesIn(formats()), name_of);

}  // namespace
}  // namespace dendrofit
