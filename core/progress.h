// SPDX-License-Identifier: GPL-3.0-or-later
// How a verb tells how far it is, and how it learns that the user wants to stop.
#pragma once

#include <atomic>
#include <string_view>

namespace dendrofit {

/// Verbs call begin / advance / end and, at least every tenth of a second, check(). Methods may be called
/// from any thread. The base class reports to nobody and is never cancelled unless given a flag.
class Progress {
 public:
  explicit Progress(const std::atomic<bool>* cancel = nullptr) : cancel_(cancel) {}
  virtual ~Progress() = default;
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  /// A new stage of `total` units ("points", "cycles", ...); total 0 where it is unknown.
  virtual void begin(std::string_view /*stage*/, double /*total*/, std::string_view /*unit*/) {}
  virtual void advance(double /*amount*/) {}
  /// A word beside the bar, e.g. the best cost so far.
  virtual void remark(std::string_view /*text*/) {}
  virtual void end() {}

  bool cancelled() const { return cancel_ && cancel_->load(std::memory_order_relaxed); }
  /// Throws Cancelled when the user has asked to stop.
  void check() const;

 private:
  const std::atomic<bool>* cancel_;
};

/// The listener that listens to nothing; the default argument of every verb.
Progress& no_progress();

}  // namespace dendrofit
