// SPDX-License-Identifier: GPL-3.0-or-later
// Columns of numbers: delimiter, decimal sign, header and columns found out from the first lines, then read
// fast.
#include "core/errors.h"
#include "io/cloud_formats.h"
#include "io/csv_table.h"
#include "io/text_numbers.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace dendrofit {
namespace {

enum Role : std::size_t { kX, kY, kZ, kIntensity, kClass, kRoles };

struct Layout {
  char delimiter = ' ';
  char decimal = '.';
  std::array<int, kRoles> column = {-1, -1, -1, -1, -1};
  std::size_t first_line = 1;  ///< of the data
  std::size_t first_byte = 0;
  std::size_t columns = 0;                      ///< of the first data line
  std::optional<std::uint64_t> claimed_points;  ///< .pts files say it first
};

bool is_comment(std::string_view line) {
  return line.empty() || line.front() == '#' || line.front() == '%' || line.starts_with("//");
}

std::vector<std::string_view> fields_of(std::string_view line, char delimiter) {
  std::vector<std::string_view> fields;
  line = trimmed(line);
  if (delimiter == ' ') {
    while (!line.empty()) {
      const std::size_t stop = std::min(line.find_first_of(" \t"), line.size());
      fields.push_back(line.substr(0, stop));
      line = trimmed(line.substr(stop));
    }
    return fields;
  }
  while (true) {
    const std::size_t stop = line.find(delimiter);
    std::string_view field = trimmed(line.substr(0, stop));
    if (field.size() >= 2 && field.front() == '"' && field.back() == '"')
      field = trimmed(field.substr(1, field.size() - 2));
    fields.push_back(field);
    if (stop == std::string_view::npos) break;
    line.remove_prefix(stop + 1);
  }
  if (fields.size() > 1 && fields.back().empty()) fields.pop_back();  // a delimiter at the line's end
  return fields;
}

bool has_letters(std::string_view line) {
  // Exponents and "nan" alone make no header.
  for (const std::string_view field : fields_of(line, ' ')) {
    std::string word = lower(field);
    for (char& c : word)
      if (c == ',' || c == ';') c = ' ';
    for (const std::string_view part : fields_of(word, ' ')) {
      double ignored = 0;
      const bool letters = std::any_of(part.begin(), part.end(), [](char c) { return c >= 'a' && c <= 'z'; });
      if (letters && !number_from(part, ignored) && !part.starts_with("nan") && !part.starts_with("-nan"))
        return true;
    }
  }
  return false;
}

Role role_named(std::string_view name) {
  std::string word = lower(name);
  word.erase(std::remove_if(word.begin(), word.end(),
                            [](char c) { return c == '/' || c == '#' || c == '"' || c == ' '; }),
             word.end());
  if (const std::size_t unit = word.find_first_of("[("); unit != std::string::npos) word.resize(unit);
  const auto is_any = [&](std::initializer_list<std::string_view> names) {
    return std::find(names.begin(), names.end(), word) != names.end();
  };
  if (is_any({"x", "easting", "east"})) return kX;
  if (is_any({"y", "northing", "north"})) return kY;
  if (is_any({"z", "elevation", "height", "altitude"})) return kZ;
  if (is_any({"i", "intensity", "reflectance", "scalar_intensity", "amplitude"})) return kIntensity;
  if (is_any({"c", "class", "classification", "label", "scalar_classification"})) return kClass;
  return kRoles;
}

std::array<int, kRoles> columns_named(const std::vector<std::string_view>& names) {
  std::array<int, kRoles> column = {-1, -1, -1, -1, -1};
  for (std::size_t k = 0; k < names.size(); ++k) {
    const Role role = role_named(names[k]);
    if (role != kRoles && column[role] < 0) column[role] = static_cast<int>(k);
  }
  return column;
}

bool has_xyz(const std::array<int, kRoles>& column) {
  return column[kX] >= 0 && column[kY] >= 0 && column[kZ] >= 0;
}

// What the sample of content lines says about delimiter and decimal sign; ' ' stands for blanks and tabs.
void find_signs(const FileBytes& bytes, const std::vector<std::string_view>& data, bool has_header,
                Layout& layout) {
  bool semicolon = false;
  bool comma = false;
  bool point = false;
  bool blank = false;        // between two characters that are not blank
  bool comma_blank = false;  // a comma followed by a blank
  for (const std::string_view text : data) {
    for (std::size_t i = 0; i < text.size(); ++i) {
      const char c = text[i];
      semicolon |= c == ';';
      comma |= c == ',';
      point |= c == '.';
      blank |= (c == ' ' || c == '\t') && i > 0 && text[i - 1] != ',' && text[i - 1] != ';';
      comma_blank |= c == ',' && i + 1 < text.size() && (text[i + 1] == ' ' || text[i + 1] == '\t');
    }
  }
  if (semicolon) {
    layout.delimiter = ';';
    layout.decimal = comma && !point ? ',' : '.';
  } else if (comma && (point || comma_blank)) {
    layout.delimiter = ',';
  } else if (comma && blank) {
    layout.decimal = ',';
  } else if (comma) {
    layout.delimiter = ',';
    const std::size_t n = fields_of(data.front(), ',').size();
    if (n >= 6 && n % 2 == 0 && !has_header)  // with one, its number of names tells
      fail_at_line(bytes.path(), layout.first_line,
                   std::to_string(n) +
                       " whole numbers between commas, or half as many with decimal commas: "
                       "it cannot be told; say which with the delimiter and columns options, or save with "
                       "';' between fields");
  }
}

// The same where the caller has said the columns or the delimiter: what is left cannot be mistaken.
void find_signs_told(const std::vector<std::string_view>& data, const ReadCloudOptions& options,
                     Layout& layout) {
  const auto in_all = [&](char c) {
    return std::all_of(data.begin(), data.end(),
                       [&](std::string_view text) { return text.find(c) != std::string_view::npos; });
  };
  if (options.delimiter) {
    layout.decimal = *options.delimiter != ',' && in_all(',') && !in_all('.') ? ',' : '.';
    return;
  }
  const bool blanks = in_all(' ') || in_all('\t');
  layout.delimiter = in_all(';')                                                         ? ';'
                     : in_all(',') && (in_all('.') || !blanks) && options.decimal != ',' ? ','
                                                                                         : ' ';
  layout.decimal = layout.delimiter != ',' && in_all(',') && !in_all('.') ? ',' : '.';
}

Layout find_layout(const FileBytes& bytes, const ReadCloudOptions& options) {
  const std::string_view view = bytes.view();
  Layout layout;
  std::string_view header;
  std::string_view comment_header;
  std::vector<std::string_view> data;
  std::size_t at = text_start(bytes);
  std::size_t line = 0;
  std::size_t header_line = 0;
  while (at < view.size() && data.size() < 50) {
    const std::size_t end = std::min(view.find('\n', at), view.size());
    const std::string_view text = trimmed(view.substr(at, end - at));
    const std::size_t start = at;
    at = end + 1;
    ++line;
    if (is_comment(text)) {
      if (data.empty() && text.size() > 2) comment_header = text;
      continue;
    }
    if (data.empty() && header.empty() && has_letters(text)) {
      header = text;
      header_line = line;
      continue;
    }
    std::int64_t count = 0;
    if (data.empty() && !layout.claimed_points && integer_from(text, count) && count >= 0 &&
        at < view.size()) {
      layout.claimed_points = static_cast<std::uint64_t>(count);
      continue;
    }
    if (data.empty()) {
      layout.first_byte = start;
      layout.first_line = line;
    }
    data.push_back(text);
  }
  if (data.empty())
    fail_at_line(bytes.path(), std::max<std::size_t>(line, 1),
                 "no line of numbers; expected x y z on each line");
  if (!options.delimiter || !options.decimal) {
    Layout found = layout;
    if (!options.delimiter && !options.columns)
      find_signs(bytes, data, !header.empty(), found);
    else
      find_signs_told(data, options, found);
    layout.delimiter = found.delimiter;
    layout.decimal = found.decimal;
  }
  if (options.delimiter) layout.delimiter = *options.delimiter;
  if (options.decimal) layout.decimal = *options.decimal;
  if (layout.delimiter == '\t') layout.delimiter = ' ';
  const std::vector<std::string_view> first = fields_of(data.front(), layout.delimiter);
  layout.columns = first.size();
  if (options.columns) {
    layout.column = columns_named(fields_of(*options.columns, ','));
    if (!has_xyz(layout.column))
      throw InputError("columns '" + *options.columns + "': expected a list with x, y and z");
  } else if (!header.empty()) {
    std::vector<std::string_view> names =
        fields_of(header, header.find(layout.delimiter) != std::string_view::npos ? layout.delimiter
                          : header.find(',') != std::string_view::npos            ? ','
                                                                                  : ' ');
    layout.column = columns_named(names);
    if (!has_xyz(layout.column))
      fail_at_line(
          bytes.path(), header_line,
          "the header " + shown(header) + " names no columns x, y and z; name them with the columns option");
    if (names.size() != layout.columns)
      fail_at_line(bytes.path(), layout.first_line,
                   std::to_string(layout.columns) + " fields; the header names " +
                       std::to_string(names.size()) + " (decimal commas between commas?)");
  } else {
    std::string_view words = comment_header;
    while (!words.empty() && (words.front() == '/' || words.front() == '#' || words.front() == '%'))
      words.remove_prefix(1);
    const std::vector<std::string_view> names =
        fields_of(words, words.find(',') != std::string_view::npos ? ',' : ' ');
    if (names.size() == layout.columns) layout.column = columns_named(names);
    if (!has_xyz(layout.column)) {
      // x y z first; a fourth of four or seven columns is the intensity, as in .pts files.
      layout.column = {0, 1, 2, layout.columns == 4 || layout.columns == 7 ? 3 : -1, -1};
    }
  }
  int needed = 0;
  for (const int c : layout.column) needed = std::max(needed, c + 1);
  if (layout.columns < static_cast<std::size_t>(needed))
    fail_at_line(bytes.path(), layout.first_line,
                 std::to_string(layout.columns) + " columns; expected x, y and z" +
                     (options.columns ? " as the columns option says" : ""));
  return layout;
}

class Reader {
 public:
  Reader(const FileBytes& bytes, const Layout& layout, Progress& progress)
      : bytes_(bytes), layout_(layout), ticker_(progress, "reading", 0), line_(layout.first_line - 1) {
    role_.assign(layout.columns, kRoles);
    for (std::size_t r = 0; r < kRoles; ++r)
      if (layout.column[r] >= 0) role_[static_cast<std::size_t>(layout.column[r])] = static_cast<Role>(r);
  }

