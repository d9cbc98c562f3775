// SPDX-License-Identifier: GPL-3.0-or-later
// Writes a sound file of every format, for the fuzzer to start from.  usage: fuzz_seeds FOLDER
#include "io/metrics_json.h"
#include "io/write_cloud.h"
#include "io/write_mesh.h"
#include "io/write_tree.h"
#include "tests/io/e57_sample.h"
#include "tests/io/samples.h"
#include "tests/io/text_samples.h"

using namespace dendrofit;

int main(int count, char** words) {
  if (count != 2) return 2;
  const std::filesystem::path folder = words[1];
  for (const char* part : {"cloud", "tree", "mesh", "table"})
    std::filesystem::create_directories(folder / part);
  const auto write = [&](const std::string& name, const std::string& content) {
    std::ofstream(folder / name, std::ios::binary) << content;
  };
  PointCloud cloud = test::sample_cloud(8, {500000, 5400000, 300});
  for (const char* name : {"cloud/a.las", "cloud/a.ply", "cloud/a.pcd", "cloud/a.xyz", "cloud/a.csv"})
    write_point_cloud(folder / name, cloud);
  cloud.crs_wkt = "PROJCS[\"x\"]";
  write_point_cloud(folder / "cloud/wkt.las", cloud);
  write("cloud/a.e57", test::e57_file());
  write("cloud/b.ply", test::ascii_ply());
  write("cloud/c.ply", test::big_endian_ply());
  write("cloud/b.pcd", test::ascii_pcd());
  write("cloud/c.pcd", test::packed_pcd());
  write("cloud/a.ptx", test::ptx());
  write("cloud/a.pts", test::pts());
  write("cloud/comma.txt", test::decimal_comma_text());
  for (int f = 0; f < 7; ++f)
    write_tree(folder / "tree" / std::to_string(f), test::sample_tree(), static_cast<TreeFormat>(f));
  write_tree_obj(folder / "mesh/a.obj", test::sample_tree(), {.min_sides = 3, .max_sides = 4});
  write_tree_ply(folder / "mesh/a.ply", test::sample_tree(), {.min_sides = 3, .max_sides = 4});
  write_tree_glb(folder / "mesh/a.glb", test::sample_tree(), {.min_sides = 3, .max_sides = 4});
  write("table/a", std::string("\0series,time,value\na,1,2\nb,2,NA\n", 33));
  write("table/b", "\1" + metrics_to_json(measure(test::sample_tree())));
  write("table/c", "\2a = 1\n[t]\nb = [1.5, 2]\nc = \"x\"\n[[u]]\nd = true\n");
  return 0;
}
