// SPDX-License-Identifier: GPL-3.0-or-later
// What a fit has simulated so far, so that an interrupted one goes on without doing it again: since every
// simulation is keyed, replaying the fit with the log at hand gives what an uninterrupted run gives.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace dendrofit {

class SimulationLog {
 public:
  /// `identity`: a digest of all that decides the fit's result; a log is of use to the same fit alone.
  explicit SimulationLog(std::uint64_t identity) : identity_(identity) {}

  /// Descriptors of the simulation with this key, or nullptr.
  const std::vector<double>* find(std::uint64_t key) const;
  void add(std::uint64_t key, std::vector<double> descriptors);
  std::size_t size() const { return known_.size(); }

  /// Seconds spent on the fit before this run.
  double earlier_seconds() const { return earlier_seconds_; }

  std::string bytes(double seconds) const;
  /// Takes over what bytes() wrote. Throws InputError when it belongs to another fit, IoError when it is
  /// damaged.
  void restore(std::string_view bytes);

 private:
  std::uint64_t identity_;
  double earlier_seconds_ = 0;
  std::map<std::uint64_t, std::vector<double>> known_;
};

/// Digest of numbers and text, for SimulationLog's identity.
class Digest {
 public:
  Digest& add(std::string_view text);
  Digest& add(double value);
  std::uint64_t value() const { return hash_; }

 private:
  std::uint64_t hash_ = 0xcbf29ce484222325ULL;  // FNV-1a
};

}  // namespace dendrofit
