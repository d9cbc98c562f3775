// SPDX-License-Identifier: GPL-3.0-or-later
// Connected pieces of a horizontal slice of a scan.
#pragma once

#include "core/types.h"
#include "recon/graph.h"

#include <cstdint>
#include <vector>

namespace dendrofit {

/// A connected piece of a slice, with a line x = a + b z through it (metres).
struct Piece {
  std::vector<std::uint32_t> points;
  double low = 0, high = 0;  ///< heights above the ground
  Eigen::Vector2d middle{0, 0}, slope{0, 0};
  double middle_z = 0;
  double diameter = 0;  ///< of a ring that scatters as far from the line
  Eigen::Vector2d at(double z) const { return middle + slope * (z - middle_z); }
};

Piece describe_piece(std::vector<std::uint32_t> members, const std::vector<Vec3>& points,
                     const std::vector<double>& height);

/// The pieces of six points and more whose heights lie in [low, high), by their first point.
std::vector<Piece> pieces_between(const std::vector<Vec3>& points, const PointGraph& graph,
                                  const std::vector<double>& height, double low, double high);

/// Whether a piece is wood seen from outside: no thicker than `thin` (metres), or hollow (points on a closed
/// surface), at half of its levels at least. Foliage fills its cross-section.
bool looks_like_wood(const Piece& piece, const std::vector<Vec3>& points, const PointGraph& graph,
                     const std::vector<double>& height, double thin);

}  // namespace dendrofit
