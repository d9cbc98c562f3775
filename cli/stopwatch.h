// SPDX-License-Identifier: GPL-3.0-or-later
// Wall time by stage, for the report.
#pragma once

#include <chrono>
#include <string>
#include <utility>
#include <vector>

namespace dendrofit::cli {

class Stopwatch {
 public:
  /// Ends the stage that runs since the last lap.
  void lap(std::string stage) {
    const auto now = std::chrono::steady_clock::now();
    laps_.emplace_back(std::move(stage), std::chrono::duration<double>(now - last_).count());
    last_ = now;
  }
  const std::vector<std::pair<std::string, double>>& laps() const { return laps_; }

 private:
  std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
  std::vector<std::pair<std::string, double>> laps_;
};

}  // namespace dendrofit::cli
