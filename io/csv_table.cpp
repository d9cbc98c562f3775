// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/csv_table.h"

#include "io/text_numbers.h"

#include <algorithm>
#include <cmath>

namespace dendrofit {
namespace {

char delimiter_of(std::string_view line) {
  char best = ' ';
  std::ptrdiff_t most = 0;
  for (const char candidate : {'\t', ';', ','}) {
    const std::ptrdiff_t count = std::count(line.begin(), line.end(), candidate);
    if (count > most) {
      most = count;
      best = candidate;
    }
  }
  return best;
}

std::string_view unquoted(std::string_view field) {
  field = trimmed(field);
  if (field.size() >= 2 && field.front() == '"' && field.back() == '"')
    field = trimmed(field.substr(1, field.size() - 2));
  return field;
}

}  // namespace

void require_text(const FileBytes& bytes) {
  const std::string_view view = bytes.view();
  if (view.starts_with("\xff\xfe") || view.starts_with("\xfe\xff"))
    fail_at_byte(bytes.path(), 0, "UTF-16 text; save it as UTF-8 or plain text");
  const std::size_t zero = view.substr(0, 4096).find('\0');
  if (zero != std::string_view::npos)
    fail_at_byte(bytes.path(), zero,
                 "a zero byte where text was expected; the file is binary, of a format not known here, "
                 "or damaged");
}

std::size_t text_start(const FileBytes& bytes) {
  return bytes.view().starts_with("\xef\xbb\xbf") ? 3 : 0;
}

CsvTable::CsvTable(const FileBytes& bytes) : bytes_(bytes), at_(text_start(bytes)) {
  require_text(bytes);
  std::string_view line;
  if (!next_line(line)) fail_in_file(bytes.path(), "no header line; expected the names of the columns first");
  delimiter_ = delimiter_of(line);
  std::vector<std::string_view> names;
  split(line, names);
  for (const std::string_view name : names) header_.emplace_back(name);
  // R's write.table with row names leaves the first header cell empty; a trailing delimiter does so with the
  // last.
  fields_.reserve(header_.size());
}

int CsvTable::find(std::string_view name) const {
  const std::string wanted = lower(name);
  for (std::size_t i = 0; i < header_.size(); ++i)
    if (lower(header_[i]) == wanted) return static_cast<int>(i);
  return -1;
}

std::size_t CsvTable::column(std::string_view name) const {
  const int found = find(name);
  if (found >= 0) return static_cast<std::size_t>(found);
  std::string names;
  for (const std::string& known : header_) names += (names.empty() ? "" : ", ") + known;
  if (names.size() > 300) names = names.substr(0, 300) + "...";
  fail("column '" + std::string(name) + "' is missing; found: " + names);
}

bool CsvTable::next_line(std::string_view& line) {
  const std::string_view view = bytes_.view();
  while (at_ < view.size()) {
    const std::size_t end = std::min(view.find('\n', at_), view.size());
    line = view.substr(at_, end - at_);
    at_ = end + 1;
    ++line_;
    const std::string_view content = trimmed(line);
    if (!content.empty() && content.front() != '#') {
      if (line.back() == '\r') line.remove_suffix(1);
      return true;
    }
  }
  return false;
}

void CsvTable::split(std::string_view line, std::vector<std::string_view>& fields) const {
  fields.clear();
  if (delimiter_ == ' ') {
    line = trimmed(line);
    while (!line.empty()) {
      const bool in_quotes = line.front() == '"';
      std::size_t end = in_quotes ? line.find('"', 1) : line.find_first_of(" \t");
      end = end == std::string_view::npos ? line.size() : end + (in_quotes ? 1 : 0);
      fields.push_back(unquoted(line.substr(0, end)));
      line = trimmed(line.substr(end));
    }
    return;
  }
  std::size_t from = 0;
  bool in_quotes = false;
  for (std::size_t i = 0; i <= line.size(); ++i) {
    if (i < line.size() && line[i] == '"') in_quotes = !in_quotes;
    if (i < line.size() && (line[i] != delimiter_ || in_quotes)) continue;
    fields.push_back(unquoted(line.substr(from, i - from)));
    from = i + 1;
  }
}

bool CsvTable::next() {
  std::string_view line;
  if (!next_line(line)) return false;
  split(line, fields_);
  if (fields_.size() != header_.size())
    fail(std::to_string(fields_.size()) + " fields; the header has " + std::to_string(header_.size()) +
         (delimiter_ == ',' && fields_.size() > header_.size()
              ? " (decimal commas? then put semicolons between the columns)"
              : " (truncated file, or a delimiter inside a field?)"));
  return true;
}

bool CsvTable::missing(std::size_t column) const {
  const std::string word = lower(fields_[column]);
  return word.empty() || word == "na" || word == "nan";
}

double CsvTable::number(std::size_t column) const {
  const std::string_view field = fields_[column];
  double value = 0;
  const bool fine = number_from(field, value) || (delimiter_ != ',' && number_from(field, value, ','));
  if (!fine) fail("column '" + header_[column] + "': " + shown(field) + " found, a number expected");
  if (!std::isfinite(value))
    fail("column '" + header_[column] + "': " + shown(field) + " found, a finite number expected");
  return value;
}

std::int64_t CsvTable::integer(std::size_t column) const {
  std::int64_t value = 0;
  if (!integer_from(fields_[column], value))
    fail("column '" + header_[column] + "': " + shown(fields_[column]) + " found, a whole number expected");
  return value;
}

}  // namespace dendrofit
