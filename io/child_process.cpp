// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/child_process.h"

#include "core/errors.h"

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <string_view>

#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

extern char** environ;

namespace dendrofit {

std::filesystem::path find_program(const std::vector<std::string>& names) {
  const char* set = std::getenv("PATH");
  std::string_view folders = set ? set : "/usr/bin:/bin";
  while (!folders.empty()) {
    const std::size_t stop = std::min(folders.find(':'), folders.size());
    for (const std::string& name : names) {
      std::filesystem::path path = std::filesystem::path(folders.substr(0, stop)) / name;
      std::error_code ignored;
      if (std::filesystem::is_regular_file(path, ignored) && ::access(path.c_str(), X_OK) == 0) return path;
    }
    folders.remove_prefix(std::min(stop + 1, folders.size()));
  }
  return {};
}

ChildProcess::ChildProcess(const std::vector<std::string>& command) {
  int ends[2];
  if (::pipe2(ends, O_CLOEXEC) != 0)
    throw IoError(command[0] + ": no pipe to it (" + std::strerror(errno) + ")");
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, 0, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_adddup2(&actions, ends[1], 1);
  posix_spawn_file_actions_addopen(&actions, 2, "/dev/null", O_WRONLY, 0);
  std::vector<char*> words;
  words.reserve(command.size() + 1);
  for (const std::string& word : command) words.push_back(const_cast<char*>(word.c_str()));
  words.push_back(nullptr);
  const int failed = ::posix_spawn(&pid_, command[0].c_str(), &actions, nullptr, words.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  ::close(ends[1]);
  output_ = ends[0];
  if (failed != 0) {
    ::close(output_);
    throw IoError(command[0] + ": could not be started (" + std::strerror(failed) + ")");
  }
}

ChildProcess::~ChildProcess() {
  ::close(output_);
  if (pid_ > 0) {
    ::kill(pid_, SIGKILL);
    wait();
  }
}

std::size_t ChildProcess::read(char* to, std::size_t size) {
  std::size_t got = 0;
  while (got < size) {
    const ssize_t n = ::read(output_, to + got, size - got);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) break;
    got += static_cast<std::size_t>(n);
  }
  return got;
}

int ChildProcess::wait() {
  int status = 0;
  while (::waitpid(pid_, &status, 0) < 0 && errno == EINTR) {
  }
  pid_ = -1;
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

}  // namespace dendrofit
