// SPDX-License-Identifier: GPL-3.0-or-later
// Silhouettes drawn with strokes of known radius.
#pragma once

#include "recon/image/segmentation.h"

#include <algorithm>
#include <cmath>

namespace dendrofit::test {

struct Drawing {
  Silhouette silhouette;

  Drawing(int width, int height) {
    silhouette.width = width;
    silhouette.height = height;
    silhouette.from_mask = true;
    silhouette.tree.assign(static_cast<std::size_t>(width) * static_cast<std::size_t>(height), 0);
    silhouette.cover.assign(silhouette.tree.size(), 0);
  }
  /// A stroke with flat ends from (x0, y0) with radius r0 to (x1, y1) with r1; `end_round`: a disc at the
  /// end.
  Drawing& stroke(double x0, double y0, double r0, double x1, double y1, double r1, bool end_round = true) {
    const Eigen::Vector2d a(x0, y0), d(x1 - x0, y1 - y0);
    for (int y = 0; y < silhouette.height; ++y)
      for (int x = 0; x < silhouette.width; ++x) {
        const Eigen::Vector2d p = Eigen::Vector2d(x + 0.5, y + 0.5) - a;
        const double t = p.dot(d) / d.squaredNorm();
        if (t < 0 || (t > 1 && !end_round)) continue;
        const double u = std::min(t, 1.0);
        if ((p - u * d).norm() <= r0 + u * (r1 - r0)) mark(x, y, 1);
      }
    return *this;
  }
  Drawing& erase(int x0, int y0, int x1, int y1) {
    for (int y = y0; y < y1; ++y)
      for (int x = x0; x < x1; ++x) mark(x, y, 0);
    return *this;
  }

 private:
  void mark(int x, int y, std::uint8_t value) {
    silhouette.tree[silhouette.pixel(x, y)] = value;
    silhouette.cover[silhouette.pixel(x, y)] = value;
  }
};

/// A fork: a stem of radius 10 from the bottom, two arms of radius 5.
inline Drawing drawn_fork() {
  Drawing drawing(300, 400);
  drawing.stroke(150, 390, 10, 150, 200, 10).stroke(150, 200, 6, 70, 60, 5).stroke(150, 200, 6, 230, 60, 5);
  return drawing;
}

}  // namespace dendrofit::test
