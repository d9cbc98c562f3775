// SPDX-License-Identifier: GPL-3.0-or-later
#include "recon/image/lines.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <optional>
#include <tuple>

namespace dendrofit {
namespace {

using Pixel = std::array<int, 2>;

/// The piece each line pixel belongs to, -1 elsewhere; number of pieces.
std::int32_t label_pieces(const LineImage& lines, std::vector<std::int32_t>& piece) {
  piece.assign(lines.on.size(), -1);
  std::int32_t count = 0;
  std::vector<Pixel> stack;
  std::array<Pixel, 8> around;
  for (int y = 0; y < lines.height; ++y)
    for (int x = 0; x < lines.width; ++x) {
      if (!lines.on[lines.at(x, y)] || piece[lines.at(x, y)] >= 0) continue;
      stack.assign(1, {x, y});
      piece[lines.at(x, y)] = count;
      while (!stack.empty()) {
        const auto [px, py] = stack.back();
        stack.pop_back();
        const int n = lines.neighbours(px, py, around);
        for (int k = 0; k < n; ++k) {
          const auto [nx, ny] = around[static_cast<std::size_t>(k)];
          if (piece[lines.at(nx, ny)] >= 0) continue;
          piece[lines.at(nx, ny)] = count;
          stack.push_back({nx, ny});
        }
      }
      ++count;
    }
  return count;
}

/// Direction in which a line ends: from some pixels back to the end; none for a lone pixel.
std::optional<Eigen::Vector2d> end_direction(const LineImage& lines, Pixel end, int steps) {
  Pixel at = end, before = {-9, -9};
  std::array<Pixel, 8> around;
  for (int i = 0; i < steps; ++i) {
    const int n = lines.neighbours(at[0], at[1], around);
    if (n > 2) break;
    const Pixel* next = nullptr;
    for (int k = 0; k < n; ++k)
      if (around[static_cast<std::size_t>(k)] != before) next = &around[static_cast<std::size_t>(k)];
    if (!next) break;
    before = at;
    at = *next;
  }
  const Eigen::Vector2d d(end[0] - at[0], end[1] - at[1]);
  return d.norm() > 0 ? std::optional<Eigen::Vector2d>(d.normalized()) : std::nullopt;
}

struct Join {
  double cost;
  Pixel from, to;
};

double angle_between(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  return std::acos(std::clamp(a.dot(b), -1.0, 1.0));
}

std::int32_t root_of(std::vector<std::int32_t>& parent, std::int32_t i) {
  while (parent[static_cast<std::size_t>(i)] != i) {
    auto& up = parent[static_cast<std::size_t>(i)];
    up = parent[static_cast<std::size_t>(up)];
    i = up;
  }
  return i;
}

void draw(LineImage& lines, Pixel from, Pixel to) {
  const int steps = std::max(std::abs(to[0] - from[0]), std::abs(to[1] - from[1]));
  for (int i = 1; i < steps; ++i) {
    const double t = static_cast<double>(i) / steps;
    const int x = static_cast<int>(std::lround(from[0] + t * (to[0] - from[0])));
    const int y = static_cast<int>(std::lround(from[1] + t * (to[1] - from[1])));
    if (!lines.on[lines.at(x, y)]) lines.on[lines.at(x, y)] = 2;
  }
}

}  // namespace

std::size_t join_pieces(LineImage& lines, double gap_px, double gap_radii, double turn_deg) {
  std::vector<std::int32_t> piece;
  const std::int32_t pieces = label_pieces(lines, piece);
  std::vector<Join> joins;
  std::array<Pixel, 8> around;
  for (int y = 0; y < lines.height; ++y)
    for (int x = 0; x < lines.width; ++x) {
      if (!lines.on[lines.at(x, y)] || lines.neighbours(x, y, around) > 1) continue;
      const std::int32_t own = piece[lines.at(x, y)];
      const double radius = lines.distance[lines.at(x, y)];
      const double reach = std::max(gap_px, gap_radii * radius) + radius;
      const auto direction = end_direction(lines, {x, y}, static_cast<int>(std::max(6.0, 3 * radius)));
      const int r = static_cast<int>(std::ceil(reach));
      for (int ny = std::max(0, y - r); ny <= std::min(lines.height - 1, y + r); ++ny)
        for (int nx = std::max(0, x - r); nx <= std::min(lines.width - 1, x + r); ++nx) {
          const std::int32_t other = piece[lines.at(nx, ny)];
          if (other < 0 || other == own) continue;
          const Eigen::Vector2d gap(nx - x, ny - y);
          const double length = gap.norm();
          // The outlines' gap is shorter than the lines' by the far radius.
          if (length - lines.distance[lines.at(nx, ny)] > reach) continue;
          double turn = 0;
          if (direction) {
            turn = angle_between(*direction, gap / length);
            // The grid itself bends a short step by up to half a pixel at either end.
            if (turn > turn_deg * std::numbers::pi / 180 + std::atan(0.7 / length)) continue;
          }
          joins.push_back({length * (1 + turn), {x, y}, {nx, ny}});
        }
    }
  std::sort(joins.begin(), joins.end(), [](const Join& l, const Join& r) {
    return std::tie(l.cost, l.from, l.to) < std::tie(r.cost, r.from, r.to);
  });
  std::vector<std::int32_t> parent(static_cast<std::size_t>(pieces));
  std::iota(parent.begin(), parent.end(), 0);
  std::size_t made = 0;
  for (const Join& join : joins) {
    const std::int32_t a = root_of(parent, piece[lines.at(join.from[0], join.from[1])]);
    const std::int32_t b = root_of(parent, piece[lines.at(join.to[0], join.to[1])]);
    if (a == b) continue;
    parent[static_cast<std::size_t>(b)] = a;
    draw(lines, join.from, join.to);
    ++made;
  }
  return made;
}

}  // namespace dendrofit
