// SPDX-License-Identifier: GPL-3.0-or-later
// A mask's outline as a signed distance field: what carving and measuring in the picture ask of a mask.
#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

namespace dendrofit {

/// Distance to the outline in pixels, negative inside the mask; the outline runs midway between a pixel of
/// the mask and its neighbour outside. Kept in steps of 1/16 pixel, up to 2,047 pixels.
class Outline {
 public:
  /// Non-zero bytes are the mask, rows from the top. `cover`: share of each pixel that wood covers, where it
  /// is known (else empty). Throws InputError for sizes that do not agree.
  Outline(const std::vector<std::uint8_t>& mask, int width, int height, const std::vector<float>& cover = {});

  int width() const { return width_; }
  int height() const { return height_; }
  bool holds(const Eigen::Vector2d& pixel) const {
    return pixel.x() >= 0 && pixel.y() >= 0 && pixel.x() <= width_ && pixel.y() <= height_;
  }
  /// Bilinear between pixel centres (the first lies at 0.5, 0.5); beyond the frame the least it can be.
  double at(const Eigen::Vector2d& pixel) const;
  bool knows_cover() const { return !cover_.empty(); }
  /// Share that wood covers at a pixel, bilinear; needs knows_cover().
  double cover_at(const Eigen::Vector2d& pixel) const;
  /// Whether the pixel lies beyond a side of the frame that the mask touches, or below what the view tells:
  /// the tree may go on there.
  bool unknown(const Eigen::Vector2d& pixel) const {
    return (touches_left_ && pixel.x() < 0) || (touches_right_ && pixel.x() > width_) ||
           (touches_top_ && pixel.y() < 0) || (touches_bottom_ && pixel.y() > height_) ||
           pixel.y() > told_to_;
  }
  /// The view says nothing below this row (its stem is lost there).
  void tell_nothing_below(int row) { told_to_ = row; }
  /// Last row with a pixel of the mask, -1 without any.
  int lowest_row() const { return lowest_row_; }
  bool inside(int column, int row) const { return distance_[index(column, row)] < 0; }
  std::size_t area_px() const { return area_px_; }
  /// Middle of the mask's pixels and the largest distance of one from there; area_px() > 0.
  Eigen::Vector2d middle() const { return middle_; }
  double reach_px() const { return reach_px_; }
  bool touches_top() const { return touches_top_; }
  bool touches_sides() const { return touches_left_ || touches_right_; }

 private:
  struct Corners {
    std::size_t upper_left, upper_right, lower_left, lower_right;
    double right, down;  // shares
  };
  Corners corners(const Eigen::Vector2d& pixel) const;
  std::size_t index(int column, int row) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(width_) +
           static_cast<std::size_t>(column);
  }
  int width_ = 0, height_ = 0;
  std::vector<std::int16_t> distance_;
  std::vector<std::uint8_t> cover_;  // in 255ths
  std::size_t area_px_ = 0;
  Eigen::Vector2d middle_ = Eigen::Vector2d::Zero();
  double reach_px_ = 0;
  int lowest_row_ = -1;
  double told_to_ = 1e9;
  bool touches_top_ = false, touches_bottom_ = false, touches_left_ = false, touches_right_ = false;
};

}  // namespace dendrofit
