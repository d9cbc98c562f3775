// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/parse.h"

#include "cli/version.h"
#include "core/errors.h"
#include "core/parameters.h"
#include "io/toml.h"

#include <algorithm>
#include <map>
#include <set>
#include <variant>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

namespace dendrofit::cli {
namespace {

std::string overview() {
  std::string text =
      "dendrofit: from a laser scan of a tree to its cylinder model, its growth parameters and its regrown "
      "self\n\n"
      "usage: dendrofit COMMAND ... [options]        dendrofit COMMAND --help\n\ncommands:\n";
  for (const CommandRow& row : commands()) text += fmt::format("  {:<12}{}\n", row.name, row.summary);
  text += "\nA first try:  dendrofit run tree.las -o result     then open result/report.html\n";
  return text;
}

/// Applies one option's values through its spec, turning a complaint into CLI11's error.
bool apply_all(const OptionSpec& spec, const CLI::results_t& values) {
  for (const std::string& value : values) {
    try {
      spec.apply(value);
    } catch (const std::invalid_argument& error) {
      throw CLI::ValidationError(spec.name, error.what());
    }
  }
  return true;
}

void bind(CLI::App& app, const OptionSpec& spec, std::set<std::string>& given) {
  const std::string names = spec.short_name.empty() ? spec.name : spec.short_name + "," + spec.name;
  CLI::Option* option = nullptr;
  if (spec.value_name.empty()) {
    option = app.add_flag_callback(
        names,
        [&spec, &given] {
          spec.apply("true");
          given.insert(spec.name);
        },
        spec.help);
  } else {
    option = app.add_option(
        names,
        [&spec, &given](const CLI::results_t& values) {
          given.insert(spec.name);
          return apply_all(spec, values);
        },
        spec.help);
    option->type_name(spec.positional ? "" : spec.value_name);
    if (!spec.default_text.empty()) option->default_str(spec.default_text);
    if (spec.repeats && spec.positional) option->expected(1, 1 << 20)->allow_extra_args();
    if (spec.repeats && !spec.positional) option->expected(1, spec.several_at_once ? 1 << 20 : 1)->take_all();
    if (!spec.repeats) option->expected(1)->multi_option_policy(CLI::MultiOptionPolicy::Throw);
  }
  if (spec.required) option->required();
}

/// The entry's values as words of the command line; a list gives several.
std::vector<std::string> words_of(const TomlEntry& entry, bool list_allowed) {
  return std::visit(
      [&](const auto& value) -> std::vector<std::string> {
        using T = std::decay_t<decltype(value)>;
        if constexpr (std::is_same_v<T, bool>) {
          return {value ? "true" : "false"};
        } else if constexpr (std::is_same_v<T, std::string>) {
          return {value};
        } else if constexpr (std::is_arithmetic_v<T>) {
          return {fmt::format("{}", value)};
        } else {
          if (!list_allowed) throw InputError("a list is not a value for this key");
          std::vector<std::string> words;
          for (const auto& one : value) words.push_back(fmt::format("{}", one));
          return words;
        }
      },
      entry.value);
}

void apply_config(const std::filesystem::path& file, const OptionTable& options,
                  const std::set<std::string>& given) {
  std::vector<TomlEntry> entries = read_toml(file);
  // A run.toml holds the options of its run in a table of their own, beside facts that are none.
  constexpr std::string_view kTable = "options.";
  if (std::any_of(entries.begin(), entries.end(),
                  [&](const TomlEntry& e) { return e.key.starts_with(kTable); })) {
    std::erase_if(entries, [&](const TomlEntry& e) { return !e.key.starts_with(kTable); });
    for (TomlEntry& entry : entries) entry.key.erase(0, kTable.size());
  }
  for (const TomlEntry& entry : entries) {
    const std::string where = fmt::format("{}:{}", file.string(), entry.line);
    const OptionSpec* spec = options.find(entry.key);
    if (!spec || spec->name == "--config") {
      std::vector<std::string> known;
      for (const OptionSpec& option : options.all())
        if (!option.positional && option.name != "--config") known.push_back(option.name.substr(2));
      throw InputError(fmt::format("{}: unknown key '{}'; did you mean '{}'?", where, entry.key,
                                   nearest_word(entry.key, known)));
    }
    if (given.count(spec->name)) continue;
    try {
      for (const std::string& word : words_of(entry, spec->repeats)) spec->apply(word);
    } catch (const std::invalid_argument& error) {
      throw InputError(fmt::format("{}: {}: {}", where, entry.key, error.what()));
    } catch (const InputError& error) {
      throw InputError(fmt::format("{}: {}: {}", where, entry.key, error.what()));
    }
  }
}

/// The key of the option that sets this field of an options struct: its name without the unit, but for a few.
std::string option_key_of(const std::string& field) {
  static const std::map<std::string, std::string> kOtherwise = {
      {"voxel_size_m", "voxel"},
      {"registration_error_deg", "registration-turn"},
      {"max_returns", "returns"},
      {"ground_radius_m", "ground"},
      {"evaluations", "budget"},
      {"seconds", "budget"},
      {"start_cycle", "from-cycle"},
      {"first_azimuth_deg", "azimuth"},
      {"fixed", "fix"},
      {"bounds", "bound"}};
  std::string name = field.substr(0, field.find('.'));
  if (const auto known = kOtherwise.find(name); known != kOtherwise.end()) return known->second;
  for (const std::string_view unit : {"_m", "_m2", "_deg", "_mrad", "_years"})
    if (name.ends_with(unit)) {
      name.erase(name.size() - unit.size());
      break;
    }
  std::replace(name.begin(), name.end(), '_', '-');
  return name;
}

}  // namespace

Invocation choose_command(const std::vector<std::string>& arguments) {
  if (arguments.empty()) throw UsageError("no command given\n\n" + overview());
  const std::string& first = arguments.front();
  if (first == "--help" || first == "-h" || first == "help") throw HelpRequested{overview()};
  if (first == "--version" || first == "version")
    throw HelpRequested{fmt::format("dendrofit {}\n", version())};
  std::vector<std::string> names;
  for (const CommandRow& row : commands()) {
    if (row.name == first) return {&row, {arguments.begin() + 1, arguments.end()}};
    names.emplace_back(row.name);
  }
  throw UsageError(fmt::format("'{}' is not a command; did you mean '{}'? (dendrofit --help lists them)",
                               first, nearest_word(first, names)));
}

void declare_common(OptionTable& options, CommonOptions& common) {
  options.integer("--seed", common.seed, "Seed of every random choice: the same seed gives the same files");
  options.integer("--threads", common.threads, "Threads to use (0: all cores); does not change the results");
  options.path("--config", common.config, "TOML file with any of these options as keys (without the dashes)");
  options.flag("--force", common.force, "Overwrite existing results");
  options.choice("--progress", common.progress, {"auto", "plain", "none"}, "Progress on standard error");
  options.flag("--quiet", common.quiet, "Only errors");
  options.flag("--json", common.json, "One JSON object on standard output and nothing else there");
}

void parse_options(const Invocation& invocation, const OptionTable& options, const CommonOptions& common) {
  CLI::App app{std::string(invocation.row->summary), "dendrofit " + std::string(invocation.row->name)};
  app.footer("Example: " + std::string(invocation.row->example));
  app.option_defaults()->ignore_case(false);
  std::set<std::string> given;
  for (const OptionSpec& spec : options.all()) bind(app, spec, given);
  std::vector<std::string> reversed(invocation.arguments.rbegin(), invocation.arguments.rend());
  try {
    app.parse(reversed);
  } catch (const CLI::CallForHelp&) {
    throw HelpRequested{app.help()};
  } catch (const CLI::ParseError& error) {
    throw UsageError(
        fmt::format("{}\n(dendrofit {} --help shows its options)", error.what(), invocation.row->name));
  }
  if (!common.config.empty()) apply_config(common.config, options, given);
}

std::string in_option_names(const std::string& message, const OptionTable& options) {
  const auto equals = message.find(" = ");
  const auto colon = message.find(": ", equals == std::string::npos ? 0 : equals);
  if (equals == std::string::npos || colon == std::string::npos) return message;
  const std::string field = message.substr(0, equals), limit = message.substr(colon + 2);
  const OptionSpec* spec = options.find(option_key_of(field));
  if (!spec) return message;
  const std::string value = spec->current();
  return fmt::format("{}{}: {}", spec->name, value.empty() || spec->repeats ? "" : " " + value, limit);
}

}  // namespace dendrofit::cli
