// SPDX-License-Identifier: GPL-3.0-or-later
// A model's parameters as one table, which feeds its files, help text, search scaling and bounds.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace dendrofit {

/// One row of a model's parameter table.
struct ParameterSpec {
  std::string_view key;     ///< in files and on the command line
  std::string_view symbol;  ///< in the source's equations
  std::string_view unit;    ///< "" for a pure number
  double default_value = 0;
  double lo = 0;  ///< inclusive
  double hi = 0;  ///< inclusive
  std::string_view meaning;
  std::string_view source;  ///< paper and equation, or why this value
};

/// Values for the rows of a table, in its order.
class ParameterSet {
 public:
  explicit ParameterSet(std::span<const ParameterSpec> table);

  std::span<const ParameterSpec> table() const { return table_; }
  std::span<const double> values() const { return values_; }
  /// Throws InputError for an unknown key (naming the nearest known one).
  double get(std::string_view key) const;
  /// Throws InputError for an unknown key, or a value that is not finite or outside the row's bounds; `where`
  /// (file and line, or "--set") leads the message.
  void set(std::string_view key, double value, std::string_view where = "");
  bool knows(std::string_view key) const;

 private:
  std::size_t row(std::string_view key, std::string_view where) const;
  std::span<const ParameterSpec> table_;
  std::vector<double> values_;
};

/// The candidate closest in spelling to `word` (edit distance), for "did you mean" messages; empty without
/// candidates.
std::string nearest_word(std::string_view word, const std::vector<std::string>& candidates);

}  // namespace dendrofit
