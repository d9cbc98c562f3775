// SPDX-License-Identifier: GPL-3.0-or-later
// Tables with start and end points: SimpleForest / rTwig, aRchi, arbor.
#include "core/atomic_file.h"
#include "io/cylinder_table.h"
#include "io/text_numbers.h"
#include "io/tree_formats.h"

namespace dendrofit {
namespace {

struct Names {
  const char* id;
  const char* parent;
  const char* radius;
  const char* axis;   ///< optional in the file
  const char* order;  ///< optional in the file
  std::int64_t no_parent;
};

std::vector<CylinderRow> read_rows(CsvTable& table, const Names& names) {
  const std::size_t id = table.column(names.id);
  const std::size_t parent = table.column(names.parent);
  const std::size_t start[3] = {table.column("startX"), table.column("startY"), table.column("startZ")};
  const std::size_t end[3] = {table.column("endX"), table.column("endY"), table.column("endZ")};
  const std::size_t radius = table.column(names.radius);
  const int axis = table.find(names.axis);
  const int order = table.find(names.order);
  std::vector<CylinderRow> rows;
  while (table.next()) {
    CylinderRow row;
    row.line = table.line();
    row.id = table.integer(id);
    row.parent = table.missing(parent) ? names.no_parent : table.integer(parent);
    for (int k = 0; k < 3; ++k) {
      row.start[k] = table.number(start[k]);
      row.end[k] = table.number(end[k]);
    }
    row.radius = table.number(radius);
    if (axis >= 0) row.axis_id = table.integer(static_cast<std::size_t>(axis));
    if (order >= 0) row.order = table.integer(static_cast<std::size_t>(order));
    rows.push_back(row);
  }
  return rows;
}

// arbor states where each radius comes from: 0 unknown, 1 prolonged, 2 allometry, 3 polynomial, 4 measured, 5
// refined.
constexpr RadiusQuality kArborQuality[] = {RadiusQuality::allometric, RadiusQuality::extrapolated,
                                           RadiusQuality::allometric, RadiusQuality::interpolated,
                                           RadiusQuality::measured,   RadiusQuality::measured};

// The unbranched run of cylinders (between forks) that each cylinder belongs to, and the run it grows from;
// from 0.
struct Segments {
  std::vector<std::int64_t> of;
  std::vector<std::int64_t> parent;  ///< per cylinder: of its segment's parent, -1 at the root
};

Segments segments_of(const Tree& tree) {
  std::vector<int> children(tree.size(), 0);
  for (const std::int32_t p : tree.parent)
    if (p >= 0) ++children[static_cast<std::size_t>(p)];
  Segments s;
  std::int64_t next = 0;
  for (std::size_t i = 0; i < tree.size(); ++i) {
    const std::int32_t p = tree.parent[i];
    if (p >= 0 && children[static_cast<std::size_t>(p)] == 1) {
      s.of.push_back(s.of[static_cast<std::size_t>(p)]);
      s.parent.push_back(s.parent[static_cast<std::size_t>(p)]);
    } else {
      s.of.push_back(next++);
      s.parent.push_back(p < 0 ? -1 : s.of[static_cast<std::size_t>(p)]);
    }
  }
  return s;
}

class Table {
 public:
  explicit Table(std::string header) : text_(std::move(header)) {}
  template <class Number>
  Table& put(Number value) {
    separate();
    append_number(text_, value);
    return *this;
  }
  Table& put(const Vec3& p) { return put(p.x()).put(p.y()).put(p.z()); }
  void end_row() {
    text_ += '\n';
    first_ = true;
  }
  const std::string& text() const { return text_; }

