// SPDX-License-Identifier: GPL-3.0-or-later
// The independent checker of leaves: reads what was written, decides in exact arithmetic, and shares no line
// with the code that places leaves. Leaf against leaf: CGAL's exact predicate, touching and coplanar overlap
// included. Leaf against wood: each cylinder solid with flat ends, in rational arithmetic, touching included.
#pragma once

#include <array>
#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

namespace leafcheck {

struct Triangle {
  std::array<std::array<double, 3>, 3> corner;
  std::size_t leaf = 0;
};

struct Cylinder {
  std::array<double, 3> start{}, axis{};
  double length = 0, radius = 0;
};

struct Hit {
  std::size_t leaf = 0;
  std::size_t other = 0;  ///< leaf or cylinder, from 0
};

struct Verdict {
  std::size_t leaves = 0, triangles = 0, cylinders = 0;
  std::size_t leaf_boxes = 0;  ///< pairs of boxes of different leaves that meet: what was looked at
  std::size_t wood_boxes = 0;
  std::size_t in_doubt = 0;  ///< wood tests that needed rational numbers
  std::vector<Hit> leaf_hits, wood_hits;
  std::vector<std::size_t> ground_hits, degenerate;
  bool clean() const {
    return leaf_hits.empty() && wood_hits.empty() && ground_hits.empty() && degenerate.empty();
  }
};

/// Triangles of an OBJ; a leaf is what hangs together by shared vertices, or, where `leaves` > 0, each run of
/// (triangles / leaves). Throws std::runtime_error naming file and line.
std::vector<Triangle> read_obj(const std::filesystem::path& path, std::size_t leaves = 0);
/// Triangles of an OBJ whose groups `g leaf_N` name the leaf (from 1) they belong to: petioles.
std::vector<Triangle> read_grouped_obj(const std::filesystem::path& path);
/// Cylinders of a qsm.csv (columns by their names) and the lowest start of a root.
std::vector<Cylinder> read_cylinders(const std::filesystem::path& path, double* ground = nullptr);
/// Data rows of a CSV with a header.
std::size_t count_rows(const std::filesystem::path& path);

Verdict check(const std::vector<Triangle>& triangles, const std::vector<Cylinder>& wood,
              const double* ground);

/// One triangle against one solid cylinder, exactly; `doubtful` counts the cases intervals could not decide.
bool meets(const Triangle& triangle, const Cylinder& cylinder, std::size_t* doubtful = nullptr);
bool meet(const Triangle& a, const Triangle& b);

}  // namespace leafcheck
