// SPDX-License-Identifier: GPL-3.0-or-later
// Which pixels of a photograph are the tree.
#pragma once

#include "core/photograph.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace dendrofit {

struct SegmentationOptions {
  double seed_ratio = 0.75;  ///< brightness over the sky's below which a pixel surely is wood
  double grow_ratio = 0.90;  ///< and below which it is, where it touches such pixels
  std::optional<Eigen::Vector2d> root_px = std::nullopt;  ///< a pixel at the stem's foot: chooses the tree
  /// Throws InputError naming field, value and limit.
  void validate() const;
};

/// A tree's outline in one photograph. Rows from the top; every array holds width * height values.
struct Silhouette {
  int width = 0;
  int height = 0;
  std::vector<std::uint8_t> tree;  ///< 1: tree
  std::vector<float> cover;  ///< share of the pixel that wood covers, 0 to 1; sub-pixel widths come from it
  bool from_mask = false;
  double confidence = 1;     ///< below 0.5: a mask is needed
  double solid_share = 0;    ///< of the crown's pixels, those without sky between: leaves
  bool leafy = false;        ///< solid_share too high for a skeleton: only outline metrics
  bool touches_top = false;  ///< the height is a lower bound
  bool touches_side = false;
  std::optional<double> horizon_px = std::nullopt;  ///< row where the sky ends, away from the tree
  int tree_count = 1;                               ///< trees seen; one of them is marked
  std::vector<std::string> warnings;

  std::size_t pixel(int column, int row) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(width) + static_cast<std::size_t>(column);
  }
};

/// The photograph's mask where it has one; otherwise a robust fit of the sky's brightness, hysteresis on the
/// ratio to it, and, below the horizon, GrabCut (Rother et al. 2004) along the stem. Throws SolverError ("no
/// tree found: ...") where nothing stands before the sky, InputError for a photograph that is not one.
Silhouette find_silhouette(const Photograph& photo, const SegmentationOptions& options = {});

}  // namespace dendrofit
