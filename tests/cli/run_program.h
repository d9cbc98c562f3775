// SPDX-License-Identifier: GPL-3.0-or-later
// The program itself, run as a user runs it.
#pragma once

#include "tests/support/scratch_folder.h"

#include <cstdlib>
#include <filesystem>
#include <map>
#include <string>

#include <sys/wait.h>

namespace dendrofit::test {

struct Outcome {
  int code = -1;
  std::string out;
  std::string err;
};

/// Runs `dendrofit ARGUMENTS` (shell words) with `before` put before it.
inline Outcome run_program(const std::string& arguments, const std::string& before = "") {
  const ScratchFolder scratch;
  const std::string command = before + " " DENDROFIT_PROGRAM " " + arguments + " >" +
                              (scratch / "out").string() + " 2>" + (scratch / "err").string() + " </dev/null";
  const int status = std::system(command.c_str());
  return {WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status), content_of(scratch / "out"),
          content_of(scratch / "err")};
}

inline std::map<std::string, std::string> files_in(const std::filesystem::path& folder) {
  std::map<std::string, std::string> files;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder))
    if (entry.is_regular_file())
      files[std::filesystem::relative(entry.path(), folder).string()] = content_of(entry.path());
  return files;
}

/// A file of data_samples.
inline std::string sample_file(const std::string& name) {
  return (std::filesystem::path(DENDROFIT_SOURCE_DIR) / "data_samples" / name).string();
}

}  // namespace dendrofit::test
