// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/atomic_file.h"
#include "io/cylinder_table.h"
#include "io/text_numbers.h"
#include "io/tree_formats.h"
#include "io/write_tree.h"

namespace dendrofit {
namespace {

constexpr std::string_view kHeader =
    "id,parent,axis,order,start_x,start_y,start_z,axis_x,axis_y,axis_z,length,radius,quality,radius_se\n";

}  // namespace

Tree read_qsm_csv(const FileBytes& bytes) {
  CsvTable table(bytes);
  const std::size_t id = table.column("id");
  const std::size_t parent = table.column("parent");
  const std::size_t axis_id = table.column("axis");
  const std::size_t order = table.column("order");
  const std::size_t start[3] = {table.column("start_x"), table.column("start_y"), table.column("start_z")};
  const std::size_t axis[3] = {table.column("axis_x"), table.column("axis_y"), table.column("axis_z")};
  const std::size_t length = table.column("length");
  const std::size_t radius = table.column("radius");
  const int quality = table.find("quality");
  const int radius_se = table.find("radius_se");
  std::vector<CylinderRow> rows;
  while (table.next()) {
    CylinderRow row;
    row.line = table.line();
    row.id = table.integer(id);
    row.parent = table.integer(parent);
    row.axis_id = table.integer(axis_id);
    row.order = table.integer(order);
    if (row.id < 1) table.fail("id " + std::to_string(row.id) + "; ids start at 1");
    if (row.parent < 0)
      table.fail("parent " + std::to_string(row.parent) + "; expected an id, or 0 for none");
    if (row.axis_id < 1) table.fail("axis " + std::to_string(row.axis_id) + "; axes are numbered from 1");
    if (row.order < 0) table.fail("order " + std::to_string(row.order) + "; expected 0 (stem) or more");
    for (int k = 0; k < 3; ++k) {
      row.start[k] = table.number(start[k]);
      row.axis[k] = table.number(axis[k]);
    }
    row.length = table.number(length);
    row.radius = table.number(radius);
    if (!(row.length > 0)) table.fail("length " + std::string(table.text(length)) + "; expected more than 0");
    if (quality >= 0) {
      const std::string_view word = table.text(static_cast<std::size_t>(quality));
      if (word == "measured")
        row.quality = RadiusQuality::measured;
      else if (word == "interpolated")
        row.quality = RadiusQuality::interpolated;
      else if (word == "allometric")
        row.quality = RadiusQuality::allometric;
      else if (word == "extrapolated")
        row.quality = RadiusQuality::extrapolated;
      else
        table.fail("quality " + shown(word) +
                   "; expected measured, interpolated, allometric or extrapolated");
    }
    if (radius_se >= 0 && !table.missing(static_cast<std::size_t>(radius_se))) {
      row.radius_se = table.number(static_cast<std::size_t>(radius_se));
      if (row.radius_se < 0) table.fail("radius_se is negative; expected 0 or more, or an empty field");
    }
    rows.push_back(row);
  }
  if (bytes.view().back() != '\n')
    table.fail(
        "the last line has no line end: the file is truncated (if it is complete, end it with a line end)");
  return tree_from_cylinders(bytes.path(), rows, {.no_parent = 0, .skip_degenerate = false});
}

void write_qsm_csv(const std::filesystem::path& path, const Tree& tree) {
  tree.validate();
  const WrittenCylinders w = written_cylinders(tree);
  std::string text(kHeader);
  text.reserve(text.size() + tree.size() * 160);
  const auto put = [&](auto value) {
    append_number(text, value);
    text += ',';
  };
  for (std::size_t i = 0; i < tree.size(); ++i) {
    put(static_cast<std::int64_t>(i) + 1);
    put(std::int64_t{tree.parent[i]} + 1);
    put(std::int64_t{tree.axis[i]} + 1);
    put(std::int64_t{tree.order[i]});
    for (int k = 0; k < 3; ++k) put(w.start[i][k]);
    for (int k = 0; k < 3; ++k) put(w.axis[i][k]);
    put(w.length[i]);
    put(tree.radius[i]);
    text += to_string(tree.quality[i]);
    text += ',';
    append_number(text, tree.radius_se[i]);
    text += '\n';
  }
  write_file(path, text);
}

}  // namespace dendrofit
