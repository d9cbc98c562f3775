// SPDX-License-Identifier: GPL-3.0-or-later
#include "recon/image/foot.h"

#include <algorithm>
#include <cmath>

#include <Eigen/LU>

namespace dendrofit {
namespace {

/// One view's line of sight to the stem's lowest near edge.
struct Sight {
  Vec3 eye, ray;
  double half_width_px = 0;
  const Camera* camera = nullptr;
};

/// The widest run of mask pixels in a row: its middle and half its width.
struct Run {
  double middle = 0, half = 0;
};

Run widest_run(const Outline& outline, int row) {
  Run best;
  for (int x = 0, from = -1; x <= outline.width(); ++x) {
    const bool in = x < outline.width() && outline.inside(x, row);
    if (in && from < 0) from = x;
    if (in || from < 0) continue;
    if (x - from > 2 * best.half) best = {0.5 * (from + x), 0.5 * (x - from)};
    from = -1;
  }
  return best;
}

/// The lowest row whose run is part of a stem: it goes on upwards for as long as it is wide.
std::optional<Sight> lowest_edge(const Camera& camera, const Outline& outline) {
  for (int row = outline.height() - 1; row > 0; --row) {
    const Run run = widest_run(outline, row);
    if (run.half == 0) continue;
    if (row == outline.height() - 1) return std::nullopt;  // the foot lies below the picture
    // The stem's width a little above its round lower end.
    Run above = run;
    for (int up = 1; up <= 3 + static_cast<int>(2 * above.half) && row - up >= 0; ++up) {
      const Run here = widest_run(outline, row - up);
      if (here.half == 0 || std::abs(here.middle - run.middle) > std::max(here.half, run.half) + 1)
        return std::nullopt;
      if (up <= 2 + static_cast<int>(0.5 * above.half)) above = here;
    }
    return Sight{camera.centre(), camera.ray({run.middle, row + 1.0}), above.half, &camera};
  }
  return std::nullopt;
}

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace

std::optional<MaskFoot> foot_of_masks(const std::vector<Camera>& cameras,
                                      const std::vector<Outline>& outlines) {
  std::vector<Sight> sights;
  for (std::size_t v = 0; v < cameras.size(); ++v)
    if (const auto sight = lowest_edge(cameras[v], outlines[v]); sight && sight->ray.head<2>().norm() > 0.3)
      sights.push_back(*sight);
  if (sights.size() < 3) return std::nullopt;
  // In plan the lines of sight meet on the axis: least squares, with falling weight of those that miss it.
  Eigen::Vector2d axis(0, 0);
  double scale = 1e9;
  std::vector<double> off(sights.size(), 0);
  for (int round = 0; round < 10; ++round) {
    Eigen::Matrix2d normal = Eigen::Matrix2d::Zero();
    Eigen::Vector2d right(0, 0);
    for (std::size_t i = 0; i < sights.size(); ++i) {
      const Eigen::Vector2d along = sights[i].ray.head<2>().normalized(), across(-along.y(), along.x());
      const double weight = 1 / (1 + std::pow(off[i] / scale, 2));
      normal += weight * across * across.transpose();
      right += weight * across * across.dot(sights[i].eye.head<2>());
    }
    if (normal.determinant() < 1e-3) return std::nullopt;
    axis = normal.inverse() * right;
    std::vector<double> sorted;
    for (std::size_t i = 0; i < sights.size(); ++i) {
      const Eigen::Vector2d along = sights[i].ray.head<2>().normalized(), across(-along.y(), along.x());
      off[i] = std::abs(across.dot(axis - sights[i].eye.head<2>()));
      sorted.push_back(off[i]);
    }
    scale = std::max(1e-3, 2 * median(sorted));
  }
  std::vector<double> radii, heights;
  for (std::size_t i = 0; i < sights.size(); ++i) {
    const double away = (axis - sights[i].eye.head<2>()).norm();
    if (off[i] > 3 * scale) continue;
    const Camera& camera = *sights[i].camera;
    const Vec3 edge = sights[i].eye + sights[i].ray * (away / sights[i].ray.head<2>().norm());
    radii.push_back(sights[i].half_width_px / camera.fx * camera.depth(edge));
  }
  if (radii.size() < 3) return std::nullopt;
  MaskFoot foot;
  foot.radius_m = median(radii);
  foot.views = radii.size();
  if (scale > 2 * foot.radius_m + 0.02) return std::nullopt;
  for (std::size_t i = 0; i < sights.size(); ++i) {
    if (off[i] > 3 * scale) continue;
    const double near = (axis - sights[i].eye.head<2>()).norm() - foot.radius_m;
    heights.push_back(sights[i].eye.z() + sights[i].ray.z() / sights[i].ray.head<2>().norm() * near);
  }
  foot.position = {axis.x(), axis.y(), median(heights)};
  for (double& h : heights) h = std::abs(h - foot.position.z());
  foot.height_spread_m = median(heights);
  if (foot.height_spread_m > 0.5 * foot.radius_m + 0.05) return std::nullopt;
  return foot;
}

}  // namespace dendrofit
