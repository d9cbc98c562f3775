// SPDX-License-Identifier: GPL-3.0-or-later
// A command is one row of a table (cli/commands.cpp) and one class.
#pragma once

#include "cli/options.h"
#include "core/progress.h"

#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace dendrofit::cli {

/// Options every command has, with the same meaning everywhere.
struct CommonOptions {
  std::uint64_t seed = 1;
  int threads = 0;
  std::filesystem::path config;
  bool quiet = false;
  bool json = false;
  bool force = false;
  std::string progress = "auto";
};

/// What a running command may talk to.
class Session {
 public:
  Session(std::string_view command, const CommonOptions& common, const OptionTable& options,
          Progress& progress)
      : command_(command), common_(common), options_(options), progress_(progress) {}

  std::string_view command() const { return command_; }
  const CommonOptions& common() const { return common_; }
  const OptionTable& options() const { return options_; }
  Progress& progress() { return progress_; }

  /// A line for the user on standard output; silent under --quiet and --json.
  void say(const std::string& line) const;
  /// A warning on standard error (also under --json, where standard output belongs to the object).
  void warn(const std::string& line) const;
  /// The one JSON object of --json; does nothing without it. `text` is a complete object.
  void json(const std::string& text) const;
  bool json_written() const { return json_written_; }

 private:
  std::string_view command_;
  const CommonOptions& common_;
  const OptionTable& options_;
  Progress& progress_;
  mutable bool json_written_ = false;
};

/// What --json prints where there is no result: {"error": {"code", "kind", "message"}}, the code being the
/// exit code and the kind its name (usage, bad_input, no_answer, interrupted, fault).
std::string error_json(int code, const std::string& message);

/// Lives for one invocation: declare() binds options to its members, run() does the job and returns the exit
/// code.
class Command {
 public:
  virtual ~Command() = default;
  virtual void declare(OptionTable& options) = 0;
  virtual int run(Session& session) = 0;
};

struct CommandRow {
  std::string_view name;
  std::string_view summary;
  std::string_view example;
  std::unique_ptr<Command> (*make)();
};

/// Every command, in the order of the help.
std::span<const CommandRow> commands();

}  // namespace dendrofit::cli