 private:
  void separate() {
    if (!first_) text_ += ',';
    first_ = false;
  }
  std::string text_;
  bool first_ = true;
};

}  // namespace

Tree read_simpleforest_csv(const FileBytes& bytes) {
  CsvTable table(bytes);
  const std::vector<CylinderRow> rows =
      read_rows(table, {"ID", "parentID", "radius", "branchID", "branchOrder", -1});
  return tree_from_cylinders(bytes.path(), rows, {.no_parent = -1});
}

Tree read_archi_csv(const FileBytes& bytes) {
  CsvTable table(bytes);
  const std::vector<CylinderRow> rows =
      read_rows(table, {"cyl_ID", "parent_ID", "radius_cyl", "axis_ID", "branching_order", 0});
  return tree_from_cylinders(bytes.path(), rows, {.no_parent = 0});
}

Tree read_arbor_csv(const FileBytes& bytes) {
  CsvTable table(bytes);
  std::vector<CylinderRow> rows =
      read_rows(table, {"cyl_ID", "parent_ID", "radius", "axis_ID", "branch_order", 0});
  if (const int quality = table.find("quality"); quality >= 0) {
    CsvTable again(bytes);
    for (CylinderRow& row : rows) {
      again.next();
      const std::int64_t code = again.integer(static_cast<std::size_t>(quality));
      if (code < 0 || code > 5) again.fail("quality " + std::to_string(code) + "; expected 0 to 5");
      row.quality = kArborQuality[code];
    }
  }
  return tree_from_cylinders(bytes.path(), rows, {.no_parent = 0});
}

void write_simpleforest_csv(const std::filesystem::path& path, const Tree& tree) {
  tree.validate();
  const WrittenCylinders w = written_cylinders(tree);
  const Segments segments = segments_of(tree);
  Table table(
      "ID,parentID,startX,startY,startZ,endX,endY,endZ,radius,length,branchOrder,branchID,segmentID,"
      "parentSegmentID\n");
  for (std::size_t i = 0; i < tree.size(); ++i) {
    table.put(static_cast<std::int64_t>(i)).put(std::int64_t{tree.parent[i]}).put(w.start[i]).put(w.end[i]);
    table.put(tree.radius[i])
        .put(w.length[i])
        .put(std::int64_t{tree.order[i]})
        .put(std::int64_t{tree.axis[i]});
    table.put(segments.of[i]).put(segments.parent[i]).end_row();
  }
  write_file(path, table.text());
}

void write_archi_csv(const std::filesystem::path& path, const Tree& tree) {
  tree.validate();
  const WrittenCylinders w = written_cylinders(tree);
  const Segments segments = segments_of(tree);
  std::vector<std::int64_t> extension(tree.size(), 0);
  for (std::size_t i = 0; i < tree.size(); ++i) {
    const std::int32_t p = tree.parent[i];
    if (p >= 0 && tree.axis[static_cast<std::size_t>(p)] == tree.axis[i])
      extension[static_cast<std::size_t>(p)] = static_cast<std::int64_t>(i) + 1;
  }
  Table table(
      "startX,startY,startZ,endX,endY,endZ,cyl_ID,parent_ID,extension_ID,radius_cyl,length,volume,axis_ID,"
      "segment_ID,"
      "node_ID,branching_order\n");
  for (std::size_t i = 0; i < tree.size(); ++i) {
    table.put(w.start[i])
        .put(w.end[i])
        .put(static_cast<std::int64_t>(i) + 1)
        .put(std::int64_t{tree.parent[i]} + 1);
    table.put(extension[i])
        .put(tree.radius[i])
        .put(w.length[i])
        .put(tree.volume(i))
        .put(std::int64_t{tree.axis[i]} + 1);
    table.put(segments.of[i] + 1).put(segments.parent[i] + 1).put(std::int64_t{tree.order[i]} + 1).end_row();
  }
  write_file(path, table.text());
}

void write_arbor_csv(const std::filesystem::path& path, const Tree& tree) {
  tree.validate();
  const WrittenCylinders w = written_cylinders(tree);
  std::vector<double> distance(tree.size(), 0);
  std::vector<double> beyond(tree.size(), 0);
  for (std::size_t i = 0; i < tree.size(); ++i)
    distance[i] = w.length[i] + (tree.parent[i] < 0 ? 0 : distance[static_cast<std::size_t>(tree.parent[i])]);
  for (std::size_t i = tree.size(); i-- > 0;) {
    beyond[i] += w.length[i];
    if (tree.parent[i] >= 0) beyond[static_cast<std::size_t>(tree.parent[i])] += beyond[i];
  }
  constexpr std::int64_t codes[] = {4, 3, 2, 1};  // by RadiusQuality
  Table table(
      "startX,startY,startZ,endX,endY,endZ,cyl_ID,parent_ID,axis_ID,branch_order,dist_to_root,subtree_length,"
      "radius,"
      "quality\n");
  for (std::size_t i = 0; i < tree.size(); ++i) {
    table.put(w.start[i])
        .put(w.end[i])
        .put(static_cast<std::int64_t>(i) + 1)
        .put(std::int64_t{tree.parent[i]} + 1);
    table.put(std::int64_t{tree.axis[i]} + 1)
        .put(std::int64_t{tree.order[i]})
        .put(distance[i])
        .put(beyond[i]);
    table.put(tree.radius[i]).put(codes[static_cast<std::size_t>(tree.quality[i])]).end_row();
  }
  write_file(path, table.text());
}

}  // namespace dendrofit
