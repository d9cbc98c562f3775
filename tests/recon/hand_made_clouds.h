// SPDX-License-Identifier: GPL-3.0-or-later
// Tiny clouds of known wood.
#pragma once

#include "core/point_cloud.h"
#include "core/random.h"
#include "recon/cylinder_fit.h"

#include <cmath>
#include <numbers>
#include <vector>

namespace dendrofit::test {

/// Points on the mantle of a straight cone frustum, `step` apart, with isotropic noise. `from`, `to` in turns
/// limit the visible arc.
inline void add_wood(PointCloud& cloud, const Vec3& base, const Vec3& tip, double r0, double r1, double step,
                     double noise = 0, double from = 0, double to = 1) {
  Random random = Random(7).child({cloud.size()});
  const Vec3 run = tip - base;
  const double length = run.norm();
  Vec3 u, v;
  plane_frame(run / length, u, v);
  const int rings = std::max(1, static_cast<int>(length / step));
  for (int i = 0; i <= rings; ++i) {
    const double t = static_cast<double>(i) / rings, r = (1 - t) * r0 + t * r1;
    const int around = std::max(4, static_cast<int>(2 * std::numbers::pi * r / step));
    for (int k = 0; k < around; ++k) {
      const double turn = (k + 0.5 * (i % 2)) / around;
      if (turn < from || turn > to) continue;
      const double a = 2 * std::numbers::pi * turn;
      const Vec3 jitter(random.normal(), random.normal(), random.normal());
      cloud.points.push_back(base + t * run + r * (std::cos(a) * u + std::sin(a) * v) + noise * jitter);
    }
  }
}

/// A 3 m stem with two branches.
inline PointCloud small_tree(double noise = 0.001) {
  PointCloud cloud;
  add_wood(cloud, {0, 0, 0}, {0, 0, 3}, 0.05, 0.01, 0.008, noise);
  add_wood(cloud, {0.03, 0, 1.5}, {0.8, 0, 2.1}, 0.015, 0.006, 0.008, noise);
  add_wood(cloud, {0, -0.03, 1.9}, {0, -0.7, 2.4}, 0.012, 0.005, 0.008, noise);
  return cloud;
}

/// The cloud after a file that holds its world coordinates, moved by `shift`, as doubles.
inline PointCloud moved(const PointCloud& cloud, const Vec3& shift) {
  PointCloud there = cloud;
  there.origin_shift = (cloud.origin_shift + shift).array().round();
  for (Vec3& p : there.points) p = Vec3(p + cloud.origin_shift + shift) - there.origin_shift;
  return there;
}

/// Places in the world that scans are moved to: UTM, another grid off every decimal, next door.
inline const std::vector<Vec3>& places() {
  static const std::vector<Vec3> all = {
      {500000, 5000000, 0}, {-312345.678, 6123456.789, 1234.5}, {0.4999, 1 / 3.0, -0.7}};
  return all;
}

}  // namespace dendrofit::test
