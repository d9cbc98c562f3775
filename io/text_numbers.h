// SPDX-License-Identifier: GPL-3.0-or-later
// Numbers from and to text, fast and exact: what is printed reads back bit for bit.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace dendrofit {

/// Parses a decimal number (with `decimal` as its point) at the front of [at, end). Returns the first
/// character not used, or nullptr when there is no number. Correctly rounded. Accepts a leading '+', "nan"
/// and "inf" in any case.
const char* parse_number(const char* at, const char* end, double& value, char decimal = '.');

/// The whole field as a number; false when any of it is something else. Blanks around it are ignored.
bool number_from(std::string_view field, double& value, char decimal = '.');
/// The whole field as an integer; also "3.0" and "3e0". False for fractions and anything else.
bool integer_from(std::string_view field, std::int64_t& value, char decimal = '.');

/// Appends the shortest text that reads back as `value`. NaN appends nothing, minus zero is zero.
void append_number(std::string& text, double value);
void append_number(std::string& text, std::int64_t value);
/// With a fixed number of decimals.
void append_fixed(std::string& text, double value, int decimals);

/// Without blanks, tabs and carriage returns on either side.
std::string_view trimmed(std::string_view text);
/// What stands between blanks and tabs, in order; the views look into `line`.
std::vector<std::string_view> words_of(std::string_view line);
/// ASCII letters in lower case.
std::string lower(std::string_view text);

}  // namespace dendrofit
