// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/command.h"
#include "io/json_text.h"

#include <cstdio>

#include <nlohmann/json.hpp>

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
  json_written_ = true;
}

std::string error_json(int code, const std::string& message) {
  const char* kind = code == 2     ? "usage"
                     : code == 3   ? "bad_input"
                     : code == 4   ? "no_answer"
                     : code == 130 ? "interrupted"
                                   : "fault";
  const nlohmann::ordered_json json = {{"error", {{"code", code}, {"kind", kind}, {"message", message}}}};
  return json_text(json);
}

}  // namespace dendrofit::cli
