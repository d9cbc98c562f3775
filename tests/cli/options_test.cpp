// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/options.h"

#include "cli/parse.h"
#include "core/atomic_file.h"
#include "core/errors.h"

#include <filesystem>
#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

namespace dendrofit::cli {
namespace {

using ::testing::HasSubstr;

/// One option of each kind, parsed as the command `info` would.
struct Parsed {
  std::filesystem::path file;
  double gap = 1.5;
  std::optional<double> twig;
  std::optional<int> count;
  bool deep = false;
  std::string colour = "order";
  std::vector<std::string> settings;
  CommonOptions common;
  OptionTable table;

  explicit Parsed(std::vector<std::string> arguments) {
    table.positional("FILE", file, "a file");
    table.number("--gap", gap, Quantity::length, "a gap");
    table.number("--twig", twig, Quantity::length, "a twig");
    table.integer("--count", count, "a count");
    table.flag("--deep", deep, "deep");
    table.choice("--colour", colour, {"order", "radius"}, "a colour");
    table.texts("--set", settings, "KEY=VALUE", "a setting");
    declare_common(table, common);
    parse_options({&commands().front(), std::move(arguments)}, table, common);
  }
};

template <class Error>
std::string complaint(std::vector<std::string> arguments) {
  try {
    Parsed parsed(std::move(arguments));
  } catch (const Error& error) {
    return error.what();
  }
  return "no complaint";
}

class ConfigFile {
 public:
  explicit ConfigFile(const std::string& text)
      : path_(std::filesystem::temp_directory_path() /
              ("dendrofit_config_" + std::to_string(::getpid()) + ".toml")) {
    write_file(path_, text);
  }
  ~ConfigFile() { std::filesystem::remove(path_); }
  std::string path() const { return path_.string(); }

 private:
  std::filesystem::path path_;
};

TEST(Options, values_arrive_in_their_variables) {
  const Parsed p({"a.las", "--gap", "20cm", "--count", "-3", "--deep", "--colour", "radius", "--set", "a=1",
                  "--set", "b=2", "--seed", "9"});
  EXPECT_EQ(p.file, "a.las");
  EXPECT_DOUBLE_EQ(p.gap, 0.2);
  EXPECT_FALSE(p.twig);
  EXPECT_EQ(p.count, -3);
  EXPECT_TRUE(p.deep);
  EXPECT_EQ(p.colour, "radius");
  EXPECT_THAT(p.settings, ::testing::ElementsAre("a=1", "b=2"));
  EXPECT_EQ(p.common.seed, 9u);
}

TEST(Options, wrong_usage_says_what_is_wrong) {
  EXPECT_THAT(complaint<UsageError>({}), HasSubstr("FILE"));
  EXPECT_THAT(complaint<UsageError>({"a", "--gap", "wide"}), HasSubstr("not a number"));
  EXPECT_THAT(complaint<UsageError>({"a", "--colour", "raduis"}), HasSubstr("did you mean 'radius'"));
  EXPECT_THAT(complaint<UsageError>({"a", "--grap", "1"}), HasSubstr("--grap"));
  EXPECT_THAT(complaint<UsageError>({"a", "b"}), HasSubstr("b"));
  EXPECT_THAT(complaint<UsageError>({"a", "--seed", "-1"}), HasSubstr("whole number"));
  EXPECT_THAT(complaint<UsageError>({"a", "--gap"}), HasSubstr("--gap"));
}

TEST(Options, help_shows_defaults_units_and_an_example) {
  try {
    Parsed parsed({"--help"});
    FAIL();
  } catch (const HelpRequested& help) {
    EXPECT_THAT(help.text, HasSubstr("1.5m"));
    EXPECT_THAT(help.text, HasSubstr("LENGTH"));
    EXPECT_THAT(help.text, HasSubstr("Example: dendrofit"));
  }
}

TEST(Options, a_config_file_fills_what_the_command_line_leaves) {
  const ConfigFile config("gap = \"30cm\"\ntwig = 0.002\ndeep = true\ncount = 7\n");
  const Parsed p({"a.las", "--config", config.path(), "--count", "2"});
  EXPECT_DOUBLE_EQ(p.gap, 0.3);
  EXPECT_DOUBLE_EQ(p.twig.value_or(0), 0.002);
  EXPECT_TRUE(p.deep);
  EXPECT_EQ(p.count, 2);
}

TEST(Options, a_config_files_fault_is_named_with_its_line) {
  const ConfigFile unknown("deep = true\ngapp = 1\n");
  EXPECT_THAT(complaint<InputError>({"a", "--config", unknown.path()}),
              ::testing::AllOf(HasSubstr(":2"), HasSubstr("'gap'")));
  const ConfigFile bad("gap = \"wide\"\n");
  EXPECT_THAT(complaint<InputError>({"a", "--config", bad.path()}),
              ::testing::AllOf(HasSubstr(":1"), HasSubstr("wide")));
  const ConfigFile list("gap = [1, 2]\n");
  EXPECT_THAT(complaint<InputError>({"a", "--config", list.path()}), HasSubstr("list"));
}

TEST(Options, every_command_declares_unique_options_with_help) {
  for (const CommandRow& row : commands()) {
    OptionTable table;
    CommonOptions common;
    const auto command = row.make();
    command->declare(table);
    declare_common(table, common);
    std::set<std::string> names;
    for (const OptionSpec& option : table.all()) {
      EXPECT_TRUE(names.insert(option.name).second) << row.name << " " << option.name;
      EXPECT_FALSE(option.help.empty()) << row.name << " " << option.name;
    }
    EXPECT_THAT(std::string(row.example), ::testing::StartsWith("dendrofit " + std::string(row.name)));
  }
}

TEST(Options, an_unknown_command_suggests_the_nearest) {
  try {
    choose_command({"recontruct", "a.las"});
    FAIL();
  } catch (const UsageError& error) {
    EXPECT_THAT(error.what(), HasSubstr("'reconstruct'"));
  }
  EXPECT_THROW(choose_command({}), UsageError);
  EXPECT_THROW(choose_command({"--version"}), HelpRequested);
}

}  // namespace
}  // namespace dendrofit::cli
