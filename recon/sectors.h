// SPDX-License-Identifier: GPL-3.0-or-later
// How much of a circle's circumference has points.
#pragma once

#include "core/types.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <numbers>

namespace dendrofit {

/// The sectors, 24 of them, in which directions from a middle lie.
class Sectors {
 public:
  static constexpr int kAll = 24;

  void add(const Eigen::Vector2d& d) {
    if (seen_ == (1U << kAll) - 1) return;
    // Near a border the exact angle decides.
    constexpr double kDoubt = 1e-4;
    const double place = rough_turn(d.x(), d.y()) * kAll;
    const int sector = static_cast<int>(place);
    const double past = place - sector;
    if (past > kDoubt && past < 1 - kDoubt) {
      seen_ |= 1U << std::min(kAll - 1, sector);
    } else {
      const double turn = (std::atan2(d.y(), d.x()) + std::numbers::pi) / (2 * std::numbers::pi);
      seen_ |= 1U << std::min(kAll - 1, static_cast<int>(turn * kAll));
    }
  }
  int count() const { return std::popcount(seen_); }
  double share() const { return static_cast<double>(count()) / kAll; }

 private:
  /// (atan2(y, x) + pi) / (2 pi) to 2e-6, for a fraction of its time (Abramowitz & Stegun 1964, 4.4.47).
  static double rough_turn(double x, double y) {
    const double a = std::abs(x), b = std::abs(y);
    const bool steep = b > a;
    const double longer = steep ? b : a, shorter = steep ? a : b;
    if (!(longer > 0)) return 0.5;
    const double t = shorter / longer, s = t * t;
    double angle = t * (0.9998660 + s * (-0.3302995 + s * (0.1801410 + s * (-0.0851330 + s * 0.0208351))));
    if (steep) angle = 0.5 * std::numbers::pi - angle;
    if (x < 0) angle = std::numbers::pi - angle;
    return 0.5 + (y < 0 ? -angle : angle) / (2 * std::numbers::pi);
  }

  std::uint32_t seen_ = 0;
};

}  // namespace dendrofit
