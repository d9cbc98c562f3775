// SPDX-License-Identifier: GPL-3.0-or-later
#include "recon/pieces.h"

#include "recon/cylinder_fit.h"

#include <algorithm>
#include <cmath>

namespace dendrofit {

Piece describe_piece(std::vector<std::uint32_t> members, const std::vector<Vec3>& points,
                     const std::vector<double>& height) {
  Piece piece;
  piece.points = std::move(members);
  const auto n = static_cast<double>(piece.points.size());
  piece.low = 1e300;
  piece.high = -1e300;
  Vec3 mean = Vec3::Zero();
  for (const std::uint32_t i : piece.points) {
    mean += points[i] / n;
    piece.low = std::min(piece.low, height[i]);
    piece.high = std::max(piece.high, height[i]);
  }
  double zz = 0;
  Eigen::Vector2d xz(0, 0);
  for (const std::uint32_t i : piece.points) {
    const Vec3 d = points[i] - mean;
    zz += d.z() * d.z();
    xz += d.z() * d.head<2>();
  }
  if (zz > 0) piece.slope = xz / zz;
  // A ring of radius R has a mean square distance R^2 from its middle.
  double spread = 0;
  for (const std::uint32_t i : piece.points) {
    const Vec3 d = points[i] - mean;
    spread += (d.head<2>() - piece.slope * d.z()).squaredNorm() / n;
  }
  piece.middle = mean.head<2>();
  piece.middle_z = mean.z();
  piece.diameter = 2 * std::sqrt(spread);
  return piece;
}

namespace {

/// Closes the open points connected with `seed` and puts them into `members`.
void take_connected(const PointGraph& graph, std::uint32_t seed, std::vector<char>& open,
                    std::vector<std::uint32_t>& members) {
  members.assign(1, seed);
  open[seed] = 0;
  for (std::size_t m = 0; m < members.size(); ++m)
    for (const std::uint32_t v : graph.of(members[m]))
      if (open[v]) {
        open[v] = 0;
        members.push_back(v);
      }
}

}  // namespace

std::vector<Piece> pieces_between(const std::vector<Vec3>& points, const PointGraph& graph,
                                  const std::vector<double>& height, double low, double high) {
  std::vector<Piece> pieces;
  std::vector<char> open(points.size(), 0);
  for (std::size_t i = 0; i < points.size(); ++i) open[i] = height[i] >= low && height[i] < high;
  std::vector<std::uint32_t> members;
  for (std::uint32_t i = 0; i < points.size(); ++i) {
    if (!open[i]) continue;
    take_connected(graph, i, open, members);
    if (members.size() >= 6) pieces.push_back(describe_piece(members, points, height));
  }
  return pieces;
}

bool looks_like_wood(const Piece& piece, const std::vector<Vec3>& points, const PointGraph& graph,
                     const std::vector<double>& height, double thin) {
  constexpr int kLevels = 4;
  constexpr double kHollow = 0.2;  // scatter about the circle over its radius; a filled disc has 0.35
  if (piece.diameter <= thin) return true;
  std::vector<std::vector<std::uint32_t>> level(kLevels);
  for (const std::uint32_t i : piece.points) {
    const double share = (height[i] - piece.low) / (piece.high - piece.low);
    level[static_cast<std::size_t>(std::clamp(static_cast<int>(share * kLevels), 0, kLevels - 1))].push_back(
        i);
  }
  std::vector<char> open(points.size(), 0);
  std::vector<std::uint32_t> members;
  std::vector<Eigen::Vector2d> flat;
  int good = 0;
  for (const auto& all : level) {
    bool found = false;
    std::size_t most = 0;
    for (const std::uint32_t i : all) open[i] = 1;
    for (const std::uint32_t seed : all) {
      if (!open[seed]) continue;
      take_connected(graph, seed, open, members);
      if (members.size() < 6 || members.size() <= most) continue;  // a level's largest cluster speaks for it
      most = members.size();
      const Piece part = describe_piece(members, points, height);
      flat.clear();
      for (const std::uint32_t i : members)
        flat.push_back(points[i].head<2>() - part.middle - part.slope * (points[i].z() - part.middle_z));
      const CircleFit fit = algebraic_circle(flat);
      found =
          part.diameter <= thin || (fit.ok && fit.rms < kHollow * fit.radius && fit.radius < piece.diameter);
    }
    good += found;
  }
  return 2 * good >= kLevels;
}

}  // namespace dendrofit
