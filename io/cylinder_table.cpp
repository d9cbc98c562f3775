// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/cylinder_table.h"

#include "core/point_cloud.h"
#include "core/tree_topology.h"
#include "io/coordinate_limit.h"
#include "io/file_bytes.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <unordered_map>

namespace dendrofit {
namespace {

constexpr double kJoin = 1e-10;            // metres: an end this close to a child's start is that start
constexpr double kGrid = 1.0 / (1 << 29);  // metres, 1.9 nm: free ends lie on whole multiples

Vec3 on_grid(const Vec3& p) {
  return (p / kGrid).array().round().matrix() * kGrid;
}

// One rule for reader and writer: an end is the start of the first child that goes on there, else on the
// grid.
void settle_ends(const std::vector<std::int32_t>& parent, const std::vector<Vec3>& start,
                 std::vector<Vec3>& end) {
  std::vector<char> joined(end.size(), 0);
  for (std::size_t i = 0; i < parent.size(); ++i) {
    if (parent[i] < 0) continue;
    const auto p = static_cast<std::size_t>(parent[i]);
    if (joined[p] || (start[i] - end[p]).cwiseAbs().maxCoeff() > kJoin || start[i] == start[p]) continue;
    end[p] = start[i];
    joined[p] = 1;
  }
  for (std::size_t i = 0; i < end.size(); ++i) {
    const Vec3 settled = on_grid(end[i]);
    if (!joined[i] && settled != start[i]) end[i] = settled;
  }
}

class Builder {
 public:
  Builder(const std::filesystem::path& path, const std::vector<CylinderRow>& rows, const CylinderRules& rules)
      : path_(path), rows_(rows), rules_(rules) {}

  Tree build() {
    if (rows_.empty()) fail_in_file(path_, "holds no cylinder; is it the file you meant?");
    if (rows_.size() > static_cast<std::size_t>(std::numeric_limits<std::int32_t>::max()))
      fail_in_file(path_, "holds more cylinders than 2^31");
    check_rows();
    link_parents();
    sort_parents_first();
    make_nodes();
    lay_axes();
    return std::move(tree_);
  }

 private:
  [[noreturn]] void fail(std::size_t row, const std::string& what) const {
    const CylinderRow& r = rows_[row];
    if (r.line > 0) fail_at_line(path_, r.line, what);
    fail_in_file(path_, "cylinder " + std::to_string(r.id) + ": " + what);
  }

  Vec3 end_of(const CylinderRow& row) const {
    return row.length > 0 ? Vec3(row.start + row.length * row.axis) : row.end;
  }

  void check_rows() {
    use_.assign(rows_.size(), 1);
    for (std::size_t i = 0; i < rows_.size(); ++i) {
      const CylinderRow& r = rows_[i];
      if (!r.start.allFinite() || !end_of(r).allFinite()) fail(i, "a coordinate that is not a finite number");
      if (std::max(r.start.cwiseAbs().maxCoeff(), end_of(r).cwiseAbs().maxCoeff()) > kLargestCoordinate)
        fail(i, "a coordinate beyond 1e9 m; are its units metres?");
      if (!std::isfinite(r.radius) || !std::isfinite(r.length))
        fail(i, "radius or length is not a finite number");
      if (r.length > 0 && std::abs(r.axis.norm() - 1) > 0.01)
        fail(i, "axis of length " + std::to_string(r.axis.norm()) + "; expected a unit vector");
      const bool sound = r.radius > 0 && r.length >= 0 && (end_of(r) - r.start).norm() > 1e-9;
      if (sound) continue;
      if (!rules_.skip_degenerate)
        fail(i, r.radius > 0 ? "a cylinder of length " + std::to_string(r.length) + "; expected more than 0"
                             : "radius " + std::to_string(r.radius) + "; expected more than 0");
      use_[i] = 0;
    }
    if (std::count(use_.begin(), use_.end(), 1) == 0)
      fail_in_file(path_, "no cylinder has a length and a radius");
  }

  void link_parents() {
    std::unordered_map<std::int64_t, std::int32_t> index;
    index.reserve(rows_.size());
    for (std::size_t i = 0; i < rows_.size(); ++i)
      if (!index.emplace(rows_[i].id, static_cast<std::int32_t>(i)).second)
        fail(i, "id " + std::to_string(rows_[i].id) + " a second time; ids must differ");
    parent_row_.assign(rows_.size(), -1);
    for (std::size_t i = 0; i < rows_.size(); ++i) {
      const std::int64_t p = rows_[i].parent;
      if (p == rules_.no_parent || p < 0) continue;
      const auto found = index.find(p);
      if (found == index.end())
        fail(i, "parent " + std::to_string(p) + " is no cylinder's id (truncated file, or rows left out?)");
      parent_row_[i] = found->second;
    }
  }

