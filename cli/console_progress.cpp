// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/console_progress.h"

#include <algorithm>
#include <cstdio>

#include <fmt/format.h>
#include <unistd.h>

namespace dendrofit::cli {
namespace {

constexpr auto kFirstBar = std::chrono::milliseconds(500);  // nothing shorter needs a bar
constexpr auto kBarEvery = std::chrono::milliseconds(100);
constexpr auto kLineEvery = std::chrono::seconds(5);
constexpr int kBarWidth = 24;

std::string clock_text(double seconds) {
  const auto s = static_cast<long>(seconds + 0.5);
  return s < 3600 ? fmt::format("{}:{:02}", s / 60, s % 60)
                  : fmt::format("{}:{:02}:{:02}", s / 3600, s / 60 % 60, s % 60);
}

std::string short_number(double value) {
  if (value >= 1e6) return fmt::format("{:.1f}M", value / 1e6);
  if (value >= 1e4) return fmt::format("{:.0f}k", value / 1e3);
  return fmt::format("{:.0f}", value);
}

}  // namespace

ConsoleProgress::Style ConsoleProgress::style_for(const std::string& mode, bool quiet) {
  if (quiet || mode == "none") return Style::none;
  return mode == "auto" && ::isatty(STDERR_FILENO) ? Style::bar : Style::plain;
}

void ConsoleProgress::begin(std::string_view stage, double total, std::string_view unit) {
  const std::lock_guard lock(mutex_);
  stage_ = stage;
  unit_ = unit;
  remark_.clear();
  total_ = total;
  done_ = 0;
  started_ = drawn_ = Clock::now();
  shown_ = false;
}

void ConsoleProgress::advance(double amount) {
  if (style_ == Style::none) return;
  const std::lock_guard lock(mutex_);
  done_ += amount;
  if (total_ > 0) done_ = std::min(done_, total_);
  const auto now = Clock::now();
  if (style_ == Style::bar ? (now - started_ < kFirstBar || now - drawn_ < kBarEvery)
                           : now - drawn_ < kLineEvery)
    return;
  draw(now);
}

void ConsoleProgress::remark(std::string_view text) {
  const std::lock_guard lock(mutex_);
  remark_ = text;
}

void ConsoleProgress::draw(Clock::time_point now) {
  drawn_ = now;
  shown_ = true;
  const double elapsed = std::chrono::duration<double>(now - started_).count();
  const double rate = elapsed > 0 ? done_ / elapsed : 0;
  std::string line;
  if (total_ > 0) {
    const double share = std::clamp(done_ / total_, 0.0, 1.0);
    const int full = static_cast<int>(share * kBarWidth);
    const std::string bar = std::string(static_cast<std::size_t>(full), '#') +
                            std::string(static_cast<std::size_t>(kBarWidth - full), '.');
    line = fmt::format("{:<26} [{}] {:3.0f} %  {}/{} {}  {}/s", stage_, bar, 100 * share, short_number(done_),
                       short_number(total_), unit_, short_number(rate));
    if (rate > 0 && share < 1) line += fmt::format("  {} left", clock_text((total_ - done_) / rate));
  } else {
    line = fmt::format("{:<26} {} {}  {}", stage_, short_number(done_), unit_, clock_text(elapsed));
  }
  if (!remark_.empty()) line += "  " + remark_;
  if (style_ == Style::bar)
    std::fputs(("\r\033[K" + line).c_str(), stderr);
  else
    std::fputs((line + "\n").c_str(), stderr);
  std::fflush(stderr);
}

void ConsoleProgress::end() {
  const std::lock_guard lock(mutex_);
  if (style_ == Style::bar && shown_) {
    std::fputs("\r\033[K", stderr);
    std::fflush(stderr);
  }
  shown_ = false;
}

}  // namespace dendrofit::cli
