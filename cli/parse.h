// SPDX-License-Identifier: GPL-3.0-or-later
// The command line and --config file onto an OptionTable (CLI11 stays behind this header).
#pragma once

#include "cli/command.h"

#include <stdexcept>
#include <string>
#include <vector>

namespace dendrofit::cli {

/// Wrong usage: exit code 2, with what is wrong and where the help is.
struct UsageError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Raised for --help and --version: print the text, exit 0.
struct HelpRequested {
  std::string text;
};

struct Invocation {
  const CommandRow* row = nullptr;
  std::vector<std::string> arguments;  ///< after the command's name
};

/// Which command is meant. Throws UsageError (with the nearest command's name) or HelpRequested.
Invocation choose_command(const std::vector<std::string>& arguments);

/// Adds the common options to the table.
void declare_common(OptionTable& options, CommonOptions& common);

/// Applies `arguments`, then the config file's keys that the command line did not give. Throws UsageError,
/// HelpRequested, or InputError for a config file with an unknown key or a bad value (file and line in the
/// message).
void parse_options(const Invocation& invocation, const OptionTable& options, const CommonOptions& common);

/// A message "field = value: limit" about a field of an options struct in the user's words: the option that
/// sets the field and the value it has. Any other message as it is.
std::string in_option_names(const std::string& message, const OptionTable& options);

}  // namespace dendrofit::cli
