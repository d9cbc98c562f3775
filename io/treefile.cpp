// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/atomic_file.h"
#include "io/cylinder_table.h"
#include "io/text_numbers.h"
#include "io/tree_formats.h"

#include <cmath>

namespace dendrofit {
namespace {

std::string_view first_content_line(const FileBytes& bytes, std::size_t& at, std::size_t& number) {
  const std::string_view view = bytes.view();
  while (at < view.size()) {
    const std::size_t end = std::min(view.find('\n', at), view.size());
    const std::string_view line = trimmed(view.substr(at, end - at));
    at = end + 1;
    ++number;
    if (!line.empty() && line.front() != '#') return line;
  }
  return {};
}

std::vector<std::string_view> split(std::string_view text, char delimiter) {
  std::vector<std::string_view> parts;
  while (true) {
    const std::size_t stop = text.find(delimiter);
    parts.push_back(trimmed(text.substr(0, stop)));
    if (stop == std::string_view::npos) return parts;
    text.remove_prefix(stop + 1);
  }
}

struct Header {
  std::size_t tree_attributes = 0;  ///< before the first segment
  std::size_t fields = 0;           ///< of a segment
  std::size_t axis = 0;             ///< position of "axis" in a segment, 0 without one
  std::size_t order = 0;            ///< of "order"
};

// Tree attributes come before "x,y,z,radius"; parent_id is the fifth name from there, or missing: a lone
// trunk.
bool header_of(std::string_view line, Header& header) {
  const std::vector<std::string_view> names = split(line, ',');
  for (std::size_t i = 0; i + 3 < names.size(); ++i) {
    if (names[i] != "x" || names[i + 1] != "y" || names[i + 2] != "z" || names[i + 3] != "radius") continue;
    header.tree_attributes = i;
    header.fields = names.size() - i;
    for (std::size_t k = 5; k < header.fields; ++k) {
      if (names[i + k] == "axis") header.axis = k;
      if (names[i + k] == "order") header.order = k;
    }
    return names.size() == i + 4 || names[i + 4] == "parent_id";
  }
  return false;
}

struct Segment {
  Vec3 tip;
  double radius;
  std::int64_t parent;
  std::int64_t axis;
  std::int64_t order;
};

}  // namespace

bool is_treefile(const FileBytes& bytes) {
  if (bytes.view().substr(0, 4096).find('\0') != std::string_view::npos) return false;
  std::size_t at = text_start(bytes);
  std::size_t number = 0;
  Header header;
  return header_of(first_content_line(bytes, at, number), header) && header.fields >= 5;
}

Tree read_treefile(const FileBytes& bytes) {
  require_text(bytes);
  std::size_t at = text_start(bytes);
  std::size_t number = 0;
  Header header;
  if (!header_of(first_content_line(bytes, at, number), header) || header.fields < 5)
    fail_at_line(bytes.path(), number, "no treefile header; expected x,y,z,radius,parent_id");
  std::vector<CylinderRow> rows;
  std::int64_t id = 0;
  for (std::string_view line; !(line = first_content_line(bytes, at, number)).empty();) {
    const std::vector<std::string_view> fields = split(line, ',');
    if (fields.size() < header.tree_attributes + 2 * header.fields ||
        (fields.size() - header.tree_attributes) % header.fields != 0)
      fail_at_line(bytes.path(), number,
                   std::to_string(fields.size()) + " fields; expected " +
                       std::to_string(header.tree_attributes) +
                       " of the tree and a multiple (2 or more) of " + std::to_string(header.fields) +
                       " of its segments (truncated line?)");
    std::vector<Segment> segments;
    for (std::size_t f = header.tree_attributes; f < fields.size(); f += header.fields) {
      double value[4] = {};
      for (std::size_t k = 0; k < 4; ++k)
        if (!number_from(fields[f + k], value[k]) || !std::isfinite(value[k]))
          fail_at_line(bytes.path(), number,
                       "field " + std::to_string(f + k + 1) + ": " + shown(fields[f + k]) +
                           " found, a number expected");
      const auto whole = [&](std::size_t k) {
        std::int64_t whole_number = 0;
        if (!integer_from(fields[f + k], whole_number))
          fail_at_line(bytes.path(), number,
                       "field " + std::to_string(f + k + 1) + ": " + shown(fields[f + k]) +
                           " found, a whole number expected");
        return whole_number;
      };
      const std::int64_t parent = whole(4);
      const auto count = static_cast<std::int64_t>(segments.size());
      if (count == 0 ? parent != -1 : parent < 0 || parent >= count)
        fail_at_line(bytes.path(), number,
                     "segment " + std::to_string(count) + ": parent " + std::to_string(parent) +
                         (count == 0 ? "; the first segment is the root, -1"
                                     : "; expected an earlier segment, from 0"));
      segments.push_back({Vec3(value[0], value[1], value[2]), value[3], parent,
                          header.axis > 0 ? whole(header.axis) : CylinderRow::kUnknown,
                          header.order > 0 ? whole(header.order) : CylinderRow::kUnknown});
    }
    // The root is a point: cylinders are the others, from their parent's tip to their own.
    const std::int64_t first = id + 1;
    for (std::size_t s = 1; s < segments.size(); ++s) {
      CylinderRow row;
      row.line = number;
      row.id = first + static_cast<std::int64_t>(s) - 1;
      row.parent = segments[s].parent == 0 ? 0 : first + segments[s].parent - 1;
      row.start = segments[static_cast<std::size_t>(segments[s].parent)].tip;
      row.end = segments[s].tip;
      row.radius = segments[s].radius;
      row.axis_id = segments[s].axis;
      row.order = segments[s].order;
      rows.push_back(row);
    }
    id += static_cast<std::int64_t>(segments.size()) - 1;
  }
  return tree_from_cylinders(bytes.path(), rows, {.no_parent = 0});
}

void write_treefile(const std::filesystem::path& path, const Tree& tree) {
  tree.validate();
  const WrittenCylinders w = written_cylinders(tree);
  std::vector<std::int32_t> root(tree.size(), -1);
  std::vector<std::vector<std::size_t>> members(tree.size());
  for (std::size_t i = 0; i < tree.size(); ++i) {
    root[i] =
        tree.parent[i] < 0 ? static_cast<std::int32_t>(i) : root[static_cast<std::size_t>(tree.parent[i])];
    members[static_cast<std::size_t>(root[i])].push_back(i);
  }
  std::string text =
      "# tree structure: one tree a line, lengths in metres\nx,y,z,radius,parent_id,section_id,axis,order\n";
  std::vector<std::int64_t> place(tree.size(), 0);
  const auto segment = [&](const Vec3& tip, double radius, std::int64_t parent, std::int64_t section,
                           std::size_t node) {
    for (const double value : {tip.x(), tip.y(), tip.z(), radius}) {
      append_number(text, value);
      text += ',';
    }
    append_number(text, parent);
    text += ',';
    append_number(text, section);
    text += ',';
    append_number(text, std::int64_t{tree.axis[node]} + 1);
    text += ',';
    append_number(text, std::int64_t{tree.order[node]});
  };
  for (std::size_t r = 0; r < tree.size(); ++r) {
    if (members[r].empty()) continue;
    segment(w.start[r], tree.radius[r], -1, 0, r);
    std::int64_t next = 1;
    for (const std::size_t i : members[r]) {
      place[i] = next++;
      text += ", ";
      const std::int32_t p = tree.parent[i];
      segment(w.end[i], tree.radius[i], p < 0 ? 0 : place[static_cast<std::size_t>(p)], place[i], i);
    }
    text += '\n';
  }
  write_file(path, text);
}

}  // namespace dendrofit
