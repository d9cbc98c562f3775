// SPDX-License-Identifier: GPL-3.0-or-later
#include "recon/preprocess.h"

#include "core/errors.h"
#include "recon/radix_sort.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <string>

#include <pcl/console/print.h>
#include <pcl/point_cloud.h>
#include <pcl/point_types.h>
#include <pcl/sample_consensus/ransac.h>
#include <pcl/sample_consensus/sac_model_perpendicular_plane.h>

namespace dendrofit {
namespace {

// Raw points go to a lattice of whole steps from the cloud's own corner before anything looks at them; all
// later arithmetic starts from these integers. A map coordinate's last bit is a nanometre at most, so a moved
// cloud gives the same integers unless a point lies that close to a cut: never where its coordinates are
// decimal fractions down to 10 nm (the cut is none), and for others, the coarser the lattice the rarer.
constexpr double kStep_m = 0.001;         // a third of what good scanners scatter
constexpr std::int64_t kFewestSteps = 4;  // a voxel
constexpr double kCut = 0.51234567;

std::uint64_t spread_bits(std::uint64_t v) {
  v &= 0x1fffff;
  v = (v | v << 32) & 0x1f00000000ffffULL;
  v = (v | v << 16) & 0x1f0000ff0000ffULL;
  v = (v | v << 8) & 0x100f00f00f00f00fULL;
  v = (v | v << 4) & 0x10c30c30c30c30c3ULL;
  return (v | v << 2) & 0x1249249249249249ULL;
}

/// A cloud's lattice, and the voxels as blocks of it.
struct Lattice {
  Vec3 corner;
  std::int64_t steps;  // a voxel's side
  double step_m;

  Lattice(const Vec3& low, double voxel_m)
      : corner(low),
        steps(std::max(kFewestSteps, static_cast<std::int64_t>(std::ceil(voxel_m / kStep_m)))),
        step_m(voxel_m / static_cast<double>(steps)) {}
  using Place = std::array<std::int64_t, 3>;
  Place of(const Vec3& p) const {
    const auto along = [&](int axis) {
      return static_cast<std::int64_t>(std::floor((p[axis] - corner[axis]) / step_m + kCut));
    };
    return {along(0), along(1), along(2)};
  }
  std::uint64_t morton_voxel(const Place& at) const {
    const auto along = [&](std::size_t axis) {
      return spread_bits(static_cast<std::uint64_t>(at[axis] / steps)) << axis;
    };
    return along(0) | along(1) | along(2);
  }
};

/// The lowest believable height of each plan cell: the third lowest point, so that two stray points cannot
/// lower it.
struct LowestRaster {
  Bounds bounds;
  double cell;
  int columns, rows;
  std::vector<double> low;
  std::vector<int> count;

  LowestRaster(const std::vector<Vec3>& points, double cell_m) : bounds(bounds_of(points)), cell(cell_m) {
    columns = static_cast<int>(bounds.size().x() / cell) + 1;
    rows = static_cast<int>(bounds.size().y() / cell) + 1;
    const auto cells = static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows);
    constexpr double kNone = std::numeric_limits<double>::infinity();
    std::vector<std::array<double, 3>> lowest(cells, {kNone, kNone, kNone});
    count.assign(cells, 0);
    for (const Vec3& p : points) {
      const std::size_t c = index(p);
      ++count[c];
      auto& l = lowest[c];
      if (p.z() >= l[2]) continue;
      l[2] = p.z();
      if (l[2] < l[1]) std::swap(l[1], l[2]);
      if (l[1] < l[0]) std::swap(l[0], l[1]);
    }
    low.resize(cells);
    for (std::size_t c = 0; c < cells; ++c) low[c] = lowest[c][2];
  }
  std::size_t index(const Vec3& p) const {
    const int i = std::clamp(static_cast<int>((p.x() - bounds.lo.x()) / cell), 0, columns - 1);
    const int j = std::clamp(static_cast<int>((p.y() - bounds.lo.y()) / cell), 0, rows - 1);
    return static_cast<std::size_t>(j) * static_cast<std::size_t>(columns) + static_cast<std::size_t>(i);
  }
  Vec3 centre(std::size_t c) const {
    const auto w = static_cast<std::size_t>(columns);
    return {bounds.lo.x() + (static_cast<double>(c % w) + 0.5) * cell,
            bounds.lo.y() + (static_cast<double>(c / w) + 0.5) * cell, low[c]};
  }
};

struct Plane {
  double a = 0, b = 0, c = 0;  // z = a x + b y + c
  std::size_t inliers = 0;
  double at(double x, double y) const { return a * x + b * y + c; }
};

/// Robust plane through the cells' lowest heights, at most 45 degrees steep.
Plane robust_plane(const LowestRaster& raster, double tolerance) {
  pcl::PointCloud<pcl::PointXYZ>::Ptr cloud(new pcl::PointCloud<pcl::PointXYZ>);
  for (std::size_t c = 0; c < raster.low.size(); ++c)
    if (raster.count[c] >= 3)
      cloud->push_back([&] {
        const Eigen::Vector3f p = raster.centre(c).cast<float>();
        return pcl::PointXYZ(p.x(), p.y(), p.z());
      }());
  Plane plane;
  if (cloud->size() < 3) return plane;
  pcl::console::setVerbosityLevel(pcl::console::L_ALWAYS);  // a library does not print
  // Not by way of SACSegmentation: its library takes longer to load than a small scan to reconstruct.
  const auto model = std::make_shared<pcl::SampleConsensusModelPerpendicularPlane<pcl::PointXYZ>>(cloud);
  model->setAxis(Eigen::Vector3f::UnitZ());
  model->setEpsAngle(M_PI / 4);
  pcl::RandomSampleConsensus<pcl::PointXYZ> ransac(model, tolerance);
  ransac.setMaxIterations(500);
  if (!ransac.computeModel()) return plane;
  pcl::Indices inliers;
  ransac.getInliers(inliers);
  Eigen::VectorXf rough, fitted;
  ransac.getModelCoefficients(rough);
  model->optimizeModelCoefficients(inliers, rough, fitted);
  model->selectWithinDistance(fitted, tolerance, inliers);
  if (inliers.empty() || fitted.size() != 4 || std::abs(fitted[2]) < 0.5f) return plane;
  plane.a = -fitted[0] / fitted[2];
  plane.b = -fitted[1] / fitted[2];
  plane.c = -fitted[3] / fitted[2];
  plane.inliers = inliers.size();
  return plane;
}

}  // namespace

