// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/report/html.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>

namespace dendrofit {
namespace {

/// Calls emit(code point's bytes) for each sound UTF-8 sequence, with U+FFFD for each byte that is none.
template <class Emit>
void each_character(std::string_view text, const Emit& emit) {
  for (std::size_t i = 0; i < text.size();) {
    const auto lead = static_cast<unsigned char>(text[i]);
    const std::size_t length = lead < 0x80                   ? 1
                               : lead >= 0xc2 && lead < 0xe0 ? 2
                               : lead >= 0xe0 && lead < 0xf0 ? 3
                               : lead >= 0xf0 && lead < 0xf5 ? 4
                                                             : 0;
    bool sound = length > 0 && i + length <= text.size();
    for (std::size_t k = 1; sound && k < length; ++k)
      sound = (static_cast<unsigned char>(text[i + k]) & 0xc0) == 0x80;
    emit(sound ? text.substr(i, length) : std::string_view("\xef\xbf\xbd"));
    i += sound ? length : 1;
  }
}

std::string formatted(const char* format, double value) {
  char text[64];
  std::snprintf(text, sizeof text, format, value);
  return text;
}

constexpr const char* kDash = "\xe2\x80\x93";

}  // namespace

std::string escape_html(std::string_view text) {
  std::string out;
  each_character(text, [&](std::string_view c) {
    if (c == "&")
      out += "&amp;";
    else if (c == "<")
      out += "&lt;";
    else if (c == ">")
      out += "&gt;";
    else if (c == "\"")
      out += "&quot;";
    else if (c == "'")
      out += "&#39;";
    else if (c.size() > 1 || static_cast<unsigned char>(c[0]) >= 32 || c == "\n" || c == "\t")
      out += c;
  });
  return out;
}

std::string quote_json(std::string_view text) {
  std::string out = "\"";
  each_character(text, [&](std::string_view c) {
    const auto code = static_cast<unsigned char>(c[0]);
    if (c.size() > 1) {
      out += c;
    } else if (code < 32 || code == 127 || c == "<" || c == ">" || c == "&" || c == "\"" || c == "\\" ||
               c == "'") {
      char escaped[8];
      std::snprintf(escaped, sizeof escaped, "\\u%04x", code);
      out += escaped;
    } else {
      out += c;
    }
  });
  return out + "\"";
}

std::string number(double value) {
  if (!std::isfinite(value)) return kDash;
  const double size = std::abs(value);
  if (size >= 1000 && size < 1e7) return formatted("%.0f", value);
  std::string text = formatted("%.4g", value);
  return text == "-0" ? "0" : text;
}

std::string number(const std::optional<double>& value) {
  return value ? number(*value) : kDash;
}

std::string measured(double value) {
  if (!std::isfinite(value)) return kDash;
  const double size = std::abs(value);
  // 9.996 is 10.0: what rounding makes of it counts.
  const double magnitude = size > 0 ? std::floor(std::log10(size * (1 + 5e-4))) : 0;
  return fixed(value, static_cast<int>(std::clamp(2 - magnitude, 0.0, 9.0)));
}

std::string fixed(double value, int decimals) {
  if (!std::isfinite(value)) return kDash;
  char text[64];
  std::snprintf(text, sizeof text, "%.*f", decimals, value);
  return text;
}

std::string json_number(double value) {
  return std::isfinite(value) ? formatted("%.9g", value) : std::string("null");
}

std::string base64(std::string_view bytes) {
  constexpr char kDigits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  out.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t group = 0;
    for (std::size_t k = 0; k < 3; ++k)
      group = group << 8 | (i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0u);
    for (std::size_t k = 0; k < 4; ++k)
      out.push_back(i + k <= bytes.size() ? kDigits[group >> (18 - 6 * k) & 63] : '=');
  }
  return out;
}

std::string HtmlTable::html() const {
  const auto kind = [&](std::size_t c) { return c < numeric.size() && numeric[c] ? " class=\"n\"" : ""; };
  std::string out = "<div class=\"scroll\"><table id=\"" + escape_html(id) + "\">";
  if (!caption.empty()) out += "<caption>" + escape_html(caption) + "</caption>";
  out += "<thead><tr>";
  for (std::size_t c = 0; c < columns.size(); ++c)
    out += std::string("<th scope=\"col\"") + kind(c) + ">" + escape_html(columns[c]) + "</th>";
  out += "</tr></thead><tbody>\n";
  for (const auto& row : rows) {
    out += "<tr>";
    for (std::size_t c = 0; c < row.size(); ++c) {
      const std::string name = c < columns.size() ? " data-name=\"" + escape_html(columns[c]) + "\"" : "";
      out += c == 0 ? "<th scope=\"row\">" + row[c] + "</th>"
                    : std::string("<td") + kind(c) + name + "><span>" + row[c] + "</span></td>";
    }
    out += "</tr>\n";
  }
  return out + "</tbody></table></div>\n";
}

}  // namespace dendrofit
