// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/command.h"

#include <cstdio>

namespace dendrofit::cli {

void Session::say(const std::string& line) const {
  if (common_.quiet || common_.json) return;
  std::fputs((line + "\n").c_str(), stdout);
  std::fflush(stdout);
}

void Session::warn(const std::string& line) const {
  if (common_.quiet) return;
  std::fputs(("warning: " + line + "\n").c_str(), stderr);
}

void Session::json(const std::string& text) const {
  if (!common_.json) return;
  std::fputs((text + "\n").c_str(), stdout);
  std::fflush(stdout);
}

}  // namespace dendrofit::cli
