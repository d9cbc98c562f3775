// SPDX-License-Identifier: GPL-3.0-or-later
// Numbers with units as people type them.
#pragma once

#include <string>
#include <string_view>

namespace dendrofit::cli {

/// What a command-line number measures; decides the suffixes it may carry.
enum class Quantity {
  pure,      ///< no suffix
  length,    ///< m (default), mm, cm, km, ft, in
  angle,     ///< deg (default), rad; parsed to degrees
  area,      ///< m2 (default), cm2, ha, ft2
  duration,  ///< s (default), min, h
};

/// The number in the quantity's base unit. Throws std::invalid_argument saying what was found and what is
/// allowed.
double parse_quantity(std::string_view text, Quantity quantity);

/// The reverse, for help texts and run.toml: 0.005 and length -> "5mm". Parses back to the same number.
std::string format_quantity(double value, Quantity quantity);

/// "m", "deg", ...; "" for pure numbers.
std::string_view base_unit(Quantity quantity);

}  // namespace dendrofit::cli
