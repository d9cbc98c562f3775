// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/text_numbers.h"

#include <array>
#include <charconv>
#include <cmath>

namespace dendrofit {
namespace {

constexpr std::array<double, 23> kPowersOfTen = {1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,
                                                 1e8,  1e9,  1e10, 1e11, 1e12, 1e13, 1e14, 1e15,
                                                 1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};

bool is_digit(char c) {
  return static_cast<unsigned char>(c - '0') < 10;
}

// The library's correctly rounded parser, on a copy where the decimal sign is not its own.
const char* parse_slowly(const char* at, const char* end, double& value, char decimal) {
  if (decimal == '.') {
    const auto [rest, error] = std::from_chars(at, end, value);
    if (error == std::errc::result_out_of_range) {
      value = std::strtod(std::string(at, rest).c_str(), nullptr);
      return rest;
    }
    return error == std::errc() ? rest : nullptr;
  }
  std::string copy(at, std::min<std::size_t>(static_cast<std::size_t>(end - at), 400));
  for (char& c : copy) c = c == decimal ? '.' : c == '.' ? ' ' : c;
  const char* rest = parse_slowly(copy.data(), copy.data() + copy.size(), value, '.');
  return rest ? at + (rest - copy.data()) : nullptr;
}

}  // namespace

const char* parse_number(const char* at, const char* end, double& value, char decimal) {
  if (at != end && *at == '+') {
    ++at;
    if (at != end && (*at == '-' || *at == '+')) return nullptr;
  }
  // Clinger's exact case: a mantissa below 2^53 times or over a power of ten up to 10^22 is one rounding.
  const char* p = at;
  const bool negative = p != end && *p == '-';
  if (negative) ++p;
  std::uint64_t mantissa = 0;
  const char* digits = p;
  while (p != end && is_digit(*p)) mantissa = mantissa * 10 + static_cast<std::uint64_t>(*p++ - '0');
  std::ptrdiff_t count = p - digits;
  std::ptrdiff_t decimals = 0;
  if (p != end && *p == decimal) {
    const char* fraction = ++p;
    while (p != end && is_digit(*p)) mantissa = mantissa * 10 + static_cast<std::uint64_t>(*p++ - '0');
    decimals = p - fraction;
    count += decimals;
  }
  const bool plain = p == end || (*p != 'e' && *p != 'E');
  if (count > 0 && count <= 19 && plain && mantissa <= (1ULL << 53) && decimals <= 22) {
    const double magnitude = static_cast<double>(mantissa) / kPowersOfTen[static_cast<std::size_t>(decimals)];
    value = negative ? -magnitude : magnitude;
    return p;
  }
  return parse_slowly(at, end, value, decimal);
}

bool number_from(std::string_view field, double& value, char decimal) {
  field = trimmed(field);
  if (field.empty()) return false;
  const char* end = field.data() + field.size();
  return parse_number(field.data(), end, value, decimal) == end;
}

bool integer_from(std::string_view field, std::int64_t& value, char decimal) {
  double number = 0;
  if (!number_from(field, number, decimal)) return false;
  if (!(std::abs(number) <= 9e15) || number != std::floor(number)) return false;
  value = static_cast<std::int64_t>(number);
  return true;
}

void append_number(std::string& text, double value) {
  if (std::isnan(value)) return;
  // Shortest digits that read back the same, without an exponent where people expect none (500000, not
  // 5e+05).
  char buffer[48];
  const double size = std::abs(value);
  const bool plain = (size >= 1e-5 && size < 1e15) || size == 0;
  const auto format = plain ? std::chars_format::fixed : std::chars_format::scientific;
  const auto [end, error] = std::to_chars(buffer, buffer + sizeof(buffer), value + 0.0, format);
  text.append(buffer, end);
}

void append_number(std::string& text, std::int64_t value) {
  char buffer[24];
  const auto [end, error] = std::to_chars(buffer, buffer + sizeof(buffer), value);
  text.append(buffer, end);
}

void append_fixed(std::string& text, double value, int decimals) {
  char buffer[400];
  const auto [end, error] =
      std::to_chars(buffer, buffer + sizeof(buffer), value + 0.0, std::chars_format::fixed, decimals);
  if (error == std::errc()) text.append(buffer, end);
}

std::string_view trimmed(std::string_view text) {
  const auto blank = [](char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\n'; };
  while (!text.empty() && blank(text.front())) text.remove_prefix(1);
  while (!text.empty() && blank(text.back())) text.remove_suffix(1);
  return text;
}

std::vector<std::string_view> words_of(std::string_view line) {
  std::vector<std::string_view> words;
  line = trimmed(line);
  while (!line.empty()) {
    const std::size_t stop = std::min(line.find_first_of(" \t"), line.size());
    words.push_back(line.substr(0, stop));
    line = trimmed(line.substr(stop));
  }
  return words;
}

std::string lower(std::string_view text) {
  std::string result(text);
  for (char& c : result)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return result;
}

}  // namespace dendrofit
