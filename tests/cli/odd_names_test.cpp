// SPDX-License-Identifier: GPL-3.0-or-later
// Names that are no UTF-8, through every command with --json: the object stays JSON, nothing is thrown for
// it.
#include "io/file_info.h"
#include "io/read_cloud.h"
#include "io/write_cloud.h"
#include "tests/cli/run_program.h"

#include <fstream>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace dendrofit {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using test::Outcome;
using test::run_program;

/// A shell word.
std::string word(const fs::path& path) {
  return "'" + path.string() + "'";
}

json object_of(const std::string& arguments, int code) {
  const Outcome out = run_program(arguments + " --json --progress none");
  EXPECT_EQ(out.code, code) << arguments << "\n" << out.err;
  const json object = json::parse(out.out, nullptr, false);
  EXPECT_FALSE(object.is_discarded()) << arguments << "\n" << out.out;
  return object;
}

const std::string kOdd = "B\xe4um \xff<\"&";  // Latin-1, a byte of no text, and what pages and shells mind

TEST(OddNames, every_command_still_prints_one_json_object) {
  const test::ScratchFolder scratch;
  const fs::path scan = scratch / (kOdd + ".las"), tree = scratch / (kOdd + "_grown");
  const fs::path qsm = tree / "qsm.csv";
  object_of("grow standard --cycles 6 -o " + word(tree), 0);
  object_of("scan " + word(qsm) + " --stations 1 --step 0.3 --ground 0 -o " + word(scan), 0);
  object_of("info " + word(scan), 0);
  object_of("info " + word(scratch / (kOdd + ".absent")), 3);
  object_of("convert " + word(scan) + " " + word(scratch / (kOdd + ".ply")), 0);
  object_of("leaves " + word(qsm) + " --count 5 -o " + word(scratch / (kOdd + "_leaves")), 0);
  object_of("view " + word(tree) + " --html " + word(scratch / (kOdd + ".html")), 0);
  object_of("fit " + word(qsm) + " --budget 4 -o " + word(scratch / (kOdd + "_fit")), 0);
  const fs::path table = scratch / (kOdd + ".csv");
  std::ofstream(table) << "series,time,value\n"
                       << kOdd.substr(0, 4) << ",1,1\n"
                       << kOdd.substr(0, 4) << ",2,2\n";
  object_of("growth " + word(table), 4);
}

TEST(OddNames, the_coordinate_system_reaches_every_result_whatever_its_bytes) {
  const test::ScratchFolder scratch;
  const fs::path scan = scratch / (kOdd + ".las"), folder = scratch / kOdd;
  for (const std::string& crs : {std::string("EPSG:25832+7837"), "LOCAL_CS[\"" + kOdd + "\"]"}) {
    PointCloud cloud = read_point_cloud(test::sample_file("young_tree.las"));
    cloud.crs_wkt = crs;
    write_point_cloud(scan, cloud);
    object_of("reconstruct --force --voxel 3cm " + word(scan) + " -o " + word(folder), 0);
    for (const auto& [name, content] : test::files_in(folder))
      if (name.ends_with(".json")) {
        EXPECT_TRUE(json::accept(content)) << name;
      }
    const std::string kept = json::parse(test::content_of(folder / "metrics.json")).at("crs");
    if (crs.starts_with("EPSG")) {
      EXPECT_EQ(kept, crs);
    }
    EXPECT_EQ(object_of("info " + word(folder / "qsm.csv"), 0).at("crs"), kept);
    const std::string model = word(folder / "qsm.csv");
    object_of(
        "scan --force " + model + " --stations 1 --step 0.3 --ground 0 -o " + word(scratch / "again.las"), 0);
    EXPECT_EQ(describe_file(scratch / "again.las").crs_wkt, kept);
    const json lost = object_of("convert --force " + model + " " + word(scratch / "a.txt"), 0).at("lost");
    EXPECT_NE(lost.dump().find("coordinate system"), std::string::npos) << lost;
  }
}

}  // namespace
}  // namespace dendrofit
