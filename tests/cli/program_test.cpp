// SPDX-License-Identifier: GPL-3.0-or-later
// The program itself, run as a user runs it: exit codes, files, bytes.
#include "core/atomic_file.h"
#include "forward/igm/parameters.h"
#include "tests/cli/run_program.h"
#include "tests/support/shared_data.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace dendrofit {
namespace {

using ::testing::HasSubstr;
namespace fs = std::filesystem;

using test::files_in;
using test::Outcome;

Outcome run(const std::string& arguments, const std::string& before = "") {
  return test::run_program(arguments, before);
}

std::string sample(const std::string& name) {
  return test::sample_file(name);
}

TEST(Program, help_and_version_succeed_everywhere) {
  EXPECT_EQ(run("--version").code, 0);
  const Outcome help = run("--help");
  EXPECT_EQ(help.code, 0);
  EXPECT_THAT(help.out, HasSubstr("reconstruct"));
  for (const char* command : {"run", "reconstruct", "fit", "grow", "leaves", "info", "convert"}) {
    const Outcome page = run(std::string(command) + " --help");
    EXPECT_EQ(page.code, 0) << command;
    EXPECT_THAT(page.out, HasSubstr("Example: dendrofit " + std::string(command)));
  }
}

TEST(Program, wrong_usage_is_2_bad_input_3_no_answer_4) {
  const test::ScratchFolder scratch;
  EXPECT_EQ(run("").code, 2);
  EXPECT_EQ(run("prune tree.las").code, 2);
  EXPECT_EQ(run("info").code, 2);
  EXPECT_EQ(run("info " + sample("young_tree.las") + " --no-such-option").code, 2);
  EXPECT_EQ(run("reconstruct " + sample("young_tree.las")).code, 2);  // no -o

  const Outcome missing = run("reconstruct nowhere.las -o " + (scratch / "a").string());
  EXPECT_EQ(missing.code, 3);
  EXPECT_THAT(missing.err, HasSubstr("nowhere.las"));
  EXPECT_EQ(run("grow standard --set xm=-5 -o " + (scratch / "b").string()).code, 3);

  // a level sheet of points: a fine cloud, no tree
  std::string sheet;
  for (int i = 0; i < 40; ++i)
    for (int j = 0; j < 40; ++j) sheet += std::to_string(i * 0.05) + " " + std::to_string(j * 0.05) + " 0\n";
  write_file(scratch / "sheet.xyz", sheet);
  const Outcome no_stem =
      run("reconstruct " + (scratch / "sheet.xyz").string() + " -o " + (scratch / "c").string());
  EXPECT_EQ(no_stem.code, 4) << no_stem.err;
  EXPECT_FALSE(fs::exists(scratch / "c" / "qsm.csv"));
}

TEST(Program, a_crown_without_a_stem_is_refused_with_a_reason) {
  const fs::path cloud = test::shared_data("real/impolite/crown_only_no_stem.las");
  DENDROFIT_NEED(cloud);
  const test::ScratchFolder scratch;
  const Outcome outcome = run("run " + cloud.string() + " -o " + (scratch / "out").string());
  EXPECT_EQ(outcome.code, 4);
  EXPECT_THAT(outcome.err, HasSubstr("stem"));
}

TEST(Program, existing_results_are_not_overwritten_without_force) {
  const test::ScratchFolder scratch;
  const std::string grow = "grow standard --cycles 4 -o " + (scratch / "tree").string();
  EXPECT_EQ(run(grow).code, 0);
  const auto before = files_in(scratch / "tree");
  EXPECT_EQ(run(grow + " --seed 2").code, 2);
  EXPECT_EQ(files_in(scratch / "tree"), before);
  EXPECT_EQ(run(grow + " --force").code, 0);
}

TEST(Program, json_is_one_object_and_nothing_else) {
  const Outcome info = run("info --json " + sample("young_tree.las"));
  ASSERT_EQ(info.code, 0);
  const auto json = nlohmann::json::parse(info.out);
  EXPECT_EQ(json.at("format"), "las");
  EXPECT_GT(json.at("points").get<int>(), 10000);
  const test::ScratchFolder scratch;
  const Outcome grown = run("grow --json standard --cycles 5 -o " + (scratch / "t").string());
  EXPECT_EQ(nlohmann::json::parse(grown.out).at("last_cycle"), 5);
}

TEST(Program, an_option_of_the_config_file_works_as_on_the_command_line) {
  const test::ScratchFolder scratch;
  write_file(scratch / "c.toml", "cycles = 6\nseed = 3\n");
  ASSERT_EQ(
      run("grow standard --config " + (scratch / "c.toml").string() + " -o " + (scratch / "a").string()).code,
      0);
  ASSERT_EQ(run("grow standard --cycles 6 --seed 3 -o " + (scratch / "b").string()).code, 0);
  EXPECT_EQ(test::content_of(scratch / "a" / "qsm.csv"), test::content_of(scratch / "b" / "qsm.csv"));
  write_file(scratch / "bad.toml", "cycels = 6\n");
  const Outcome bad =
      run("grow standard --config " + (scratch / "bad.toml").string() + " -o " + (scratch / "x").string());
  EXPECT_EQ(bad.code, 3);
  EXPECT_THAT(bad.err, HasSubstr("cycles"));
}

TEST(Program, a_runs_record_serves_as_its_config_file) {
  const test::ScratchFolder scratch;
  ASSERT_EQ(run("grow standard --cycles 6 --seed 3 -o " + (scratch / "a").string()).code, 0);
  const Outcome again = run("grow standard --config " + (scratch / "a" / "run.toml").string() + " -o " +
                            (scratch / "b").string());
  ASSERT_EQ(again.code, 0) << again.err;
  EXPECT_EQ(test::content_of(scratch / "a" / "qsm.csv"), test::content_of(scratch / "b" / "qsm.csv"));
}

// The written params.toml alone (with the site beside it) grows the same to the last byte.
TEST(Program, grown_parameters_fed_back_grow_the_same) {
  const test::ScratchFolder scratch;
  write_file(scratch / "site.toml",
             "[[tree]]\nroot = [0, 0, 0]\n[[tree]]\nroot = [1, 0.3, 0]\nparameters = {alpha = 8}\n"
             "[[box]]\nmin = [0.5, -1, 0]\nmax = [0.7, 1, 3]\n");
  std::vector<std::string> runs{"standard --site " + (scratch / "site.toml").string(),
                                "standard --set equation=weibull --set paper=true"};
  for (const IgmPreset& preset : igm_presets()) runs.emplace_back(preset.name);
  for (std::size_t i = 0; i < runs.size(); ++i) {
    const fs::path first = scratch / std::to_string(i), again = scratch / (std::to_string(i) + "b");
    ASSERT_EQ(run("grow " + runs[i] + " --cycles 7 --seed 4 -o " + first.string()).code, 0) << runs[i];
    const Outcome back = run("grow " + (first / "params.toml").string() + " --seed 4 -o " + again.string());
    ASSERT_EQ(back.code, 0) << runs[i] << ": " << back.err;
    for (const char* file : {"qsm.csv", "growth.csv", "metrics.json", "params.toml"})
      EXPECT_EQ(test::content_of(first / file), test::content_of(again / file)) << runs[i] << ": " << file;
  }
}

TEST(Program, grow_lists_its_parameters_with_unit_and_bounds) {
  const Outcome keys = run("grow table2-13 --keys --set alpha=7");
  ASSERT_EQ(keys.code, 0) << keys.err;
  EXPECT_THAT(keys.out, testing::AllOf(HasSubstr("xm"), HasSubstr("50 internodes"), HasSubstr("0.01 m"),
                                       HasSubstr("tip_radius_m"), HasSubstr("1e-05 to 0.1")));
  const auto rows = nlohmann::json::parse(run("grow --keys --json").out).at("parameters");
  EXPECT_EQ(rows.size(), igm_parameter_table().size());
}

TEST(Program, scans_refuse_what_cannot_be) {
  const test::ScratchFolder scratch;
  const std::string scan =
      "scan " + sample("young_tree_truth.csv") + " -o " + (scratch / "c.las").string() + " --step 1deg ";
  EXPECT_EQ(run(scan + "--ground=-1m").code, 3);
  EXPECT_EQ(run(scan + "--ground-slope 70deg").code, 3);
  EXPECT_EQ(run(scan + "--instrument-height=-1m").code, 3);
  EXPECT_EQ(run(scan + "--ground 0m --grass-height 10cm").code, 2);
  EXPECT_EQ(run(scan + "--species oak").code, 2);
  EXPECT_EQ(run(scan + "--max-range 1m").code, 4);
  EXPECT_TRUE(files_in(scratch.path()).empty());
  EXPECT_EQ(run(scan + "--ground-slope 20deg --grass-height 10cm --drop-out 0.1 --returns 2").code, 0);
  for (const char* file : {"c.las", "c_truth.csv", "c_truth.json", "c_run.toml"})
    EXPECT_TRUE(fs::exists(scratch / file)) << file;
}

TEST(Program, no_leaves_asked_for_is_no_error) {
  const test::ScratchFolder scratch;
  const Outcome none =
      run("leaves " + sample("young_tree_truth.csv") + " --count 0 -o " + (scratch / "l").string());
  EXPECT_EQ(none.code, 0) << none.err;
  EXPECT_TRUE(fs::exists(scratch / "l" / "run.toml"));
  EXPECT_EQ(nlohmann::json::parse(test::content_of(scratch / "l" / "leaves.json")).at("achieved").at("count"),
            0);
}

TEST(Program, leaves_go_where_asked_in_every_format) {
  const test::ScratchFolder scratch;
  const fs::path out = scratch / "l";
  const Outcome made =
      run("leaves " + sample("young_tree_truth.csv") +
          " --count 60 --species oak --leaf-length 6cm --inclination spherical --profile height=beta:5,2 "
          "--export helios --export less --export eradiate --mesh obj --mesh ply --mesh glb -o " +
          out.string());
  ASSERT_EQ(made.code, 0) << made.err;
  for (const char* file :
       {"qsm.csv", "leaves.csv", "leaves.obj", "leaves.ply", "leaves.glb", "petioles.obj", "petioles.ply",
        "helios/tree.obj", "helios/tree.mtl", "helios/scene.xml", "less/objects.txt", "less/instances.txt",
        "less/tree_leaves.obj", "less/tree_wood.obj", "eradiate/leaves.txt", "eradiate/wood.ply", "run.toml"})
    EXPECT_TRUE(fs::exists(out / file)) << file;
  const auto json = nlohmann::json::parse(test::content_of(out / "leaves.json"));
  EXPECT_EQ(json.at("achieved").at("count"), 60);
  const Outcome wrong =
      run("leaves " + sample("young_tree_truth.csv") + " --export dart -o " + (scratch / "m").string());
  EXPECT_EQ(wrong.code, 2);
  EXPECT_FALSE(fs::exists(scratch / "m"));
  const Outcome odd = run("leaves " + sample("young_tree_truth.csv") + " --profile depth=uniform -o " +
                          (scratch / "m").string());
  EXPECT_EQ(odd.code, 2);
  EXPECT_THAT(odd.err, HasSubstr("height=beta:2,3"));
}

TEST(Program, cycles_count_for_every_tree_of_a_site_and_growing_on_says_when_nothing_is_added) {
  const test::ScratchFolder scratch;
  write_file(scratch / "site.toml",
             "[[tree]]\nroot = [0, 0, 0]\n[[tree]]\nroot = [3, 0, 0]\nparameters = \"table2-05\"\n");
  const Outcome stand = run("grow standard --json --cycles 5 --site " + (scratch / "site.toml").string() +
                            " -o " + (scratch / "s").string());
  ASSERT_EQ(stand.code, 0) << stand.err;
  const auto said = nlohmann::json::parse(stand.out);
  EXPECT_EQ(said.at("last_cycle"), 5);
  // Each tree has metrics of its own, beside those of all wood.
  const auto metrics = nlohmann::json::parse(test::content_of(scratch / "s" / "metrics.json"));
  ASSERT_EQ(metrics.at("trees").size(), 2U);
  EXPECT_EQ(said.at("metrics").at("trees"), metrics.at("trees"));
  double wood = 0;
  for (const auto& tree : metrics.at("trees")) {
    EXPECT_GT(tree.at("height_m"), 0);
    EXPECT_LT(tree.at("crown_diameter_m"), metrics.at("crown_diameter_m"));
    wood += tree.at("total_volume_m3").get<double>();
  }
  EXPECT_NEAR(wood, metrics.at("total_volume_m3"), 1e-9 * wood);
  ASSERT_EQ(run("grow standard --cycles 6 -o " + (scratch / "t").string()).code, 0);
  const Outcome on = run("grow standard --cycles 4 --from " + (scratch / "t" / "qsm.csv").string() +
                         " --from-cycle 6 -o " + (scratch / "u").string());
  EXPECT_EQ(on.code, 0);
  EXPECT_THAT(on.err, HasSubstr("nothing was added"));
}

TEST(Program, a_scan_that_sees_nothing_has_no_answer) {
  const test::ScratchFolder scratch;
  const Outcome blind = run("scan " + sample("young_tree_truth.csv") + " --max-range 1m --ground 0 -o " +
                            (scratch / "c.las").string());
  EXPECT_EQ(blind.code, 4);
  EXPECT_FALSE(fs::exists(scratch / "c.las"));
}

TEST(Determinism, the_main_job_gives_the_same_bytes_for_any_number_of_threads) {
  const test::ScratchFolder scratch;
  const auto main_job = [&](const std::string& folder, const std::string& extra) {
    const Outcome outcome = run("run " + sample("young_tree.las") + " --budget 24 --age 8 -o " +
                                (scratch / folder).string() + " " + extra);
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    auto files = files_in(scratch / folder);
    for (const char* name : {"report.html", "report.json"})  // hold the times of the stages
      EXPECT_TRUE(files.erase(name)) << name;
    // these tell how long leaves and fit took; all else must agree
    for (const char* name : {"leaves.json", "fit.json"}) {
      auto content = nlohmann::json::parse(files[name]);
      EXPECT_EQ(content.erase("seconds"), 1u);
      files[name] = content.dump();
    }
    return files;
  };
  const auto one = main_job("one", "--threads 1");
  for (const char* name :
       {"qsm.csv", "metrics.json", "fit.json", "params.toml", "growth.csv", "leaves.csv", "leaves.json",
        "leaves.obj", "tree.obj", "tree.glb", "leaves.glb", "side_by_side.png", "run.toml"})
    EXPECT_TRUE(one.count(name)) << name;
  const auto two = main_job("two", "--threads 2");
  ASSERT_EQ(one.size(), two.size());
  for (const auto& [name, content] : one) EXPECT_EQ(content == two.at(name), true) << name;
  EXPECT_NE(main_job("other", "--seed 2").at("leaves.csv"), one.at("leaves.csv"));
}

TEST(Program, ctrl_c_leaves_nothing_half_written) {
  const test::ScratchFolder scratch;
  const Outcome outcome =
      run("fit " + sample("young_tree_truth.csv") + " --budget 100000 -o " + (scratch / "out").string(),
          "timeout -s INT -k 30 5");
  // timeout reports 124 when it had to signal; the program's own code stands in its message
  EXPECT_TRUE(outcome.code == 124 || outcome.code == 130) << outcome.code << outcome.err;
  EXPECT_THAT(outcome.err, HasSubstr("stopped"));
  auto left = files_in(scratch / "out");
  left.erase("fit.checkpoint");  // to resume from
  EXPECT_TRUE(left.empty());
}

TEST(Program, only_an_interrupted_fit_can_be_resumed) {
  const test::ScratchFolder scratch;
  const std::string out = (scratch / "out").string();
  const Outcome nothing = run("fit " + sample("young_tree_truth.csv") + " --resume -o " + out);
  EXPECT_EQ(nothing.code, 2);
  EXPECT_THAT(nothing.err, HasSubstr("no interrupted fit"));
  const Outcome several = run("fit " + sample("young_tree_truth.csv") + " " + sample("young_tree_truth.csv") +
                              " --resume -o " + out);
  EXPECT_EQ(several.code, 2);
  EXPECT_THAT(several.err, HasSubstr("one tree at a time"));
  fs::create_directories(out);
  write_file(fs::path(out) / "fit.checkpoint", "dendrofit fit checkpoint 1\nshort");
  const Outcome damaged = run("fit " + sample("young_tree_truth.csv") + " --resume -o " + out);
  EXPECT_EQ(damaged.code, 3);
  EXPECT_THAT(damaged.err, HasSubstr("damaged"));
}

TEST(Program, fitted_parameters_regrow_the_fitted_tree) {
  const test::ScratchFolder scratch;
  ASSERT_EQ(
      run("fit " + sample("young_tree_truth.csv") + " --budget 10 --age 8 -o " + (scratch / "fit").string())
          .code,
      0);
  const auto fit = nlohmann::json::parse(test::content_of(scratch / "fit" / "fit.json"));
  const std::string seed = std::to_string(fit.at("best_seed").get<std::uint64_t>());
  ASSERT_EQ(run("grow " + (scratch / "fit" / "params.toml").string() + " --seed " + seed + " -o " +
                (scratch / "again").string())
                .code,
            0);
  const auto first = nlohmann::json::parse(test::content_of(scratch / "fit" / "regrown" / "metrics.json"));
  const auto again = nlohmann::json::parse(test::content_of(scratch / "again" / "metrics.json"));
  EXPECT_NEAR(first.at("height_m"), again.at("height_m"), 1e-9);
  EXPECT_NEAR(first.at("total_volume_m3"), again.at("total_volume_m3"), 1e-9);
}

}  // namespace
}  // namespace dendrofit
