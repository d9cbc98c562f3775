// SPDX-License-Identifier: GPL-3.0-or-later
// Tables, metrics, TOML, and numbers as text.
#include "io/file_info.h"
#include "io/metrics_json.h"
#include "io/read_table.h"
#include "io/text_numbers.h"
#include "io/toml.h"
#include "io/write_cloud.h"
#include "io/write_mesh.h"
#include "io/write_tree.h"
#include "tests/io/samples.h"

#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace dendrofit {
namespace {

using test::content_of;
using test::refusal;
using test::TemporaryFolder;
using testing::HasSubstr;

const Vec3 kUtm(500000, 5412300, 1200);

TEST(TextNumbers, ParseAsTheLibraryDoesBitForBit) {
  Random random(11);
  for (int i = 0; i < 200000; ++i) {
    const auto bits = random.bits();
    double value = 0;
    std::memcpy(&value, &bits, 8);
    if (i % 2) value = random.uniform(-1e6, 1e6);
    if (!std::isfinite(value)) continue;
    char text[64];
    std::snprintf(text, sizeof(text), i % 3 ? "%.17g" : "%.9f", value);
    if (std::abs(value) > 1e40) continue;
    double parsed = 0;
    ASSERT_TRUE(number_from(text, parsed)) << text;
    ASSERT_EQ(parsed, std::strtod(text, nullptr)) << text;
  }
}

TEST(TextNumbers, PrintWhatReadsBackBitForBit) {
  Random random(12);
  for (int i = 0; i < 100000; ++i) {
    const auto bits = random.bits();
    double value = 0;
    std::memcpy(&value, &bits, 8);
    if (!std::isfinite(value)) continue;
    std::string text;
    append_number(text, value);
    double parsed = 0;
    ASSERT_TRUE(number_from(text, parsed)) << text;
    ASSERT_EQ(parsed, value) << text;
  }
}

TEST(TextNumbers, RefuseWhatIsNone) {
  double value = 0;
  for (const char* text :
       {"", " ", "-", "+", ".", "e5", "1.2.3", "1,2", "0x10", "--1", "+-1", "1e", "1 2", "abc"})
    EXPECT_FALSE(number_from(text, value)) << text;
  EXPECT_TRUE(number_from(" +1.5\r", value));
  EXPECT_TRUE(number_from(".5", value));
  EXPECT_TRUE(number_from("5.", value));
  EXPECT_TRUE(number_from("1,5", value, ','));
  EXPECT_DOUBLE_EQ(value, 1.5);
  EXPECT_FALSE(number_from("1.5", value, ','));
}

TEST(Metrics, ReadBackAsWritten) {
  const TemporaryFolder folder;
  TreeMetrics metrics = measure(test::sample_tree());
  metrics.intervals["dbh_m"] = {0.2, 0.1, 0.3};
  metrics.crown_base_m.reset();
  metrics.dbh_coverage = 0.75;
  metrics.dbh_ellipse_m = {0.21, 0.19};
  metrics.leaf_profile = {{1, 1.5, 7}};
  write_metrics(folder / "m.json", metrics);
  const TreeMetrics back = metrics_from_json(folder / "m.json");
  EXPECT_EQ(metrics_to_json(back), metrics_to_json(metrics));
  EXPECT_EQ(back.height_m, metrics.height_m);
  EXPECT_EQ(back.dbh_m, metrics.dbh_m);
  EXPECT_FALSE(back.crown_base_m.has_value());
  EXPECT_EQ(back.intervals.at("dbh_m").hi, 0.3);
  ASSERT_EQ(back.leaf_profile.size(), 1u);
  EXPECT_EQ(back.leaf_profile.front().points, 7u);
  const auto json = nlohmann::json::parse(content_of(folder / "m.json"));
  for (const char* key : {"height_m",
                          "dbh_m",
                          "dbh_height_m",
                          "stem_volume_m3",
                          "branch_volume_m3",
                          "total_volume_m3",
                          "crown_base_m",
                          "crown_diameter_m",
                          "crown_area_m2",
                          "crown_volume_m3",
                          "lean_deg",
                          "branch_count_by_order",
                          "length_by_order_m",
                          "volume_by_order_m3",
                          "stem_taper",
                          "intervals",
                          "dbh_coverage",
                          "lean_azimuth_deg",
                          "branch_angle_by_order_deg",
                          "leaf_profile"})
    EXPECT_TRUE(json.contains(key)) << key;
  EXPECT_TRUE(json["crown_base_m"].is_null());
  EXPECT_EQ(json["stem_taper"][0].size(), 2u);
}

TEST(Metrics, RefuseWhatIsNoMetricsFile) {
  const TemporaryFolder folder;
  for (const char* count : {"2.3e26", "-1", "0.5", "4000000000", "\"1\""})
    EXPECT_THAT(
        refusal([&] {
          metrics_from_json(folder.file(
              "m.json", std::string("{\"height_m\": 1, \"branch_count_by_order\": [") + count + "]}"));
        }),
        HasSubstr("branch_count_by_order"))
        << count;
  EXPECT_THAT(refusal([&] { metrics_from_json(folder.file("m.json", "{\"height_m\": }")); }),
              HasSubstr("byte 14"));
  EXPECT_THAT(refusal([&] { metrics_from_json(folder.file("m.json", "{\"dbh_m\": 1}")); }),
              HasSubstr("height_m"));
  EXPECT_THAT(refusal([&] { metrics_from_json(folder.file("m.json", "{\"height_m\": \"tall\"}")); }),
              HasSubstr("key 'height_m'"));
}

TEST(Table, ReadsSeriesInOrderWithMissingValues) {
  const TemporaryFolder folder;
  const auto all = read_measurements(
      folder.file("t.csv",
                  "\xef\xbb\xbf"
                  "Series,time,extra,VALUE\r\nb,1,x,2.5\r\na,1,x,NA\r\nb,2,x,\r\n\r\na,3,x,4e0\r\n"));
  ASSERT_EQ(all.size(), 2u);
  EXPECT_EQ(all[0].name, "b");
  EXPECT_THAT(all[0].time, testing::ElementsAre(1));
  EXPECT_THAT(all[1].time, testing::ElementsAre(3));
  EXPECT_THAT(all[1].value, testing::ElementsAre(4));
}

TEST(Table, ReadsOneSeriesAndDecimalCommas) {
  const TemporaryFolder folder;
  for (const char* text :
       {"time;value\n1,5;2,5\n2;3\n", "time\tvalue\n1,5\t2,5\n2\t3\n", "time value\n1.5 2.5\n2 3\n"}) {
    const auto all = read_measurements(folder.file("t.csv", text));
    ASSERT_EQ(all.size(), 1u);
    EXPECT_THAT(all[0].time, testing::ElementsAre(1.5, 2));
    EXPECT_THAT(all[0].value, testing::ElementsAre(2.5, 3));
  }
  const auto named = read_measurements(folder.file("t.csv", "age,height\n1,2\n"),
                                       {.time_column = "age", .value_column = "height"});
  EXPECT_THAT(named[0].value, testing::ElementsAre(2));
}

TEST(Table, RefusesWithLineAndColumn) {
  const TemporaryFolder folder;
  const auto complaint = [&](const std::string& text) {
    return refusal([&] { read_measurements(folder.file("t.csv", text)); });
  };
  EXPECT_THAT(complaint("series,time,height\na,1,2\n"),
              HasSubstr("line 1: column 'value' is missing; found: series, time, height"));
  EXPECT_THAT(complaint("time,value\n1,2\n2,tall\n"), HasSubstr("line 3: column 'value': 'tall' found"));
  EXPECT_THAT(complaint("time,value\n1,2\n2\n"), HasSubstr("line 3: 1 fields"));
  EXPECT_THAT(complaint("time,value\n1,inf\n"), HasSubstr("finite"));
  EXPECT_THAT(complaint("time,value\n1,5,2,5\n"), HasSubstr("line 2: 4 fields"));
  EXPECT_THAT(complaint("time,value\n"), HasSubstr("without rows"));
  EXPECT_THAT(complaint("time,value\nNA,2\n"), HasSubstr("no row has both"));
  EXPECT_THAT(complaint("series,time,value\n,1,2\n"), HasSubstr("line 2: column 'series' is empty"));
}

TEST(Toml, FlattensTablesAndKeepsLines) {
  const auto entries = parse_toml(
      "seed = 3\nname = \"a \\\"b\\\"\"\n[site]\nslope = 0.5\nbox = [1, 2.5, 3]\n[[tree]]\nroot = [0, "
      "1]\n[[tree]]\non = true\n",
      "f");
  ASSERT_EQ(entries.size(), 6u);
  EXPECT_EQ(entries[0].key, "seed");
  EXPECT_EQ(toml_number(entries[0], "f"), 3);
  EXPECT_EQ(toml_text(entries[1], "f"), "a \"b\"");
  EXPECT_EQ(entries[2].key, "site.slope");
  EXPECT_EQ(entries[2].line, 4);
  EXPECT_THAT(toml_numbers(entries[3], "f"), testing::ElementsAre(1, 2.5, 3));
  EXPECT_EQ(entries[4].key, "tree.0.root");
  EXPECT_THAT(toml_numbers(entries[4], "f"), testing::ElementsAre(0, 1));
  EXPECT_EQ(entries[5].key, "tree.1.on");
  EXPECT_TRUE(toml_truth(entries[5], "f"));
  EXPECT_THAT(refusal([&] { toml_number(entries[1], "f"); }),
              HasSubstr("f, line 2: name: a text found, a number expected"));
}

TEST(Toml, RefusesWithFileAndLine) {
  const TemporaryFolder folder;
  const auto complaint = [&](const std::string& text) {
    return refusal([&] { read_toml(folder.file("p.toml", text)); });
  };
  EXPECT_THAT(complaint("a = 1\nb = \n"), HasSubstr("p.toml, line 2: "));
  EXPECT_THAT(complaint("a = 1\na = 2\n"), HasSubstr("line 2"));
  EXPECT_THAT(complaint("a = nan\n"), HasSubstr("line 1: a: a number that is not finite"));
  EXPECT_THAT(complaint("\na = [1, \"x\"]\n"), HasSubstr("line 2: a: a list of several kinds"));
  EXPECT_THAT(complaint("a = 2020-01-01\n"), HasSubstr("dates"));
  EXPECT_THAT(complaint("a = " + std::string(100000, '[')), HasSubstr("line 1"));
  EXPECT_TRUE(read_toml(folder.file("p.toml", "[a]\n[[b]]\n")).empty());
  for (const auto& [text, name] : {std::pair("x = 1\n[a]\n", "line 2: [a]: nothing in it"),
                                   std::pair("[[b]]\nx = 1\n[[b]]\n", "line 3: [[b]]: nothing in it")})
    EXPECT_THAT(refusal([&] { read_toml_without_empty_tables(folder.file("p.toml", text)); }),
                HasSubstr(name));
}

TEST(Toml, WritesTextOfAnyBytesSoThatItCanBeRead) {
  TomlWriter writer;
  writer.entry("file", TomlValue(std::string("B\xe4um \"\x7f\xff.las")));
  EXPECT_EQ(std::get<std::string>(parse_toml(writer.text(), "x").at(0).value),
            "B\xef\xbf\xbdum \"\x7f\xef\xbf\xbd.las");
}

TEST(Toml, WritesWhatReadsBack) {
  TomlWriter writer;
  writer.comment("two\nlines")
      .entry("x", 0.1, "metres")
      .entry("whole", 3.0)
      .entry("n", std::int64_t{7})
      .entry("on", true);
  writer.table("t")
      .entry("text", "quote \" backslash \\ newline \n tab \t")
      .entry("list", std::vector<double>{1, 2.5e-300});
  writer.array_table("u").entry("s", std::vector<std::string>{"a", "b"});
  const auto entries = parse_toml(writer.text(), "f");
  ASSERT_EQ(entries.size(), 7u);
  EXPECT_EQ(std::get<double>(entries[0].value), 0.1);
  EXPECT_EQ(std::get<double>(entries[1].value), 3.0);
  EXPECT_EQ(std::get<std::int64_t>(entries[2].value), 7);
  EXPECT_EQ(std::get<std::string>(entries[4].value), "quote \" backslash \\ newline \n tab \t");
  EXPECT_EQ(std::get<std::vector<double>>(entries[5].value), (std::vector<double>{1, 2.5e-300}));
  EXPECT_EQ(entries[6].key, "u.0.s");
}

TEST(FileInfo, TellsWhatFilesAre) {
  const TemporaryFolder folder;
  PointCloud cloud = test::sample_cloud(20, kUtm);
  cloud.crs_wkt = "EPSG:25832";
  write_point_cloud(folder / "c.las", cloud);
  const FileInfo las = describe_file(folder / "c.las");
  EXPECT_EQ(las.kind, "cloud");
  EXPECT_EQ(las.format, "las");
  EXPECT_EQ(las.crs_wkt, "EPSG:25832");
  EXPECT_EQ(las.cloud->size(), 20u);
  EXPECT_NEAR(las.bounds.lo.x(), 499998.5, 2);
  write_qsm_csv(folder / "q.csv", test::sample_tree());
  const FileInfo tree = describe_file(folder / "q.csv");
  EXPECT_EQ(tree.kind, "tree");
  EXPECT_EQ(tree.format, "dendrofit");
  EXPECT_EQ(tree.tree->size(), 7u);
  write_tree_ply(folder / "t.ply", test::sample_tree());
  EXPECT_EQ(describe_file(folder / "t.ply").kind, "mesh");
  write_tree_obj(folder / "t.obj", test::sample_tree());
  EXPECT_EQ(describe_file(folder / "t.obj").format, "obj");
  const FileInfo table = describe_file(folder.file("h.csv", "series,time,value\na,1,2\nb,1,3\n"));
  EXPECT_EQ(table.kind, "table");
  EXPECT_EQ(table.series, 2u);
  EXPECT_EQ(describe_file(folder.file("c.xyz", "1 2 3\n4 5 6\n")).format, "xyz");
  EXPECT_THAT(refusal([&] { describe_file(folder.file("x", "hello\n")); }), HasSubstr("line 1"));
}

}  // namespace
}  // namespace dendrofit
