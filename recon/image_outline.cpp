// SPDX-License-Identifier: GPL-3.0-or-later
#include "recon/image_outline.h"

#include "core/errors.h"
#include "recon/image_distance.h"

#include <algorithm>
#include <cmath>

namespace dendrofit {
namespace {

constexpr double kStep = 16;  // steps a pixel

}  // namespace

Outline::Outline(const std::vector<std::uint8_t>& mask, int width, int height)
    : width_(width), height_(height) {
  require(width > 0, "width", width, "must be positive");
  require(height > 0, "height", height, "must be positive");
  const std::size_t pixels = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  require(mask.size() == pixels, "mask", static_cast<double>(mask.size()), "must hold one byte a pixel");
  Eigen::Vector2d sum(0, 0);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      if (mask[index(x, y)] == 0) continue;
      ++area_px_;
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

double Outline::at(const Eigen::Vector2d& pixel) const {
  const double u = std::clamp(pixel.x() - 0.5, 0.0, static_cast<double>(width_ - 1));
  const double v = std::clamp(pixel.y() - 0.5, 0.0, static_cast<double>(height_ - 1));
  const int x = std::min(static_cast<int>(u), std::max(0, width_ - 2));
  const int y = std::min(static_cast<int>(v), std::max(0, height_ - 2));
  const int right = std::min(x + 1, width_ - 1), below = std::min(y + 1, height_ - 1);
  const double fu = u - x, fv = v - y;
  const double upper = (1 - fu) * distance_[index(x, y)] + fu * distance_[index(right, y)];
  const double lower = (1 - fu) * distance_[index(x, below)] + fu * distance_[index(right, below)];
  const double distance = ((1 - fv) * upper + fv * lower) / kStep;
  const double beyond = std::hypot(pixel.x() - std::clamp(pixel.x(), 0.0, static_cast<double>(width_)),
                                   pixel.y() - std::clamp(pixel.y(), 0.0, static_cast<double>(height_)));
  return beyond > 0 ? std::hypot(beyond, std::max(0.0, distance)) : distance;
}

}  // namespace dendrofit
