// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/units.h"

#include <array>
#include <charconv>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <vector>

#include <fmt/format.h>

namespace dendrofit::cli {
namespace {

struct Suffix {
  std::string_view text;
  double factor;
};

/// The first suffix of each list is the base unit.
const std::vector<Suffix>& suffixes(Quantity quantity) {
  static const std::array<std::vector<Suffix>, 5> kTable = {{
      {},
      {{"m", 1}, {"mm", 1e-3}, {"cm", 1e-2}, {"km", 1e3}, {"ft", 0.3048}, {"in", 0.0254}},
      {{"deg", 1}, {"rad", 180 / std::numbers::pi}},
      {{"m2", 1}, {"cm2", 1e-4}, {"ha", 1e4}, {"ft2", 0.3048 * 0.3048}},
      {{"s", 1}, {"min", 60}, {"h", 3600}},
  }};
  return kTable[static_cast<std::size_t>(quantity)];
}

std::string allowed(Quantity quantity) {
  std::string list;
  for (const Suffix& s : suffixes(quantity)) list += (list.empty() ? "" : ", ") + std::string(s.text);
  return list.empty() ? "a plain number" : "a number, optionally with " + list;
}

}  // namespace

double parse_quantity(std::string_view text, Quantity quantity) {
  double number = 0;
  const char* begin = text.data();
  const char* end = begin + text.size();
  if (begin != end && *begin == '+') ++begin;
  const auto [rest, error] = std::from_chars(begin, end, number);
  if (error != std::errc() || !std::isfinite(number))
    throw std::invalid_argument(fmt::format("'{}' is not a number; expected {}", text, allowed(quantity)));
  std::string_view unit(rest, static_cast<std::size_t>(end - rest));
  while (!unit.empty() && unit.front() == ' ') unit.remove_prefix(1);
  if (unit.empty()) return number;
  for (const Suffix& s : suffixes(quantity))
    if (s.text == unit) return number * s.factor;
  throw std::invalid_argument(
      fmt::format("'{}': unknown unit '{}'; expected {}", text, unit, allowed(quantity)));
}

std::string_view base_unit(Quantity quantity) {
  return suffixes(quantity).empty() ? std::string_view() : suffixes(quantity).front().text;
}

std::string format_quantity(double value, Quantity quantity) {
  if (quantity == Quantity::length && value != 0 && std::abs(value) < 0.1) {
    const std::string millimetres = fmt::format("{}mm", value * 1e3);
    if (millimetres.size() < 8 && parse_quantity(millimetres, quantity) == value) return millimetres;
  }
  return fmt::format("{}{}", value, base_unit(quantity));
}

}  // namespace dendrofit::cli
