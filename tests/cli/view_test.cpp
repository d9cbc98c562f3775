// SPDX-License-Identifier: GPL-3.0-or-later
// dendrofit view, run as a user runs it.
#include "tests/support/scratch_folder.h"

#include <cstdlib>

#include <gtest/gtest.h>
#include <sys/wait.h>

namespace dendrofit {
namespace {

int run(const std::string& arguments) {
  const int status = std::system((DENDROFIT_PROGRAM " " + arguments + " >/dev/null 2>&1 </dev/null").c_str());
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

std::string sample(const std::string& name) {
  return (std::filesystem::path(DENDROFIT_SOURCE_DIR) / "data_samples" / name).string();
}

TEST(View, pictures_a_folder_of_results_with_a_scan_beside_it) {
  const test::ScratchFolder scratch;
  const std::string tree = (scratch / "tree").string();
  ASSERT_EQ(run("grow standard --cycles 4 -o " + tree), 0);
  const std::string png = (scratch / "a.png").string();
  const std::string view = "view " + tree + " --scan " + sample("young_tree.las") +
                           " --azimuth 30deg --elevation 10 --width 240 --height 240 --png ";
  ASSERT_EQ(run(view + png + " --threads 1"), 0);
  const std::string picture = test::content_of(scratch / "a.png");
  EXPECT_EQ(picture.substr(0, 8), "\x89PNG\r\n\x1a\n");
  EXPECT_EQ(run(view + png), 2);  // it is there already
  EXPECT_EQ(run(view + png + " --threads 2 --force"), 0);
  EXPECT_EQ(test::content_of(scratch / "a.png"), picture);
}

TEST(View, makes_a_page_of_a_folder_with_the_growth_in_it) {
  const test::ScratchFolder scratch;
  const std::string tree = (scratch / "a \"tree\" <1>").string(), page = (scratch / "p.html").string();
  ASSERT_EQ(run("grow standard --cycles 4 -o '" + tree + "'"), 0);
  ASSERT_EQ(run("leaves '" + tree + "/qsm.csv' --count 30 --force -o '" + tree + "'"), 0);
  ASSERT_EQ(run("view '" + tree + "' --height 240 --html " + page), 0);
  const std::string html = test::content_of(scratch / "p.html");
  EXPECT_NE(html.find("<h1>a &quot;tree&quot; &lt;1&gt;</h1>"), std::string::npos);
  EXPECT_NE(html.find("30 leaves"), std::string::npos);
  EXPECT_NE(html.find("plot-growth-1"), std::string::npos);
  EXPECT_EQ(run("view '" + tree + "' --html " + (scratch / "p.pdf").string()), 2);
  EXPECT_EQ(run("view '" + tree + "' --png " + (scratch / "p.jpg").string()), 2);
  EXPECT_FALSE(std::filesystem::exists(scratch / "p.jpg"));
}

TEST(View, makes_a_fits_page_again_with_all_its_tables) {
  const test::ScratchFolder scratch;
  const std::string fit = (scratch / "fit").string();
  ASSERT_EQ(run("fit " + sample("young_tree_truth.csv") + " --budget 4 -o " + fit), 0);
  ASSERT_EQ(run("view " + fit + " --height 240 --html " + (scratch / "p.html").string()), 0);
  const std::string html = test::content_of(scratch / "p.html");
  for (const char* part : {"table-parameters", "table-descriptors", "plot-parameters", "not identifiable",
                           "young_tree_truth.csv"})
    EXPECT_NE(html.find(part), std::string::npos) << part;
  std::string broken = test::content_of(scratch / "fit" / "report.json");
  broken.replace(broken.find("\"seed\": 1"), 9, "\"seed\": 1e99");
  std::ofstream(scratch / "fit" / "report.json") << broken;
  EXPECT_EQ(run("view " + fit + " --force --html " + (scratch / "p.html").string()), 3);
  std::ofstream(scratch / "fit" / "report.json") << "{";
  EXPECT_EQ(run("view " + fit + " --force --html " + (scratch / "p.html").string()), 3);
}

TEST(View, pictures_a_cloud_and_refuses_what_it_cannot_show) {
  const test::ScratchFolder scratch;
  const std::string png = " --png " + (scratch / "a.png").string();
  EXPECT_EQ(run("view " + sample("young_tree.las") + png + " --height 200 --zoom -1,-1,0,1,1,2m"), 0);
  EXPECT_EQ(run("view " + sample("young_tree.las")), 2);
  EXPECT_EQ(run("view " + sample("young_tree.las") + png + " --force --zoom 1,2"), 2);
  EXPECT_EQ(run("view " + sample("young_tree.las") + png + " --force --elevation 95"), 3);
  EXPECT_EQ(run("view " + sample("loblolly_heights.csv") + png + " --force"), 3);
  EXPECT_EQ(run("view " + scratch.path().string() + png + " --force"), 3);
}

}  // namespace
}  // namespace dendrofit