void PreprocessOptions::validate() const {
  require(std::isfinite(voxel_size_m) && voxel_size_m >= 1e-4 && voxel_size_m <= 0.5, "voxel_size_m",
          voxel_size_m, "must lie between 0.1 mm and 0.5 m");
  require(std::isfinite(ground_cell_m) && ground_cell_m >= 0.05 && ground_cell_m <= 5, "ground_cell_m",
          ground_cell_m, "must lie between 0.05 and 5 m");
}

CleanScan clean_scan(const PointCloud& cloud, const PreprocessOptions& options, Progress& progress) {
  options.validate();
  CleanScan clean;
  clean.raw_points = cloud.size();
  if (cloud.empty()) return clean;
  progress.begin("clean", static_cast<double>(cloud.size()), "points");
  const Bounds bounds = bounds_of(cloud.points);
  if (!bounds.lo.allFinite() || !bounds.hi.allFinite())
    throw InputError("point cloud: a coordinate is not finite; remove such points first");
  // 21 bits an axis: a scene too wide for the asked voxel gets the finest one that fits.
  const double voxel = std::max(options.voxel_size_m, bounds.size().maxCoeff() / 2.0e6);
  clean.origin_shift = cloud.origin_shift + bounds.lo;

  const Lattice lattice(bounds.lo, voxel);
  std::vector<KeyedIndex> order(cloud.size());
  for (std::size_t i = 0; i < cloud.size(); ++i)
    order[i] = {lattice.morton_voxel(lattice.of(cloud.points[i])), static_cast<std::uint32_t>(i)};
  progress.check();
  radix_sort(order);
  progress.check();
  for (std::size_t i = 0; i < order.size();) {
    Lattice::Place sum{};
    std::size_t j = i;
    for (; j < order.size() && order[j].key == order[i].key; ++j) {
      const Lattice::Place at = lattice.of(cloud.points[order[j].index]);
      for (std::size_t axis = 0; axis < 3; ++axis) sum[axis] += at[axis];
    }
    const double scale = lattice.step_m / static_cast<double>(j - i);
    clean.points.push_back(scale * Vec3(double(sum[0]), double(sum[1]), double(sum[2])));
    clean.source.push_back(order[i].index);
    i = j;
  }
  progress.end();
  return clean;
}

double Ground::height_at(double x, double y) const {
  const double u = std::clamp(x / cell_m - 0.5, 0.0, static_cast<double>(columns - 1));
  const double v = std::clamp(y / cell_m - 0.5, 0.0, static_cast<double>(rows - 1));
  const int i = std::min(static_cast<int>(u), std::max(0, columns - 2));
  const int j = std::min(static_cast<int>(v), std::max(0, rows - 2));
  const auto at = [&](int a, int b) {
    return height[static_cast<std::size_t>(std::min(b, rows - 1)) * static_cast<std::size_t>(columns) +
                  static_cast<std::size_t>(std::min(a, columns - 1))];
  };
  const double fu = u - i, fv = v - j;
  return (1 - fv) * ((1 - fu) * at(i, j) + fu * at(i + 1, j)) +
         fv * ((1 - fu) * at(i, j + 1) + fu * at(i + 1, j + 1));
}

