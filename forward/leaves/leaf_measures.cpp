// SPDX-License-Identifier: GPL-3.0-or-later
#include "forward/leaves/leaf_measures.h"

#include "core/parallel.h"
#include "core/point_cloud.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <utility>

#include <Eigen/Geometry>

namespace dendrofit {
namespace {

constexpr double kPi = std::numbers::pi;

Vec3 middle(const Leaf& leaf) {
  return leaf.origin + 0.5 * leaf.length_m * leaf.direction;
}

/// Mean |cos| between a direction at zenith `view` and normals at inclination `lean` of every azimuth (Ross
/// 1981).
double mean_projection(double view, double lean) {
  const double cc = std::abs(std::cos(view) * std::cos(lean)), ss = std::sin(view) * std::sin(lean);
  if (cc >= ss) return cc;
  const double psi = std::acos(cc / ss);
  return cc * (1 - 2 * psi / kPi) + 2 / kPi * ss * std::sin(psi);
}

/// Marks the pixels whose centres lie in the triangle's plan view.
void cover(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& lo, double pixel, std::int64_t width,
           std::int64_t height, std::vector<char>& covered) {
  const auto column = [&](double x) { return (x - lo.x()) / pixel - 0.5; };
  const auto row = [&](double y) { return (y - lo.y()) / pixel - 0.5; };
  const double ax = column(a.x()), ay = row(a.y()), bx = column(b.x()), by = row(b.y()), cx = column(c.x()),
               cy = row(c.y());
  const double area = (bx - ax) * (cy - ay) - (by - ay) * (cx - ax);
  if (area == 0) return;
  const auto first_y = static_cast<std::int64_t>(std::ceil(std::min({ay, by, cy})));
  const auto last_y = static_cast<std::int64_t>(std::floor(std::max({ay, by, cy})));
  const auto first_x = static_cast<std::int64_t>(std::ceil(std::min({ax, bx, cx})));
  const auto last_x = static_cast<std::int64_t>(std::floor(std::max({ax, bx, cx})));
  for (std::int64_t y = std::max<std::int64_t>(0, first_y); y <= std::min(height - 1, last_y); ++y)
    for (std::int64_t x = std::max<std::int64_t>(0, first_x); x <= std::min(width - 1, last_x); ++x) {
      const double px = static_cast<double>(x), py = static_cast<double>(y);
      const double u = ((bx - px) * (cy - py) - (by - py) * (cx - px)) / area;
      const double v = ((cx - px) * (ay - py) - (cy - py) * (ax - px)) / area;
      if (u >= 0 && v >= 0 && u + v <= 1)
        std::atomic_ref(covered[static_cast<std::size_t>(y * width + x)]).store(1, std::memory_order_relaxed);
    }
}

}  // namespace

std::vector<double> leaf_area_profile(const Foliage& foliage, double foot_z, double step_m) {
  std::vector<double> profile;
  for (std::size_t i = 0; i < foliage.size(); ++i) {
    const double at = std::max(0.0, (middle(foliage.leaves[i]).z() - foot_z) / step_m);
    const auto k = static_cast<std::size_t>(at);
    if (k >= profile.size()) profile.resize(k + 1, 0);
    profile[k] += foliage.leaf_area(i) / step_m;
  }
  return profile;
}

std::vector<LeafVoxel> leaf_voxels(const Foliage& foliage, double edge_m) {
  std::vector<std::pair<std::array<std::int32_t, 3>, double>> parts;
  parts.reserve(foliage.size());
  for (std::size_t i = 0; i < foliage.size(); ++i) {
    const Vec3 at = (middle(foliage.leaves[i]) / edge_m).array().floor();
    parts.push_back({{static_cast<std::int32_t>(at.x()), static_cast<std::int32_t>(at.y()),
                      static_cast<std::int32_t>(at.z())},
                     foliage.leaf_area(i)});
  }
  std::stable_sort(parts.begin(), parts.end(),
                   [](const auto& a, const auto& b) { return a.first < b.first; });
  std::vector<LeafVoxel> voxels;
  for (const auto& [index, area] : parts) {
    if (voxels.empty() || voxels.back().index != index) voxels.push_back({index, 0});
    voxels.back().density_m2_per_m3 += area / (edge_m * edge_m * edge_m);
  }
  return voxels;
}

std::array<double, 10> projection_function(const Foliage& foliage) {
  std::array<double, 10> g{};
  double total = 0;
  const std::size_t stride = foliage.size() / 20000 + 1;
  for (std::size_t i = 0; i < foliage.size(); i += stride) {
    const Leaf& leaf = foliage.leaves[i];
    const LeafShape& shape = foliage.shapes[leaf.shape];
    const Vec3 across = leaf.direction.cross(leaf.normal);
    for (const auto& t : shape.triangles) {
      const Vec3 n =
          (shape.vertices[t[1]] - shape.vertices[t[0]]).cross(shape.vertices[t[2]] - shape.vertices[t[0]]);
      const double area = 0.5 * n.norm() * leaf.length_m * leaf.length_m;
      const double up =
          (n.x() * across.z() + n.y() * leaf.direction.z() + n.z() * leaf.normal.z()) / n.norm();
      const double lean = std::acos(std::clamp(std::abs(up), 0.0, 1.0));
      for (std::size_t k = 0; k < g.size(); ++k)
        g[k] += area * mean_projection(static_cast<double>(k) * kPi / 18, lean);
      total += area;
    }
  }
  if (total > 0)
    for (double& value : g) value /= total;
  return g;
}

double covered_area(const Foliage& foliage, double pixel_m, int threads) {
  Bounds bounds;
  double reach = 0;
  for (const LeafShape& shape : foliage.shapes)
    for (const Vec3& v : shape.vertices) reach = std::max(reach, v.norm());
  for (const Leaf& leaf : foliage.leaves) {
    bounds.add(leaf.origin - Vec3::Constant(reach * leaf.length_m));
    bounds.add(leaf.origin + Vec3::Constant(reach * leaf.length_m));
  }
  if (bounds.empty()) return 0;
  const double pixel = std::max(pixel_m, std::max(bounds.size().x(), bounds.size().y()) / 8000);
  const auto width = static_cast<std::int64_t>(bounds.size().x() / pixel) + 1;
  const auto height = static_cast<std::int64_t>(bounds.size().y() / pixel) + 1;
  std::vector<char> covered(static_cast<std::size_t>(width * height), 0);
  // Whoever marks a pixel marks it alike: the outcome does not depend on the order.
  parallel_blocks(foliage.size(), 4096, threads, [&](std::size_t first, std::size_t last) {
    std::vector<Vec3> v;
    for (std::size_t i = first; i < last; ++i) {
      const LeafShape& shape = foliage.shapes[foliage.leaves[i].shape];
      blade_vertices(foliage.leaves[i], shape, v);
      for (const auto& t : shape.triangles)
        cover(v[t[0]], v[t[1]], v[t[2]], bounds.lo, pixel, width, height, covered);
    }
  });
  return static_cast<double>(std::count(covered.begin(), covered.end(), 1)) * pixel * pixel;
}

void measure_foliage(const Foliage& foliage, double foot_z, int threads, LeafReport& report) {
  report.achieved_count = foliage.size();
  report.achieved_area_m2 = foliage.total_area();
  report.leaf_area_density = leaf_area_profile(foliage, foot_z, report.profile_step_m);
  report.voxels = leaf_voxels(foliage, report.voxel_m);
  report.g_function = projection_function(foliage);
  if (!(report.crown_area_m2 > 0)) return;
  report.lai = report.achieved_area_m2 / report.crown_area_m2;
  report.gap_fraction = std::max(0.0, 1 - covered_area(foliage, 0.005, threads) / report.crown_area_m2);
  // Beer's law with a clumping factor (Nilson 1971), towards the zenith.
  const double depth = report.g_function[0] * report.lai;
  if (depth > 0 && report.gap_fraction > 0 && report.gap_fraction < 1)
    report.clumping = -std::log(report.gap_fraction) / depth;
}

}  // namespace dendrofit
