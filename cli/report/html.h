// SPDX-License-Identifier: GPL-3.0-or-later
// The small words of a web page: escaping, numbers, tables.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace dendrofit {

/// Text made safe between tags and inside quoted attributes; bytes that are not UTF-8 become U+FFFD, control
/// characters vanish.
std::string escape_html(std::string_view text);
/// A JSON string literal with its quotes, safe inside <script> ("<" is escaped); same treatment of odd bytes.
std::string quote_json(std::string_view text);

/// Four significant digits without trailing zeros; "–" for what is not finite.
std::string number(double value);
std::string number(const std::optional<double>& value);
/// Three significant digits, zeros at the end kept, and never fewer than the whole number has: 6.20, 0.0512,
/// 4958; "–" for what is not finite.
std::string measured(double value);
/// `decimals` digits after the point; "–" for what is not finite.
std::string fixed(double value, int decimals);
/// A JSON number; null for what is not finite.
std::string json_number(double value);

std::string base64(std::string_view bytes);

/// A table whose cells are already HTML. Cells of `numeric` columns are right-aligned; each cell repeats its
/// column's name for narrow screens, where rows become cards.
struct HtmlTable {
  std::string id;
  std::string caption;
  std::vector<std::string> columns;
  std::vector<char> numeric;  ///< one a column
  std::vector<std::vector<std::string>> rows;
  std::string html() const;
};

}  // namespace dendrofit