Ground find_ground(const std::vector<Vec3>& points, const PreprocessOptions& options) {
  constexpr double kPlaneTolerance = 0.2;  // bumps about the plane
  constexpr double kReach = 0.6;           // of local heights about the plane
  constexpr double kNothingBelow = 0.3;    // deeper than this under the plane there must be nothing ...
  constexpr double kStrayShare = 0.002;    // ... but strays
  constexpr std::size_t kFewestCells = 12;
  Ground ground;
  if (points.size() < 100) return ground;
  const LowestRaster raster(points, options.ground_cell_m);
  const Plane plane = robust_plane(raster, kPlaneTolerance);
  const auto occupied = static_cast<std::size_t>(
      std::count_if(raster.count.begin(), raster.count.end(), [](int n) { return n >= 3; }));
  if (plane.inliers < kFewestCells || 4 * plane.inliers < occupied) return ground;
  std::size_t below = 0, near = 0;
  for (const Vec3& p : points) {
    const double h = p.z() - plane.at(p.x(), p.y());
    below += h < -kNothingBelow;
    near += std::abs(h) <= kPlaneTolerance;
  }
  if (static_cast<double>(below) > kStrayShare * static_cast<double>(points.size()) || near < 4 * below)
    return ground;

  ground.present = true;
  ground.cell_m = raster.cell;
  ground.columns = raster.columns;
  ground.rows = raster.rows;
  const std::size_t cells = raster.low.size();
  // Each cell's own height where it lies about the plane, else the plane; then the median of the cells
  // around.
  std::vector<double> rough(cells);
  for (std::size_t c = 0; c < cells; ++c) {
    const Vec3 m = raster.centre(c);
    const double level = plane.at(m.x(), m.y());
    rough[c] = raster.count[c] >= 3 && std::abs(m.z() - level) <= kReach
                   ? m.z() - level
                   : std::numeric_limits<double>::quiet_NaN();
  }
  ground.height.resize(cells);
  std::vector<double> around;
  for (int j = 0; j < raster.rows; ++j)
    for (int i = 0; i < raster.columns; ++i) {
      around.clear();
      for (int b = std::max(0, j - 1); b <= std::min(raster.rows - 1, j + 1); ++b)
        for (int a = std::max(0, i - 1); a <= std::min(raster.columns - 1, i + 1); ++a) {
          const double h = rough[static_cast<std::size_t>(b) * static_cast<std::size_t>(raster.columns) +
                                 static_cast<std::size_t>(a)];
          if (std::isfinite(h)) around.push_back(h);
        }
      const auto c = static_cast<std::size_t>(j) * static_cast<std::size_t>(raster.columns) +
                     static_cast<std::size_t>(i);
      const Vec3 m = raster.centre(c);
      double offset = 0;
      if (!around.empty()) {
        std::nth_element(around.begin(), around.begin() + static_cast<std::ptrdiff_t>(around.size() / 2),
                         around.end());
        offset = around[around.size() / 2];
      }
      ground.height[c] = plane.at(m.x(), m.y()) + offset;
    }
  return ground;
}

std::size_t remove_ground(CleanScan& scan, const Ground& ground) {
  if (!ground.present) return 0;
  // The ground's own roughness tells how thick a layer it is.
  std::vector<double> off(scan.points.size());
  std::vector<double> near;
  for (std::size_t i = 0; i < scan.points.size(); ++i) {
    const Vec3& p = scan.points[i];
    off[i] = p.z() - ground.height_at(p.x(), p.y());
    if (std::abs(off[i]) < 0.2) near.push_back(std::abs(off[i]));
  }
  if (near.empty()) return 0;
  const auto place = near.begin() + static_cast<std::ptrdiff_t>(0.9 * static_cast<double>(near.size() - 1));
  std::nth_element(near.begin(), place, near.end());
  const double layer = std::clamp(1.2 * *place, 0.03, 0.12);
  std::size_t kept = 0;
  for (std::size_t i = 0; i < off.size(); ++i) {
    if (off[i] <= layer) continue;
    scan.points[kept] = scan.points[i];
    scan.source[kept++] = scan.source[i];
  }
  const std::size_t removed = off.size() - kept;
  scan.points.resize(kept);
  scan.source.resize(kept);
  return removed;
}

}  // namespace dendrofit
