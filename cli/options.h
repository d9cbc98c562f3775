// SPDX-License-Identifier: GPL-3.0-or-later
// The options of a command, declared once: command line, help text, config file and run.toml all read this
// table.
#pragma once

#include "cli/units.h"

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace dendrofit::cli {

/// One option. `apply` may throw std::invalid_argument, which the parser reports as wrong usage.
struct OptionSpec {
  std::string name;        ///< "--voxel"; "SCAN" for a positional
  std::string short_name;  ///< "-o" or empty
  std::string value_name;  ///< "LENGTH"; empty for a flag
  std::string help;
  std::string default_text;  ///< shown in the help; empty for none
  std::function<void(const std::string&)> apply;
  std::function<std::string()> current;  ///< resolved value for run.toml; empty string: not set
  bool positional = false;
  bool required = false;
  bool repeats = false;          ///< may be given several times (positionals: takes all the rest)
  bool several_at_once = false;  ///< takes every word up to the next option
  std::function<std::vector<std::string>()> current_list;  ///< of one that repeats: its resolved values
};

/// Declares options onto variables that hold their defaults; the variables must outlive parsing.
class OptionTable {
 public:
  void positional(const std::string& name, std::filesystem::path& target, const std::string& help,
                  bool required = true);
  void positionals(const std::string& name, std::vector<std::filesystem::path>& target,
                   const std::string& help, bool required = true);
  void flag(const std::string& name, bool& target, const std::string& help);
  void text(const std::string& name, std::string& target, const std::string& value_name,
            const std::string& help);
  void texts(const std::string& name, std::vector<std::string>& target, const std::string& value_name,
             const std::string& help, bool several_at_once = false);
  void path(const std::string& name, std::filesystem::path& target, const std::string& help,
            const std::string& short_name = "");
  void choice(const std::string& name, std::string& target, const std::vector<std::string>& allowed,
              const std::string& help);
  void number(const std::string& name, double& target, Quantity quantity, const std::string& help);
  void number(const std::string& name, std::optional<double>& target, Quantity quantity,
              const std::string& help);
  void integer(const std::string& name, int& target, const std::string& help);
  void integer(const std::string& name, std::optional<int>& target, const std::string& help);
  void integer(const std::string& name, std::uint64_t& target, const std::string& help);

  const std::vector<OptionSpec>& all() const { return options_; }
  /// The option with this long name without dashes ("voxel"), or nullptr.
  const OptionSpec* find(std::string_view key) const;

 private:
  OptionSpec& add(const std::string& name, const std::string& value_name, const std::string& help);
  std::vector<OptionSpec> options_;
};

}  // namespace dendrofit::cli
