// SPDX-License-Identifier: GPL-3.0-or-later
// Progress on standard error: a bar with rate and time left on a terminal, a line every few seconds
// elsewhere.
#pragma once

#include "core/progress.h"

#include <chrono>
#include <mutex>
#include <string>

namespace dendrofit::cli {

class ConsoleProgress : public Progress {
 public:
  enum class Style { none, plain, bar };

  ConsoleProgress(Style style, const std::atomic<bool>* cancel) : Progress(cancel), style_(style) {}

  /// `mode` is the --progress option: auto looks whether standard error is a terminal.
  static Style style_for(const std::string& mode, bool quiet);

  void begin(std::string_view stage, double total, std::string_view unit) override;
  void advance(double amount) override;
  void remark(std::string_view text) override;
  void end() override;

 private:
  using Clock = std::chrono::steady_clock;
  void draw(Clock::time_point now);

  const Style style_;
  std::mutex mutex_;
  std::string stage_;
  std::string unit_;
  std::string remark_;
  double total_ = 0;
  double done_ = 0;
  Clock::time_point started_;
  Clock::time_point drawn_;
  bool shown_ = false;
};

}  // namespace dendrofit::cli
