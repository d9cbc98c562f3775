// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/cylinder_table.h"
#include "io/mat_file.h"
#include "io/tree_formats.h"

#include <algorithm>
#include <cmath>

namespace dendrofit {
namespace {

// The first structure, however deep, with the fields a cylinder table must have.
const MatValue* find_cylinders(const MatValue& value, int depth = 0) {
  if (depth > 6) return nullptr;
  if (value.field("radius") && value.field("start") && value.field("axis") && value.field("length") &&
      value.field("parent"))
    return &value;
  if (const MatValue* inner = value.field("cylinder"))
    if (const MatValue* found = find_cylinders(*inner, depth + 1)) return found;
  for (const MatValue& element : value.elements)
    if (const MatValue* found = find_cylinders(element, depth + 1)) return found;
  return nullptr;
}

class Columns {
 public:
  Columns(const std::filesystem::path& path, const MatValue& cylinders) : path_(path), cylinders_(cylinders) {
    count_ = numbers("radius", 1).size();
  }
  std::size_t count() const { return count_; }
  bool has(const char* name) const {
    const MatValue* value = cylinders_.field(name);
    return value && value->kind == MatValue::Kind::numbers && value->numbers.size() == count_ && count_ > 0;
  }
  const std::vector<double>& numbers(const char* name, std::size_t columns) const {
    const MatValue* value = cylinders_.field(name);
    const std::string field = std::string("cylinder.") + name;
    if (!value || value->kind != MatValue::Kind::numbers)
      fail_in_file(path_, field + " is missing or holds no numbers");
    if (count_ > 0 && value->numbers.size() != count_ * columns)
      fail_in_file(path_, field + " has " + std::to_string(value->numbers.size()) + " numbers; expected " +
                              std::to_string(count_ * columns));
    // Column-major: start and axis are count x 3, the others either way.
    if (columns == 3 && (value->size.size() != 2 || value->size[1] != 3))
      fail_in_file(path_, field + " is no matrix of 3 columns");
    return value->numbers;
  }
  std::int64_t integer(const std::vector<double>& values, std::size_t i, const char* name) const {
    const double v = values[i];
    if (!(std::abs(v) <= 9e15) || v != std::floor(v))
      fail_in_file(path_, "cylinder " + std::to_string(i + 1) + ": " + name + " " + std::to_string(v) +
                              "; a whole number expected");
    return static_cast<std::int64_t>(v);
  }

 private:
  const std::filesystem::path& path_;
  const MatValue& cylinders_;
  std::size_t count_ = 0;
};

}  // namespace

bool is_mat(const FileBytes& bytes) {
  return bytes.view().starts_with("MATLAB ");
}

Tree read_treeqsm_mat(const FileBytes& bytes) {
  const auto variables = read_mat(bytes);
  const MatValue* cylinders = nullptr;
  std::string names;
  for (const auto& [name, value] : variables) {
    names += (names.empty() ? "" : ", ") + shown(name);
    if (!cylinders) cylinders = find_cylinders(value);
  }
  if (!cylinders)
    fail_in_file(bytes.path(),
                 "no cylinders (fields radius, length, start, axis, parent of QSM.cylinder); it holds " +
                     (names.empty() ? "nothing" : names));
  const Columns table(bytes.path(), *cylinders);
  const std::vector<double>& radius = table.numbers("radius", 1);
  const std::vector<double>& length = table.numbers("length", 1);
  const std::vector<double>& parent = table.numbers("parent", 1);
  const std::vector<double>& start = table.numbers("start", 3);
  const std::vector<double>& axis = table.numbers("axis", 3);
  const bool branches = table.has("branch");
  const bool orders = table.has("BranchOrder");
  const std::size_t n = table.count();
  std::vector<CylinderRow> rows(n);
  for (std::size_t i = 0; i < n; ++i) {
    CylinderRow& row = rows[i];
    row.id = static_cast<std::int64_t>(i) + 1;
    row.parent = table.integer(parent, i, "parent");
    row.start = Vec3(start[i], start[n + i], start[2 * n + i]);
    row.axis = Vec3(axis[i], axis[n + i], axis[2 * n + i]);
    row.length = length[i];
    row.radius = radius[i];
    if (branches) row.axis_id = table.integer(table.numbers("branch", 1), i, "branch");
    if (orders) row.order = table.integer(table.numbers("BranchOrder", 1), i, "BranchOrder");
  }
  return tree_from_cylinders(bytes.path(), rows, {.no_parent = 0});
}

void write_treeqsm_mat(const std::filesystem::path& path, const Tree& tree) {
  tree.validate();
  const WrittenCylinders w = written_cylinders(tree);
  const std::size_t n = tree.size();
  const auto rows = static_cast<std::int64_t>(n);
  const auto column = [&](const char* name, auto value) {
    MatMatrix m{name, rows, {}};
    m.values.reserve(n);
    for (std::size_t i = 0; i < n; ++i) m.values.push_back(static_cast<double>(value(i)));
    return m;
  };
  const auto columns = [&](const char* name, const std::vector<Vec3>& points) {
    MatMatrix m{name, rows, {}};
    for (int k = 0; k < 3; ++k)
      for (const Vec3& p : points) m.values.push_back(p[k]);
    return m;
  };
  std::vector<double> extension(n, 0);
  std::vector<double> position(n, 1);
  for (std::size_t i = 0; i < n; ++i) {
    const std::int32_t p = tree.parent[i];
    if (p < 0 || tree.axis[static_cast<std::size_t>(p)] != tree.axis[i]) continue;
    extension[static_cast<std::size_t>(p)] = static_cast<double>(i + 1);
    position[i] = position[static_cast<std::size_t>(p)] + 1;
  }
  write_mat(path, "QSM", "cylinder",
            {column("radius", [&](std::size_t i) { return tree.radius[i]; }),
             column("length", [&](std::size_t i) { return w.length[i]; }), columns("start", w.start),
             columns("axis", w.axis), column("parent", [&](std::size_t i) { return tree.parent[i] + 1; }),
             column("extension", [&](std::size_t i) { return extension[i]; }),
             column("added", [](std::size_t) { return 0; }),
             column("UnmodRadius", [&](std::size_t i) { return tree.radius[i]; }),
             column("branch", [&](std::size_t i) { return tree.axis[i] + 1; }),
             column("SurfCov", [](std::size_t) { return 0; }), column("mad", [](std::size_t) { return 0; }),
             column("BranchOrder", [&](std::size_t i) { return tree.order[i]; }),
             column("PositionInBranch", [&](std::size_t i) { return position[i]; })});
}

}  // namespace dendrofit
