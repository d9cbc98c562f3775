// SPDX-License-Identifier: GPL-3.0-or-later
// Which pieces of a silhouette are one tree, and what kind of a tree it is.
#pragma once

#include "recon/image/segmentation.h"

#include <cstdint>
#include <optional>
#include <vector>

namespace dendrofit {

/// A group of pieces closer together than the gaps of a mask.
struct TreeGroup {
  std::size_t pixels = 0;
  int top = 0, bottom = 0, left = 0, right = 0;    ///< rows and columns, last included
  Eigen::Vector2d foot = Eigen::Vector2d::Zero();  ///< middle of its lowest row
  int height() const { return bottom - top + 1; }
};

/// Pieces joined where they are at most `gap_px` apart; `group` holds each pixel's group, -1 elsewhere.
/// Largest first.
std::vector<TreeGroup> group_pieces(const std::vector<std::uint8_t>& tree, int width, int height,
                                    double gap_px, std::vector<std::int32_t>& group);

/// Keeps one tree (at `root` where given, otherwise the largest), counts the others of at least 0.4 of its
/// height, and says so in `warnings`. Pieces of less than `dust` pixels never are a tree.
void choose_tree(Silhouette& silhouette, const std::optional<Eigen::Vector2d>& root);

/// solid_share, leafy, touches_top, touches_side and their warnings.
void describe_silhouette(Silhouette& silhouette);

}  // namespace dendrofit
