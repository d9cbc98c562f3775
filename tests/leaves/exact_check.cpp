// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/leaves/exact_check.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>
#include <iterator>
#include <map>
#include <set>
#include <sstream>
#include <stdexcept>

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Exact_rational.h>
#include <CGAL/FPU.h>
#include <CGAL/Interval_nt.h>
#include <CGAL/box_intersection_d.h>
#include <CGAL/intersections.h>

namespace leafcheck {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Box = CGAL::Box_intersection_d::Box_with_info_d<double, 3, std::size_t>;
using Interval = CGAL::Interval_nt<false>;
using Rational = CGAL::Exact_rational;

Kernel::Triangle_3 to_cgal(const Triangle& t) {
  const auto point = [](const std::array<double, 3>& p) { return Kernel::Point_3(p[0], p[1], p[2]); };
  return {point(t.corner[0]), point(t.corner[1]), point(t.corner[2])};
}

template <class Number>
using Vec = std::array<Number, 3>;

template <class Number>
Number dot(const Vec<Number>& a, const Vec<Number>& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

template <class Number>
Vec<Number> minus(const Vec<Number>& a, const Vec<Number>& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}

/// With D the axis times its length and x from the base: cut by 0 <= x.D <= D.D, drop the part along D
/// (q = x (D.D) - (x.D) D), and ask whether the polygon holds the axis or has an edge with |q| <= r (D.D).
template <class Number>
bool meets_as(const Triangle& triangle, const Cylinder& cylinder) {
  Vec<Number> d, base;
  for (std::size_t k = 0; k < 3; ++k) {
    d[k] = Number(cylinder.axis[k]) * Number(cylinder.length);
    base[k] = Number(cylinder.start[k]);
  }
  const Number dd = dot(d, d), zero(0);
  std::vector<Vec<Number>> polygon;
  for (const auto& corner : triangle.corner)
    polygon.push_back(minus({Number(corner[0]), Number(corner[1]), Number(corner[2])}, base));
  for (int side = 0; side < 2; ++side) {
    const auto inside = [&](const Vec<Number>& x) -> Number {
      return side == 0 ? dot(x, d) : Number(dd - dot(x, d));
    };
    std::vector<Vec<Number>> cut;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
      const Vec<Number>&p = polygon[i], &q = polygon[(i + 1) % polygon.size()];
      const Number sp = inside(p), sq = inside(q);
      const bool p_in = sp >= zero, q_in = sq >= zero;
      if (p_in) cut.push_back(p);
      if (p_in != q_in) {
        const Number s = sp / (sp - sq);
        cut.push_back({p[0] + s * (q[0] - p[0]), p[1] + s * (q[1] - p[1]), p[2] + s * (q[2] - p[2])});
      }
    }
    polygon = cut;
    if (polygon.empty()) return false;
  }
  for (Vec<Number>& x : polygon) {
    const Number along = dot(x, d);
    for (std::size_t k = 0; k < 3; ++k) x[k] = x[k] * dd - along * d[k];
  }
  const Number limit = Number(cylinder.radius) * Number(cylinder.radius) * dd * dd;
  bool any_left = false, any_right = false;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vec<Number>&p = polygon[i], &q = polygon[(i + 1) % polygon.size()];
    if (dot(p, p) <= limit) return true;
    const Vec<Number> e = minus(q, p);
    const Number ee = dot(e, e), pe = dot(p, e);
    // Nearest point inside the edge: 0 < -p.e < e.e.
    if (pe < zero && -pe < ee)
      if (dot(p, p) * ee - pe * pe <= limit * ee) return true;
    const Vec<Number> cross = {p[1] * q[2] - p[2] * q[1], p[2] * q[0] - p[0] * q[2],
                               p[0] * q[1] - p[1] * q[0]};
    const Number turn = dot(cross, d);
    if (turn > zero)
      any_left = true;
    else if (turn < zero)
      any_right = true;
  }
  return any_left != any_right;
}

Box box_of(const Triangle& t, std::size_t id) {
  double lo[3], hi[3];
  for (std::size_t k = 0; k < 3; ++k) {
    lo[k] = std::min({t.corner[0][k], t.corner[1][k], t.corner[2][k]});
    hi[k] = std::max({t.corner[0][k], t.corner[1][k], t.corner[2][k]});
  }
  return {lo, hi, id};
}

Box box_of(const Cylinder& c, std::size_t id) {
  double lo[3], hi[3];
  for (std::size_t k = 0; k < 3; ++k) {
    const double end = c.start[k] + c.axis[k] * c.length;
    // Wider than the cylinder, so that rounding loses none.
    lo[k] = std::min(c.start[k], end) - 1.0001 * c.radius - 1e-6;
    hi[k] = std::max(c.start[k], end) + 1.0001 * c.radius + 1e-6;
  }
  return {lo, hi, id};
}