  // Rows in file order, each after its ancestors.
  void sort_parents_first() {
    std::vector<char> state(rows_.size(), 0);  // 1: being placed, 2: placed
    std::vector<std::int32_t> chain;
    sequence_.reserve(rows_.size());
    for (std::size_t i = 0; i < rows_.size(); ++i) {
      chain.clear();
      for (auto k = static_cast<std::int32_t>(i); k >= 0 && state[static_cast<std::size_t>(k)] != 2;
           k = parent_row_[static_cast<std::size_t>(k)]) {
        if (state[static_cast<std::size_t>(k)] == 1)
          fail(static_cast<std::size_t>(k), "its line of parents leads back to itself");
        state[static_cast<std::size_t>(k)] = 1;
        chain.push_back(k);
      }
      for (auto k = chain.rbegin(); k != chain.rend(); ++k) {
        state[static_cast<std::size_t>(*k)] = 2;
        sequence_.push_back(static_cast<std::size_t>(*k));
      }
    }
  }

  void make_nodes() {
    Bounds bounds;
    for (std::size_t i = 0; i < rows_.size(); ++i)
      if (use_[i]) bounds.add(rows_[i].start);
    // Starts alone: a file's ends follow from them, and their bits are what a round trip must keep.
    tree_.origin_shift = exact_origin_shift(bounds.lo, bounds.hi);
    std::vector<std::int32_t> node_of_row(rows_.size(), -1);
    tree_.reserve(rows_.size());
    for (const std::size_t i : sequence_) {
      const std::int32_t above = parent_row_[i];
      if (!use_[i]) {  // children go to the parent's node
        node_of_row[i] = above < 0 ? -1 : node_of_row[static_cast<std::size_t>(above)];
        continue;
      }
      const CylinderRow& r = rows_[i];
      TreeNode node;
      node.start = r.start - tree_.origin_shift;
      node.end = r.length > 0 ? Vec3(node.start + r.length * r.axis) : Vec3(r.end - tree_.origin_shift);
      node.parent = above < 0 ? -1 : node_of_row[static_cast<std::size_t>(above)];
      node.radius = r.radius;
      node.quality = r.quality;
      node.radius_se = r.radius_se;
      node_of_row[i] = tree_.add(node);
      row_of_node_.push_back(i);
    }
    settle_ends(tree_.parent, tree_.start, tree_.end);
  }

  void lay_axes() {
    const bool axes = known(&CylinderRow::axis_id);
    const bool orders = known(&CylinderRow::order);
    if (!axes && !orders) return assign_axes_by_thickness(tree_);
    const std::vector<std::int32_t> heir = axes ? heirs_by_axis() : heirs_by_order();
    std::int32_t next = 0;
    for (std::size_t i = 0; i < tree_.size(); ++i) {
      const std::int32_t p = tree_.parent[i];
      const bool goes_on = p >= 0 && heir[static_cast<std::size_t>(p)] == static_cast<std::int32_t>(i);
      tree_.axis[i] = goes_on ? tree_.axis[static_cast<std::size_t>(p)] : next++;
      if (p < 0) continue;
      const std::int32_t below = tree_.order[static_cast<std::size_t>(p)];
      std::int64_t step = orders ? row(i).order - row(static_cast<std::size_t>(p)).order : 1;
      step = std::clamp<std::int64_t>(step, 1, 1000);
      tree_.order[i] = goes_on ? below : below + static_cast<std::int32_t>(step);
    }
    if (axes) keep_axis_numbers(next);
  }

  // Where no axis was broken and the file counts them without gaps, its numbers stay.
  void keep_axis_numbers(std::int32_t count) {
    std::int64_t first = row(0).axis_id;
    for (std::size_t i = 0; i < tree_.size(); ++i) first = std::min(first, row(i).axis_id);
    std::vector<std::int32_t> number(static_cast<std::size_t>(count), -1);
    std::vector<char> taken(static_cast<std::size_t>(count), 0);
    for (std::size_t i = 0; i < tree_.size(); ++i) {
      std::int32_t& mine = number[static_cast<std::size_t>(tree_.axis[i])];
      if (mine >= 0) continue;
      const std::uint64_t k = static_cast<std::uint64_t>(row(i).axis_id) - static_cast<std::uint64_t>(first);
      if (k >= static_cast<std::uint64_t>(count) || taken[k]) return;
      taken[k] = 1;
      mine = static_cast<std::int32_t>(k);
    }
    for (std::int32_t& axis : tree_.axis) axis = number[static_cast<std::size_t>(axis)];
  }

