// SPDX-License-Identifier: GPL-3.0-or-later
#include "recon/image/radii.h"

#include "recon/image/distance.h"

#include <algorithm>
#include <cmath>

namespace dendrofit {
namespace {

constexpr double kGridBias = 0.3;
constexpr double kGridError = 0.6;  ///< pixels, of a radius from distances
constexpr double kThin = 1.5;       ///< below this the grid is too coarse for distances
constexpr double kThinnest = 0.25;  ///< pixels: less does not darken a pixel enough to be seen

double cover_at(const Silhouette& s, const Eigen::Vector2d& p) {
  const double x = p.x() - 0.5, y = p.y() - 0.5;
  const int x0 = static_cast<int>(std::floor(x)), y0 = static_cast<int>(std::floor(y));
  const double fx = x - x0, fy = y - y0;
  const auto value = [&](int cx, int cy) -> double {
    return cx < 0 || cy < 0 || cx >= s.width || cy >= s.height ? 0 : s.cover[s.pixel(cx, cy)];
  };
  return (1 - fy) * ((1 - fx) * value(x0, y0) + fx * value(x0 + 1, y0)) +
         fy * ((1 - fx) * value(x0, y0 + 1) + fx * value(x0 + 1, y0 + 1));
}

/// Cover summed across the path to both sides of wood `reach` pixels to a side, out to where it has faded or
/// another branch begins.
double width_across(const Silhouette& s, const Eigen::Vector2d& p, const Eigen::Vector2d& across,
                    double reach) {
  constexpr double step = 0.25;
  double sum = cover_at(s, p) * step;
  for (const double side : {-1.0, 1.0}) {
    double before = cover_at(s, p);
    for (double t = step; t <= reach; t += step) {
      const double cover = cover_at(s, p + side * t * across);
      if (cover < 0.02 || (t > reach - 3 && cover > before + 0.02)) break;
      sum += cover * step;
      before = cover;
    }
  }
  return sum;
}

/// The distance at a pixel; of thick wood at its middle, which thinning may miss by a pixel.
double ridge(const Silhouette& s, const std::vector<float>& distance, int x, int y) {
  float best = distance[s.pixel(x, y)];
  if (best < 4) return best;
  for (int ny = std::max(0, y - 1); ny <= std::min(s.height - 1, y + 1); ++ny)
    for (int nx = std::max(0, x - 1); nx <= std::min(s.width - 1, x + 1); ++nx)
      best = std::max(best, distance[s.pixel(nx, ny)]);
  return best;
}

}  // namespace

std::vector<float> solid_distance(const Silhouette& silhouette) {
  std::vector<std::uint8_t> solid(silhouette.tree.size());
  for (std::size_t i = 0; i < solid.size(); ++i) solid[i] = silhouette.tree[i] && silhouette.cover[i] >= 0.5f;
  return distance_inside(solid, silhouette.width, silhouette.height);
}

std::vector<double> path_radii(const Silhouette& silhouette, const std::vector<float>& solid,
                               const std::vector<Eigen::Vector2d>& path, const std::vector<float>& inside) {
  const std::size_t n = path.size();
  std::vector<double> radius(n, 0);
  for (std::size_t i = 0; i < n; ++i) {
    if (inside[i] <= 0) continue;
    const int x = std::clamp(static_cast<int>(path[i].x()), 0, silhouette.width - 1);
    const int y = std::clamp(static_cast<int>(path[i].y()), 0, silhouette.height - 1);
    radius[i] = std::max(kThinnest, ridge(silhouette, solid, x, y) - kGridBias);
    const auto reach = static_cast<std::size_t>(std::max(3L, std::lround(radius[i])));
    const Eigen::Vector2d along = path[std::min(n - 1, i + reach)] - path[i >= reach ? i - reach : 0];
    if (along.norm() < 1) continue;
    const Eigen::Vector2d across(-along.y() / along.norm(), along.x() / along.norm());
    const double half = 0.5 * width_across(silhouette, path[i], across, radius[i] + 3);
    // The widest disc within rough edges is too thin; the width across a fork says nothing.
    if (radius[i] < kThin || std::abs(half - radius[i]) <= kGridError) radius[i] = std::max(kThinnest, half);
  }
  // Gaps take what stands on either side.
  for (std::size_t i = 0; i < n; ++i) {
    if (radius[i] > 0) continue;
    std::size_t end = i;
    while (end < n && radius[end] <= 0) ++end;
    const double left = i > 0 ? radius[i - 1] : (end < n ? radius[end] : kThinnest);
    const double right = end < n ? radius[end] : left;
    for (std::size_t k = i; k < end; ++k) radius[k] = 0.5 * (left + right);
  }
  std::vector<double> smooth(n);
  std::vector<double> window;
  for (std::size_t i = 0; i < n; ++i) {
    const std::size_t reach = std::min<std::size_t>({3, i, n - 1 - i});
    window.assign(radius.begin() + static_cast<std::ptrdiff_t>(i - reach),
                  radius.begin() + static_cast<std::ptrdiff_t>(i + reach + 1));
    std::nth_element(window.begin(), window.begin() + static_cast<std::ptrdiff_t>(reach), window.end());
    smooth[i] = window[reach];
  }
  return smooth;
}

}  // namespace dendrofit
