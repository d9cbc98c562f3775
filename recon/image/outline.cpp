// SPDX-License-Identifier: GPL-3.0-or-later
#include "recon/image/outline.h"

#include "core/errors.h"
#include "recon/image/distance.h"

#include <algorithm>
#include <cmath>

namespace dendrofit {
namespace {

constexpr double kStep = 16;  // steps a pixel

}  // namespace

Outline::Outline(const std::vector<std::uint8_t>& mask, int width, int height,
                 const std::vector<float>& cover)
    : width_(width), height_(height) {
  require(width > 0, "width", width, "must be positive");
  require(height > 0, "height", height, "must be positive");
  const std::size_t pixels = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  require(mask.size() == pixels, "mask", static_cast<double>(mask.size()), "must hold one byte a pixel");
  require(cover.empty() || cover.size() == pixels, "cover", static_cast<double>(cover.size()),
          "must hold one value a pixel");
  for (const float share : cover)
    cover_.push_back(static_cast<std::uint8_t>(std::lround(255 * std::clamp(share, 0.0F, 1.0F))));
  Eigen::Vector2d sum(0, 0);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      if (mask[index(x, y)] == 0) continue;
      ++area_px_;
      lowest_row_ = y;
      sum += Eigen::Vector2d(x + 0.5, y + 0.5);
      touches_top_ = touches_top_ || y == 0;
      touches_bottom_ = touches_bottom_ || y == height - 1;
      touches_left_ = touches_left_ || x == 0;
      touches_right_ = touches_right_ || x == width - 1;
    }
  distance_.assign(pixels, static_cast<std::int16_t>(area_px_ > 0 ? -32767 : 32767));
  if (area_px_ == 0 || area_px_ == pixels) return;
  middle_ = sum / static_cast<double>(area_px_);
  const std::vector<float> within = distance_inside(mask, width, height);
  const std::vector<float> without = distance_outside(mask, width, height);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const std::size_t i = index(x, y);
      const double d =
          mask[i] != 0 ? 0.5 - static_cast<double>(within[i]) : static_cast<double>(without[i]) - 0.5;
      distance_[i] = static_cast<std::int16_t>(std::clamp(std::round(d * kStep), -32767.0, 32767.0));
      if (mask[i] != 0) reach_px_ = std::max(reach_px_, (Eigen::Vector2d(x + 0.5, y + 0.5) - middle_).norm());
    }
}

Outline::Corners Outline::corners(const Eigen::Vector2d& pixel) const {
  const double u = std::clamp(pixel.x() - 0.5, 0.0, static_cast<double>(width_ - 1));
  const double v = std::clamp(pixel.y() - 0.5, 0.0, static_cast<double>(height_ - 1));
  const int x = std::min(static_cast<int>(u), std::max(0, width_ - 2));
  const int y = std::min(static_cast<int>(v), std::max(0, height_ - 2));
  const int right = std::min(x + 1, width_ - 1), below = std::min(y + 1, height_ - 1);
  return {index(x, y), index(right, y), index(x, below), index(right, below), u - x, v - y};
}

double Outline::cover_at(const Eigen::Vector2d& pixel) const {
  const Corners c = corners(pixel);
  const double upper = (1 - c.right) * cover_[c.upper_left] + c.right * cover_[c.upper_right];
  const double lower = (1 - c.right) * cover_[c.lower_left] + c.right * cover_[c.lower_right];
  return ((1 - c.down) * upper + c.down * lower) / 255;
}

double Outline::at(const Eigen::Vector2d& pixel) const {
  const Corners c = corners(pixel);
  const double upper = (1 - c.right) * distance_[c.upper_left] + c.right * distance_[c.upper_right];
  const double lower = (1 - c.right) * distance_[c.lower_left] + c.right * distance_[c.lower_right];
  const double distance = ((1 - c.down) * upper + c.down * lower) / kStep;
  const double beyond = std::hypot(pixel.x() - std::clamp(pixel.x(), 0.0, static_cast<double>(width_)),
                                   pixel.y() - std::clamp(pixel.y(), 0.0, static_cast<double>(height_)));
  return beyond > 0 ? std::hypot(beyond, std::max(0.0, distance)) : distance;
}

}  // namespace dendrofit
