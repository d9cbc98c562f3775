// SPDX-License-Identifier: GPL-3.0-or-later
// What another program says on its standard output.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include <sys/types.h>

namespace dendrofit {

/// The first of `names` in a folder of PATH that may be run; empty when there is none.
std::filesystem::path find_program(const std::vector<std::string>& names);

/// A running program: no input, its complaints thrown away, its output to be read. Ended with the object.
class ChildProcess {
 public:
  /// `command[0]` is the program's path. Throws IoError when it cannot be started.
  explicit ChildProcess(const std::vector<std::string>& command);
  ~ChildProcess();
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;

  /// Up to `size` bytes, waiting for all of them; fewer only at the output's end.
  std::size_t read(char* to, std::size_t size);
  /// Waits for its end; the exit code, or 128 + the signal that ended it.
  int wait();

 private:
  pid_t pid_ = -1;
  int output_ = -1;
};

}  // namespace dendrofit