std::size_t root_of(std::vector<std::size_t>& up, std::size_t i) {
  while (up[i] != i) i = up[i] = up[up[i]];
  return i;
}

std::vector<std::string> cells_of(const std::string& line) {
  std::vector<std::string> cells;
  std::istringstream in(line);
  for (std::string cell; std::getline(in, cell, ',');) {
    while (!cell.empty() && (cell.back() == '\r' || cell.back() == ' ')) cell.pop_back();
    cells.push_back(cell);
  }
  return cells;
}

[[noreturn]] void bad(const std::filesystem::path& path, std::size_t line, const std::string& what) {
  throw std::runtime_error(path.string() + ", line " + std::to_string(line) + ": " + what);
}

const char* skip_blank(const char* p, const char* end) {
  while (p < end && (*p == ' ' || *p == '\t')) ++p;
  return p;
}

struct Obj {
  std::vector<std::array<double, 3>> vertices;
  std::vector<std::array<std::size_t, 3>> faces;
  std::vector<std::size_t> group;  // of each face: the N of the last `g leaf_N`, 0 before any

  Triangle triangle(std::size_t face, std::size_t leaf) const {
    Triangle t;
    for (std::size_t k = 0; k < 3; ++k) t.corner[k] = vertices[faces[face][k]];
    t.leaf = leaf;
    return t;
  }
};

Obj parse_obj(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  if (!in) throw std::runtime_error(path.string() + ": cannot be read");
  Obj obj;
  std::string line;
  std::size_t group = 0;
  for (std::size_t number = 1; std::getline(in, line); ++number) {
    const char* p = line.data();
    const char* end = p + line.size();
    if (line.rfind("v ", 0) == 0) {
      std::array<double, 3> v{};
      p += 1;
      for (double& x : v) {
        const auto [next, error] = std::from_chars(skip_blank(p, end), end, x);
        if (error != std::errc() || !std::isfinite(x))
          bad(path, number, "a vertex needs three finite numbers");
        p = next;
      }
      obj.vertices.push_back(v);
    } else if (line.rfind("f ", 0) == 0) {
      std::vector<std::size_t> corner;
      p = skip_blank(p + 1, end);
      while (p < end && *p != '\r') {
        std::size_t index = 0;
        const auto [next, error] = std::from_chars(p, end, index);
        if (error != std::errc() || index < 1 || index > obj.vertices.size())
          bad(path, number, "no such vertex");
        corner.push_back(index - 1);
        p = next;
        while (p < end && *p != ' ' && *p != '\t') ++p;
        p = skip_blank(p, end);
      }
      if (corner.size() < 3) bad(path, number, "a face needs three vertices");
      for (std::size_t k = 1; k + 1 < corner.size(); ++k) {
        obj.faces.push_back({corner[0], corner[k], corner[k + 1]});
        obj.group.push_back(group);
      }
    } else if (line.rfind("g leaf_", 0) == 0) {
      const auto [next, error] = std::from_chars(p + 7, end, group);
      if (error != std::errc() || group == 0) bad(path, number, "expected g leaf_N");
    }
  }
  return obj;
}

}  // namespace

bool meet(const Triangle& a, const Triangle& b) {
  return CGAL::do_intersect(to_cgal(a), to_cgal(b));
}

bool meets(const Triangle& triangle, const Cylinder& cylinder, std::size_t* doubtful) {
  try {
    const CGAL::Protect_FPU_rounding<true> rounding;
    return meets_as<Interval>(triangle, cylinder);
  } catch (const CGAL::Uncertain_conversion_exception&) {
  }
  if (doubtful) ++*doubtful;
  return meets_as<Rational>(triangle, cylinder);
}

std::vector<Triangle> read_obj(const std::filesystem::path& path, std::size_t leaves) {
  const Obj obj = parse_obj(path);
  std::vector<std::size_t> up(obj.vertices.size());
  for (std::size_t i = 0; i < up.size(); ++i) up[i] = i;
  for (const auto& f : obj.faces) {
    up[root_of(up, f[1])] = root_of(up, f[0]);
    up[root_of(up, f[2])] = root_of(up, f[0]);
  }
  if (leaves > 0 && obj.faces.size() % leaves != 0)
    throw std::runtime_error(path.string() + ": " + std::to_string(obj.faces.size()) +
                             " triangles do not make " + std::to_string(leaves) + " leaves of one shape");
  std::vector<Triangle> triangles;
  std::map<std::size_t, std::size_t> leaf_of;
  triangles.reserve(obj.faces.size());
  for (std::size_t i = 0; i < obj.faces.size(); ++i)
    triangles.push_back(obj.triangle(
        i, leaves > 0 ? i / (obj.faces.size() / leaves)
                      : leaf_of.emplace(root_of(up, obj.faces[i][0]), leaf_of.size()).first->second));
  return triangles;
}