  const CylinderRow& row(std::size_t node) const { return rows_[row_of_node_[node]]; }

  bool known(std::int64_t CylinderRow::*field) const {
    return std::none_of(rows_.begin(), rows_.end(),
                        [&](const CylinderRow& r) { return r.*field == CylinderRow::kUnknown; });
  }

  // The first child on the parent's own axis; a later one, or one after a break, starts an axis of its own.
  std::vector<std::int32_t> heirs_by_axis() const {
    std::vector<std::int32_t> heir(tree_.size(), -1);
    for (std::size_t i = 0; i < tree_.size(); ++i) {
      const std::int32_t p = tree_.parent[i];
      if (p < 0 || row(i).axis_id != row(static_cast<std::size_t>(p)).axis_id) continue;
      std::int32_t& best = heir[static_cast<std::size_t>(p)];
      if (best < 0) best = static_cast<std::int32_t>(i);
    }
    return heir;
  }

  std::vector<std::int32_t> heirs_by_order() const {
    std::vector<std::int32_t> heir(tree_.size(), -1);
    for (std::size_t i = 0; i < tree_.size(); ++i) {
      const std::int32_t p = tree_.parent[i];
      if (p < 0 || row(i).order != row(static_cast<std::size_t>(p)).order) continue;
      std::int32_t& best = heir[static_cast<std::size_t>(p)];
      if (best < 0 || tree_.radius[i] > tree_.radius[static_cast<std::size_t>(best)])
        best = static_cast<std::int32_t>(i);
    }
    return heir;
  }

  const std::filesystem::path& path_;
  const std::vector<CylinderRow>& rows_;
  const CylinderRules& rules_;
  std::vector<char> use_;
  std::vector<std::int32_t> parent_row_;
  std::vector<std::size_t> sequence_;
  std::vector<std::size_t> row_of_node_;
  Tree tree_;
};

}  // namespace

Vec3 exact_origin_shift(const Vec3& lo, const Vec3& hi) {
  Vec3 shift = Vec3::Zero();
  for (int k = 0; k < 3; ++k) {
    if (lo[k] * hi[k] <= 0) continue;  // both sides of zero: small anyway, or no shift keeps all bits
    const double smallest = std::min(std::abs(lo[k]), std::abs(hi[k]));
    if (smallest < 100) continue;
    const double candidate = std::round(0.5 * (lo[k] + hi[k]) / 100) * 100;
    if (std::max(std::abs(lo[k] - candidate), std::abs(hi[k] - candidate)) <= smallest) shift[k] = candidate;
  }
  return shift;
}

Tree tree_from_cylinders(const std::filesystem::path& path, const std::vector<CylinderRow>& rows,
                         const CylinderRules& rules) {
  return Builder(path, rows, rules).build();
}

WrittenCylinders written_cylinders(const Tree& tree) {
  WrittenCylinders w;
  w.start.reserve(tree.size());
  Bounds bounds;
  for (const Vec3& p : tree.start) {
    w.start.push_back(p + tree.origin_shift);
    bounds.add(w.start.back());
  }
  // The very frame the reader will choose; differences of its local coordinates are the same whatever the
  // frame.
  const Vec3 shift = tree.empty() ? Vec3(Vec3::Zero()) : exact_origin_shift(bounds.lo, bounds.hi);
  const Vec3 rest = tree.origin_shift - shift;
  std::vector<Vec3> start;
  std::vector<Vec3> end;
  for (std::size_t i = 0; i < tree.size(); ++i) {
    start.push_back(w.start[i] - shift);
    // An end that is a child's start in the tree must be it in print too, where adding the shift has rounded
    // both.
    end.push_back(tree.end[i] + rest);
  }
  for (std::size_t i = 0; i < tree.size(); ++i) {
    const std::int32_t p = tree.parent[i];
    if (p >= 0 && (tree.start[i] - tree.end[static_cast<std::size_t>(p)]).cwiseAbs().maxCoeff() <= kJoin &&
        start[i] != start[static_cast<std::size_t>(p)])
      end[static_cast<std::size_t>(p)] = start[i];
  }
  settle_ends(tree.parent, start, end);
  for (std::size_t i = 0; i < tree.size(); ++i) {
    const Vec3 along = end[i] - start[i];
    w.length.push_back(along.norm());
    w.axis.push_back(along / w.length.back());
    w.end.push_back(end[i] + shift);
  }
  return w;
}

}  // namespace dendrofit