  PointCloud read() {
    const char* p = bytes_.data() + layout_.first_byte;
    const char* const end = bytes_.data() + bytes_.size();
    claimed_ = layout_.claimed_points;
    cloud_.points.reserve(static_cast<std::size_t>(end - p) / 32);
    while (p < end) {
      const auto* stop = static_cast<const char*>(std::memchr(p, '\n', static_cast<std::size_t>(end - p)));
      if (!stop) stop = end;
      ++line_;
      read_line(p, stop);
      p = stop + 1;
    }
    if (claimed_ && *claimed_ != cloud_.size())
      fail("the file says it holds " + std::to_string(*claimed_) + " points, " +
           std::to_string(cloud_.size()) + " are there; it is truncated or damaged");
    return std::move(cloud_);
  }

 private:
  [[noreturn]] void fail(const std::string& what) const { fail_at_line(bytes_.path(), line_, what); }

  static const char* past_blanks(const char* p, const char* end) {
    while (p != end && (*p == ' ' || *p == '\t' || *p == '\r')) ++p;
    return p;
  }

  [[noreturn]] void fail_number(const char* p, const char* end, std::size_t column) const {
    const char* stop = p;
    while (stop != end && *stop != layout_.delimiter && *stop != ' ' && *stop != '\t' && *stop != '\r')
      ++stop;
    fail("column " + std::to_string(column + 1) + ": " + shown({p, static_cast<std::size_t>(stop - p)}) +
         " found, a number expected" + (layout_.decimal == ',' ? " (with decimal comma)" : ""));
  }