std::vector<Triangle> read_grouped_obj(const std::filesystem::path& path) {
  const Obj obj = parse_obj(path);
  std::vector<Triangle> triangles;
  for (std::size_t i = 0; i < obj.faces.size(); ++i) {
    if (obj.group[i] == 0) throw std::runtime_error(path.string() + ": a face before any `g leaf_N`");
    triangles.push_back(obj.triangle(i, obj.group[i] - 1));
  }
  return triangles;
}

std::size_t count_rows(const std::filesystem::path& path) {
  std::ifstream in(path);
  if (!in) throw std::runtime_error(path.string() + ": cannot be read");
  std::size_t rows = 0;
  for (std::string line; std::getline(in, line);) rows += line.size() > 1 ? 1 : 0;
  return rows > 0 ? rows - 1 : 0;
}

std::vector<Cylinder> read_cylinders(const std::filesystem::path& path, double* ground) {
  std::ifstream in(path);
  std::string line;
  if (!in || !std::getline(in, line)) throw std::runtime_error(path.string() + ": cannot be read");
  const std::vector<std::string> names = cells_of(line);
  const auto column = [&](const char* name) {
    const auto found = std::find(names.begin(), names.end(), name);
    if (found == names.end()) bad(path, 1, std::string("no column '") + name + "'");
    return static_cast<std::size_t>(found - names.begin());
  };
  const std::array<std::size_t, 9> at = {column("start_x"), column("start_y"), column("start_z"),
                                         column("axis_x"),  column("axis_y"),  column("axis_z"),
                                         column("length"),  column("radius"),  column("parent")};
  std::vector<Cylinder> out;
  double lowest = std::numeric_limits<double>::infinity();
  for (std::size_t number = 2; std::getline(in, line); ++number) {
    const std::vector<std::string> cells = cells_of(line);
    if (cells.empty() || (cells.size() == 1 && cells[0].empty())) continue;
    std::array<double, 9> v{};
    for (std::size_t k = 0; k < v.size(); ++k) {
      if (at[k] >= cells.size()) bad(path, number, "too few columns");
      const std::string& cell = cells[at[k]];
      const auto [next, error] = std::from_chars(cell.data(), cell.data() + cell.size(), v[k]);
      if (error != std::errc() || !std::isfinite(v[k])) bad(path, number, "'" + cell + "' is not a number");
    }
    out.push_back({{v[0], v[1], v[2]}, {v[3], v[4], v[5]}, v[6], v[7]});
    if (v[8] == 0) lowest = std::min(lowest, v[2]);
  }
  if (ground) *ground = lowest;
  return out;
}

Verdict check(const std::vector<Triangle>& triangles, const std::vector<Cylinder>& wood,
              const double* ground) {
  Verdict verdict;
  verdict.triangles = triangles.size();
  verdict.cylinders = wood.size();
  std::vector<Box> boxes, same, trunk;
  std::set<std::size_t> low;
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    verdict.leaves = std::max(verdict.leaves, triangles[i].leaf + 1);
    if (to_cgal(triangles[i]).is_degenerate()) {
      verdict.degenerate.push_back(i);
      continue;
    }
    boxes.push_back(box_of(triangles[i], i));
    if (ground)
      for (const auto& corner : triangles[i].corner)
        if (corner[2] <= *ground) low.insert(triangles[i].leaf);
  }
  verdict.ground_hits.assign(low.begin(), low.end());
  for (std::size_t i = 0; i < wood.size(); ++i) trunk.push_back(box_of(wood[i], i));

  std::set<std::pair<std::size_t, std::size_t>> leaf_pairs, wood_pairs;
  CGAL::box_intersection_d(boxes.begin(), boxes.end(), trunk.begin(), trunk.end(),
                           [&](const Box& a, const Box& b) {
                             ++verdict.wood_boxes;
                             if (meets(triangles[a.info()], wood[b.info()], &verdict.in_doubt))
                               wood_pairs.emplace(triangles[a.info()].leaf, b.info());
                           });
  CGAL::box_self_intersection_d(boxes.begin(), boxes.end(), [&](const Box& a, const Box& b) {
    const Triangle &s = triangles[a.info()], &t = triangles[b.info()];
    if (s.leaf == t.leaf) return;
    ++verdict.leaf_boxes;
    if (meet(s, t)) leaf_pairs.emplace(std::min(s.leaf, t.leaf), std::max(s.leaf, t.leaf));
  });
  for (const auto& [a, b] : leaf_pairs) verdict.leaf_hits.push_back({a, b});
  for (const auto& [a, b] : wood_pairs) verdict.wood_hits.push_back({a, b});
  return verdict;
}

}  // namespace leafcheck
