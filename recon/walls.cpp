// SPDX-License-Identifier: GPL-3.0-or-later
#include "recon/walls.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <vector>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>

namespace dendrofit {
namespace {

constexpr double kCell = 0.25;
constexpr double kFlat = 0.02;       // root mean square distance from a cell's plane at most,
constexpr double kWide = 0.035;      // ... and along it at least
constexpr double kSameNormal = 0.9;  // cosine
constexpr double kSamePlane = 0.05;  // metres off the common plane
constexpr double kSmallest = 1.0;    // side
constexpr double kFilled = 0.4;      // share of its rectangle's area; shadows fall on walls
constexpr double kSteepest = 0.85;   // of the normal: what is flatter lies
constexpr std::size_t kFewestPoints = 8;

using Key = std::array<int, 3>;

Key cell_of(const Vec3& p) {
  return {static_cast<int>(std::floor(p.x() / kCell)), static_cast<int>(std::floor(p.y() / kCell)),
          static_cast<int>(std::floor(p.z() / kCell))};
}

/// Sums over points, from which their plane follows.
struct Moments {
  double count = 0;
  Vec3 sum = Vec3::Zero();
  Eigen::Matrix3d square = Eigen::Matrix3d::Zero();

  void add(const Vec3& p) {
    count += 1;
    sum += p;
    square += p * p.transpose();
  }
  void add(const Moments& m) {
    count += m.count;
    sum += m.sum;
    square += m.square;
  }
};

struct Plane {
  Vec3 middle = Vec3::Zero(), normal = Vec3::UnitZ();
  double across = 0, narrow = 0;  // root mean square extents: off the plane, and its lesser one within
  double off(const Vec3& p) const { return std::abs((p - middle).dot(normal)); }
};

Plane plane_of(const Moments& m) {
  Plane plane;
  plane.middle = m.sum / m.count;
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;
  solver.computeDirect(m.square / m.count - plane.middle * plane.middle.transpose());
  plane.normal = solver.eigenvectors().col(0);
  plane.across = std::sqrt(std::max(0.0, solver.eigenvalues()[0]));
  plane.narrow = std::sqrt(std::max(0.0, solver.eigenvalues()[1]));
  return plane;
}

struct Cell {
  Moments moments;
  Plane plane;
  bool taken = false;
};

/// The cells in which points lie flat on a steep plane.
std::map<Key, Cell> flat_cells(const std::vector<Vec3>& points) {
  struct Run {
    Key key;
    Moments moments;
  };
  std::vector<Run> runs;  // points come in the order of a space-filling curve: few runs a cell
  for (const Vec3& p : points) {
    const Key key = cell_of(p);
    if (runs.empty() || runs.back().key != key) runs.push_back({key, {}});
    runs.back().moments.add(p);
  }
  std::stable_sort(runs.begin(), runs.end(), [](const Run& a, const Run& b) { return a.key < b.key; });
  std::map<Key, Cell> cells;
  for (std::size_t i = 0; i < runs.size();) {
    Cell cell;
    const Key key = runs[i].key;
    for (; i < runs.size() && runs[i].key == key; ++i) cell.moments.add(runs[i].moments);
    if (cell.moments.count < static_cast<double>(kFewestPoints)) continue;
    cell.plane = plane_of(cell.moments);
    if (cell.plane.across > kFlat || cell.plane.narrow < kWide || std::abs(cell.plane.normal.z()) > kSteepest)
      continue;
    cells.emplace(key, cell);
  }
  return cells;
}

template <class Visit>
void visit_about(Key key, Visit visit) {  // a copy: what is visited may join the list it stands in
  for (int dx = -1; dx <= 1; ++dx)
    for (int dy = -1; dy <= 1; ++dy)
      for (int dz = -1; dz <= 1; ++dz) visit(Key{key[0] + dx, key[1] + dy, key[2] + dz});
}

struct Wall {
  Plane plane;
  std::vector<Key> cells;
};

/// The flat cells in the seed's plane that are connected with it; the plane follows them as they are found.
Wall grow_wall(std::map<Key, Cell>& cells, const Key& seed) {
  Wall wall;
  Moments all = cells.at(seed).moments;
  wall.plane = cells.at(seed).plane;
  wall.cells.push_back(seed);
  cells.at(seed).taken = true;
  std::size_t settled = 1;
  for (std::size_t m = 0; m < wall.cells.size(); ++m)
    visit_about(wall.cells[m], [&](const Key& key) {
      const auto found = cells.find(key);
      if (found == cells.end() || found->second.taken) return;
      const Plane& own = found->second.plane;
      if (std::abs(own.normal.dot(wall.plane.normal)) < kSameNormal ||
          wall.plane.off(own.middle) > kSamePlane)
        return;
      found->second.taken = true;
      wall.cells.push_back(key);
      all.add(found->second.moments);
      if (wall.cells.size() < 2 * settled) return;
      settled = wall.cells.size();
      wall.plane = plane_of(all);
    });
  wall.plane = plane_of(all);
  return wall;
}

/// Whether a wall is large both ways and mostly there.
bool is_large(const Wall& wall, const std::map<Key, Cell>& cells) {
  const Vec3 along = wall.plane.normal.unitOrthogonal(), other = wall.plane.normal.cross(along);
  Eigen::Matrix2d square = Eigen::Matrix2d::Zero();
  std::vector<Eigen::Vector2d> flat;
  for (const Key& key : wall.cells) {
    const Vec3 d = cells.at(key).plane.middle - wall.plane.middle;
    flat.emplace_back(d.dot(along), d.dot(other));
    square += flat.back() * flat.back().transpose();
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> axes(square);
  std::array<double, 2> side{};
  for (int k = 0; k < 2; ++k) {
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (const Eigen::Vector2d& p : flat) {
      low = std::min(low, p.dot(axes.eigenvectors().col(k)));
      high = std::max(high, p.dot(axes.eigenvectors().col(k)));
    }
    side[static_cast<std::size_t>(k)] = high - low + kCell;
  }
  return std::min(side[0], side[1]) >= kSmallest &&
         static_cast<double>(flat.size()) * kCell * kCell >= kFilled * side[0] * side[1];
}

}  // namespace

std::size_t remove_walls(CleanScan& scan) {
  std::map<Key, Cell> cells = flat_cells(scan.points);
  std::vector<Wall> walls;
  for (const auto& [key, cell] : cells) {
    if (cell.taken) continue;
    Wall wall = grow_wall(cells, key);
    if (is_large(wall, cells)) walls.push_back(std::move(wall));
  }
  if (walls.empty()) return 0;
  std::map<Key, std::vector<std::size_t>> about;  // walls in and beside each cell
  for (std::size_t w = 0; w < walls.size(); ++w)
    for (const Key& key : walls[w].cells)
      visit_about(key, [&](const Key& near) {
        std::vector<std::size_t>& here = about[near];
        if (here.empty() || here.back() != w) here.push_back(w);
      });
  std::size_t kept = 0;
  for (std::size_t i = 0; i < scan.points.size(); ++i) {
    const auto found = about.find(cell_of(scan.points[i]));
    const bool on_wall =
        found != about.end() && std::any_of(found->second.begin(), found->second.end(), [&](std::size_t w) {
          return walls[w].plane.off(scan.points[i]) <= std::max(kFlat, 4 * walls[w].plane.across);
        });
    if (on_wall) continue;
    scan.points[kept] = scan.points[i];
    scan.source[kept++] = scan.source[i];
  }
  const std::size_t removed = scan.points.size() - kept;
  scan.points.resize(kept);
  scan.source.resize(kept);
  return removed;
}

}  // namespace dendrofit
