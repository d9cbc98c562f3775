// SPDX-License-Identifier: GPL-3.0-or-later
// Tables with a header line: delimiter, quotes, decimal comma and line ends found out, every complaint with
// its line.
#pragma once

#include "io/file_bytes.h"

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace dendrofit {

/// Reads a table row by row. The delimiter is the header's most frequent of comma, semicolon and tab (blanks,
/// where it has none of them). Fields may stand in double quotes. Empty lines and lines starting with '#' are
/// passed over. Holds views into `bytes`, which must outlive it.
class CsvTable {
 public:
  /// Throws IoError for binary content, UTF-16, or no header.
  explicit CsvTable(const FileBytes& bytes);

  const std::vector<std::string>& header() const { return header_; }
  char delimiter() const { return delimiter_; }
  /// Column of this name (case and blanks ignored), -1 without one.
  int find(std::string_view name) const;
  /// The same; throws IoError listing the columns that were found.
  std::size_t column(std::string_view name) const;

  /// Goes to the next row; false at the end. Throws IoError when its number of fields is not the header's.
  bool next();
  std::size_t line() const { return line_; }
  /// The current row's field, without quotes and blanks around it.
  std::string_view text(std::size_t column) const { return fields_[column]; }
  bool missing(std::size_t column) const;  ///< empty, NA or NaN
  /// A finite number or integer in the current row; throws IoError naming line, column and what was found.
  double number(std::size_t column) const;
  std::int64_t integer(std::size_t column) const;
  [[noreturn]] void fail(const std::string& what) const { fail_at_line(bytes_.path(), line_, what); }

 private:
  bool next_line(std::string_view& line);
  void split(std::string_view line, std::vector<std::string_view>& fields) const;

  const FileBytes& bytes_;
  std::size_t at_ = 0;
  std::size_t line_ = 0;
  char delimiter_ = ',';
  std::vector<std::string> header_;
  std::vector<std::string_view> fields_;
};

/// Throws IoError when the file is not text: UTF-16 (with the remedy) or zero bytes among its first 4096.
void require_text(const FileBytes& bytes);
/// Where the text starts: 3 after a UTF-8 byte order mark, else 0.
std::size_t text_start(const FileBytes& bytes);

}  // namespace dendrofit
