// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/atomic_file.h"
#include "io/cylinder_table.h"
#include "io/text_numbers.h"
#include "io/tree_formats.h"

#include <cmath>

namespace dendrofit {
namespace {

// Positions of the columns that a tree is made of; the first eight are the same in all versions.
struct Layout {
  std::size_t columns;
  std::size_t branch;
  std::size_t order;
};
constexpr Layout kCurrent{17, 10, 11};
constexpr Layout kOlder{15, 12, 13};

// Splits at tabs, blanks or commas; returns false at the end of the text.
class Lines {
 public:
  explicit Lines(const FileBytes& bytes) : view_(bytes.view()), at_(text_start(bytes)) {}
  bool next(std::vector<std::string_view>& fields) {
    while (at_ < view_.size()) {
      const std::size_t end = std::min(view_.find('\n', at_), view_.size());
      std::string_view line = trimmed(view_.substr(at_, end - at_));
      at_ = end + 1;
      ++line_;
      if (line.empty()) continue;
      fields.clear();
      while (!line.empty()) {
        const std::size_t stop = std::min(line.find_first_of("\t ,"), line.size());
        fields.push_back(line.substr(0, stop));
        line.remove_prefix(stop);
        while (!line.empty() && (line.front() == '\t' || line.front() == ' ' || line.front() == ','))
          line.remove_prefix(1);
      }
      return true;
    }
    return false;
  }
  std::size_t line() const { return line_; }

 private:
  std::string_view view_;
  std::size_t at_;
  std::size_t line_ = 0;
};

bool starts_with_number(const std::vector<std::string_view>& fields) {
  double ignored = 0;
  return !fields.empty() && number_from(fields[0], ignored);
}

bool is_header(const std::vector<std::string_view>& fields) {
  return fields.size() >= 4 && lower(fields[0]).starts_with("radius") && !starts_with_number(fields);
}

}  // namespace

bool is_treeqsm_text(const FileBytes& bytes) {
  if (bytes.view().substr(0, 4096).find('\0') != std::string_view::npos) return false;
  Lines lines(bytes);
  std::vector<std::string_view> fields;
  if (!lines.next(fields)) return false;
  if (is_header(fields)) {
    const bool known = bytes.view().substr(0, 400).find("axis_direction") != std::string_view::npos;
    if (known) return true;
    if (!lines.next(fields)) return false;
  }
  if (!starts_with_number(fields) || (fields.size() != kCurrent.columns && fields.size() != kOlder.columns))
    return false;
  double axis = 0;
  for (std::size_t k = 5; k < 8; ++k) {
    double value = 0;
    if (!number_from(fields[k], value)) return false;
    axis += value * value;
  }
  std::int64_t parent = 0;
  return std::abs(axis - 1) < 0.05 && integer_from(fields[8], parent) && parent >= 0;
}

Tree read_treeqsm_text(const FileBytes& bytes) {
  require_text(bytes);
  Lines lines(bytes);
  std::vector<std::string_view> fields;
  std::vector<CylinderRow> rows;
  Layout layout{0, 0, 0};
  while (lines.next(fields)) {
    if (rows.empty() && is_header(fields)) continue;
    if (layout.columns == 0) layout = fields.size() == kOlder.columns ? kOlder : kCurrent;
    if (fields.size() != layout.columns)
      fail_at_line(bytes.path(), lines.line(),
                   std::to_string(fields.size()) + " columns; a TreeQSM cylinder table has " +
                       std::to_string(layout.columns) + " (17 since version 2.4, 15 before)");
    const auto number = [&](std::size_t column) {
      double value = 0;
      if (!number_from(fields[column], value) || !std::isfinite(value))
        fail_at_line(bytes.path(), lines.line(),
                     "column " + std::to_string(column + 1) + ": " + shown(fields[column]) +
                         " found, a number expected");
      return value;
    };
    const auto integer = [&](std::size_t column) {
      std::int64_t value = 0;
      if (!integer_from(fields[column], value))
        fail_at_line(bytes.path(), lines.line(),
                     "column " + std::to_string(column + 1) + ": " + shown(fields[column]) +
                         " found, a whole number expected");
      return value;
    };
    CylinderRow row;
    row.line = lines.line();
    row.id = static_cast<std::int64_t>(rows.size()) + 1;
    row.radius = number(0);
    row.length = number(1);
    row.start = Vec3(number(2), number(3), number(4));
    row.axis = Vec3(number(5), number(6), number(7));
    row.parent = integer(8);
    row.axis_id = integer(layout.branch);
    row.order = integer(layout.order);
    rows.push_back(row);
  }
  return tree_from_cylinders(bytes.path(), rows, {.no_parent = 0});
}

void write_treeqsm_text(const std::filesystem::path& path, const Tree& tree) {
  tree.validate();
  const WrittenCylinders w = written_cylinders(tree);
  std::vector<std::int64_t> extension(tree.size(), 0);
  std::vector<std::int64_t> position(tree.size(), 1);
  for (std::size_t i = 0; i < tree.size(); ++i) {
    const std::int32_t p = tree.parent[i];
    if (p < 0 || tree.axis[static_cast<std::size_t>(p)] != tree.axis[i]) continue;
    extension[static_cast<std::size_t>(p)] = static_cast<std::int64_t>(i) + 1;
    position[i] = position[static_cast<std::size_t>(p)] + 1;
  }
  std::string text =
      "radius (m)\tlength "
      "(m)\tstart_point\taxis_direction\tparent\textension\tbranch\tbranch_order\tposition_in_branch\t"
      "mad\tSurfCov\tadded\tUnmodRadius (m)\n";
  const auto put = [&](auto value) {
    append_number(text, value);
    text += '\t';
  };
  for (std::size_t i = 0; i < tree.size(); ++i) {
    put(tree.radius[i]);
    put(w.length[i]);
    for (int k = 0; k < 3; ++k) put(w.start[i][k]);
    for (int k = 0; k < 3; ++k) put(w.axis[i][k]);
    put(std::int64_t{tree.parent[i]} + 1);
    put(extension[i]);
    put(std::int64_t{tree.axis[i]} + 1);
    put(std::int64_t{tree.order[i]});
    put(position[i]);
    text += "0\t0\t0\t";  // mad, SurfCov, added: not known here
    append_number(text, tree.radius[i]);
    text += '\n';
  }
  write_file(path, text);
}

}  // namespace dendrofit
