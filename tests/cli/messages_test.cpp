// SPDX-License-Identifier: GPL-3.0-or-later
// What a user reads when something is wrong.
#include "cli/commands.h"
#include "cli/parse.h"
#include "core/atomic_file.h"
#include "tests/cli/run_program.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace dendrofit {
namespace {

using test::Outcome;
using test::run_program;
using test::sample_file;
using testing::HasSubstr;
using testing::Not;

TEST(Messages, a_value_out_of_range_names_the_option_that_was_typed) {
  const test::ScratchFolder scratch;
  const std::string to = " -o " + (scratch / "out").string();
  const std::string scan = sample_file("young_tree.las"), qsm = sample_file("young_tree_truth.csv");
  const std::vector<std::pair<std::string, std::string>> cases = {
      {"reconstruct " + scan + to + " --voxel 900mm", "--voxel 0.9m: "},
      {"reconstruct " + scan + to + " --max-gap -1m", "--max-gap -1m: "},
      {"reconstruct " + scan + to + " --dbh-height 0", "--dbh-height 0m: "},
      {"fit " + qsm + to + " --age 1", "--age 1: "},
      {"fit " + qsm + to + " --budget 0", "--budget 0: "},
      {"leaves " + qsm + to + " --season 3", "--season 3: "},
      {"leaves " + qsm + to + " --area -4", "--area -4m2: "},
      {"scan " + qsm + " -o " + (scratch / "c.las").string() + " --stations 0", "--stations 0: "},
      {"scan " + qsm + " -o " + (scratch / "c.las").string() + " --registration-turn 90",
       "--registration-turn 90deg: "},
      {"scan " + qsm + " -o " + (scratch / "c.las").string() + " --returns 0", "--returns 0: "},
      {"growth " + sample_file("loblolly_heights.csv") + " --confidence 2", "--confidence 2: "},
      {"growth " + sample_file("loblolly_heights.csv") + " --loss-scale 0", "--loss-scale 0: "}};
  for (const auto& [arguments, said] : cases) {
    const Outcome outcome = run_program(arguments);
    EXPECT_EQ(outcome.code, 3) << arguments;
    EXPECT_THAT(outcome.err, HasSubstr(said)) << arguments;
    EXPECT_FALSE(std::filesystem::exists(scratch / "out")) << arguments;
  }
}

TEST(Messages, other_messages_stay_as_they_are) {
  cli::CommonOptions common;
  cli::OptionTable options;
  cli::declare_common(options, common);
  for (const std::string text : {"tree.las: holds no points", "a = b", "nobody_m = 3: must be larger", ""})
    EXPECT_EQ(cli::in_option_names(text, options), text);
  EXPECT_EQ(cli::in_option_names("threads = -1: must not be negative", options),
            "--threads 0: must not be negative");
}

TEST(Messages, json_tells_a_failure_as_one_object) {
  const test::ScratchFolder scratch;
  write_file(scratch / "sheet.xyz", "0 0 0\n1 0 0\n0 1 0\n1 1 0\n2 1 0\n");
  const std::vector<std::pair<std::string, int>> cases = {
      {"info --json nowhere.las", 3},
      {"info --json", 2},
      {"reconstruct --json " + (scratch / "sheet.xyz").string() + " -o " + (scratch / "o").string(), 4},
      {"grow --json standard --set xm=-5 -o " + (scratch / "p").string(), 3}};
  for (const auto& [arguments, code] : cases) {
    const Outcome outcome = run_program(arguments);
    EXPECT_EQ(outcome.code, code) << arguments << outcome.err;
    const auto json = nlohmann::json::parse(outcome.out);
    EXPECT_EQ(json.at("error").at("code"), code);
    const std::string message = json.at("error").at("message");
    EXPECT_THAT(outcome.err, HasSubstr(message));
  }
  EXPECT_EQ(run_program("info nowhere.las").out, "");
}

TEST(Messages, bytes_that_are_no_text_do_not_break_the_json) {
  const test::ScratchFolder scratch;
  std::string las = test::content_of(sample_file("young_tree.las"));
  las.replace(58, 4, "\xff\xfe\x80z");  // the name of the program that wrote it
  write_file(scratch / "a.las", las);
  const Outcome outcome = run_program("info --json " + (scratch / "a.las").string());
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_GT(nlohmann::json::parse(outcome.out).at("points"), 1000);
}

TEST(Messages, every_help_has_an_example_and_every_number_its_default) {
  for (const cli::CommandRow& row : cli::commands()) {
    const Outcome page = run_program(std::string(row.name) + " --help");
    EXPECT_EQ(page.code, 0);
    EXPECT_THAT(page.out, HasSubstr("Example: dendrofit " + std::string(row.name)));
    const auto command = row.make();
    cli::OptionTable options;
    command->declare(options);
    for (const cli::OptionSpec& spec : options.all()) {
      EXPECT_THAT(page.out, HasSubstr(spec.name));
      EXPECT_FALSE(spec.help.empty()) << spec.name;
      const bool counts = spec.value_name == "N" || spec.value_name == "NUMBER" ||
                          spec.value_name == "LENGTH" || spec.value_name == "ANGLE";
      if (counts && spec.default_text.empty()) {
        EXPECT_TRUE(spec.current().empty()) << row.name << " " << spec.name;
      }
    }
  }
}

TEST(Messages, quiet_says_nothing_and_plain_progress_is_lines) {
  const test::ScratchFolder scratch;
  const Outcome quiet = run_program("grow standard --cycles 4 --quiet -o " + (scratch / "a").string());
  EXPECT_EQ(quiet.code, 0);
  EXPECT_EQ(quiet.out + quiet.err, "");
  const Outcome plain =
      run_program("grow standard --cycles 14 --progress plain -o " + (scratch / "b").string());
  EXPECT_EQ(plain.code, 0);
  EXPECT_THAT(plain.err, Not(HasSubstr("\r")));
}

TEST(Messages, a_stand_has_metrics_by_tree) {
  const test::ScratchFolder scratch;
  write_file(scratch / "site.toml",
             "[[tree]]\nroot = [0, 0, 0]\n[[tree]]\nroot = [6, 0, 0]\n[tree.parameters]\nxm = 12.0\n");
  const Outcome stand = run_program("grow standard --cycles 8 --site " + (scratch / "site.toml").string() +
                                    " -o " + (scratch / "s").string());
  ASSERT_EQ(stand.code, 0) << stand.err;
  const auto metrics = nlohmann::json::parse(test::content_of(scratch / "s" / "metrics.json"));
  ASSERT_EQ(metrics.at("trees").size(), 2u);
  const double both = metrics.at("total_volume_m3"), first = metrics.at("trees")[0].at("total_volume_m3"),
               second = metrics.at("trees")[1].at("total_volume_m3");
  EXPECT_NEAR(first + second, both, 1e-9 * both);
  EXPECT_GT(metrics.at("trees")[0].at("height_m"), metrics.at("trees")[1].at("height_m"));
  EXPECT_THAT(stand.out, HasSubstr("tree 2"));
}

}  // namespace
}  // namespace dendrofit
