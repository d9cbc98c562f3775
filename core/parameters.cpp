// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/parameters.h"

#include "core/errors.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <sstream>

namespace dendrofit {
namespace {

std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t replaced = diagonal + (a[i - 1] == b[j - 1] ? 0 : 1);
      diagonal = row[j];
      row[j] = std::min({row[j] + 1, row[j - 1] + 1, replaced});
    }
  }
  return row[b.size()];
}

std::string lead(std::string_view where) {
  return where.empty() ? std::string() : std::string(where) + ": ";
}

}  // namespace

std::string nearest_word(std::string_view word, const std::vector<std::string>& candidates) {
  const auto best = std::min_element(candidates.begin(), candidates.end(), [&](const auto& a, const auto& b) {
    return edit_distance(word, a) < edit_distance(word, b);
  });
  return best == candidates.end() ? std::string() : *best;
}

ParameterSet::ParameterSet(std::span<const ParameterSpec> table) : table_(table) {
  values_.reserve(table.size());
  for (const ParameterSpec& spec : table) values_.push_back(spec.default_value);
}

bool ParameterSet::knows(std::string_view key) const {
  return std::any_of(table_.begin(), table_.end(),
                     [&](const ParameterSpec& spec) { return spec.key == key; });
}

std::size_t ParameterSet::row(std::string_view key, std::string_view where) const {
  for (std::size_t i = 0; i < table_.size(); ++i)
    if (table_[i].key == key) return i;
  std::vector<std::string> known;
  for (const ParameterSpec& spec : table_) known.emplace_back(spec.key);
  throw InputError(lead(where) + "unknown parameter '" + std::string(key) + "'; did you mean '" +
                   nearest_word(key, known) + "'?");
}

double ParameterSet::get(std::string_view key) const {
  return values_[row(key, "")];
}

void ParameterSet::set(std::string_view key, double value, std::string_view where) {
  const std::size_t i = row(key, where);
  const ParameterSpec& spec = table_[i];
  if (!std::isfinite(value) || value < spec.lo || value > spec.hi) {
    std::ostringstream message;
    message << lead(where) << spec.key << " = " << value << ": must be a number between " << spec.lo
            << " and " << spec.hi;
    if (!spec.unit.empty()) message << " " << spec.unit;
    throw InputError(message.str());
  }
  values_[i] = value;
}

}  // namespace dendrofit