  void read_line(const char* p, const char* end) {
    p = past_blanks(p, end);
    if (p == end || *p == '#' || *p == '%' || (*p == '/' && end - p > 1 && p[1] == '/')) return;
    const char* const begin = p;
    std::array<double, kRoles> value{};
    std::size_t column = 0;
    while (p != end) {
      if (column >= layout_.columns)
        fail("more than the " + std::to_string(layout_.columns) + " columns of the first line");
      if (role_[column] != kRoles) {
        const char* field = p;
        const bool in_quotes = *p == '"';
        p = parse_number(p + in_quotes, end, value[role_[column]], layout_.decimal);
        if (!p) fail_number(field, end, column);
        if (in_quotes && p != end && *p == '"') ++p;
        if (p != end && *p != layout_.delimiter && *p != ' ' && *p != '\t' && *p != '\r')
          fail_number(field, end, column);
      } else {
        while (p != end && *p != layout_.delimiter && !(layout_.delimiter == ' ' && *p == '\t')) ++p;
      }
      ++column;
      p = past_blanks(p, end);
      if (layout_.delimiter != ' ' && p != end) {
        if (*p != layout_.delimiter) fail_number(p, end, column - 1);
        p = past_blanks(p + 1, end);
      }
    }
    if (column != layout_.columns) return short_line({begin, static_cast<std::size_t>(end - begin)}, column);
    const Vec3 point(value[kX], value[kY], value[kZ]);
    if (!point.allFinite()) fail("a coordinate that is not a finite number; remove the point");
    cloud_.points.push_back(point);
    if (layout_.column[kIntensity] >= 0) cloud_.intensity.push_back(static_cast<float>(value[kIntensity]));
    if (layout_.column[kClass] >= 0)
      cloud_.classification.push_back(value[kClass] >= 0 && value[kClass] <= 255
                                          ? static_cast<std::uint8_t>(value[kClass])
                                          : std::uint8_t{0});
    ticker_.tick();
  }

  // Another scan's number of points in a .pts file, else a line that lacks columns.
  void short_line(std::string_view text, std::size_t columns) {
    std::int64_t count = 0;
    if (!claimed_ || columns != 1 || !integer_from(text, count) || count < 0)
      fail(std::to_string(columns) + " columns; the first line has " + std::to_string(layout_.columns) +
           " (truncated?)");
    claimed_ = *claimed_ + static_cast<std::uint64_t>(count);
  }

  const FileBytes& bytes_;
  const Layout& layout_;
  PointTicker ticker_;
  std::size_t line_;
  std::vector<Role> role_;
  std::optional<std::uint64_t> claimed_;
  PointCloud cloud_;
};

}  // namespace

PointCloud read_text_cloud(const FileBytes& bytes, const ReadCloudOptions& options, Progress& progress) {
  require_text(bytes);
  const Layout layout = find_layout(bytes, options);
  return Reader(bytes, layout, progress).read();
}

}  // namespace dendrofit
