// SPDX-License-Identifier: GPL-3.0-or-later
#include "forward/leaves/measured_profile.h"

#include "core/errors.h"
#include "core/metrics.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

namespace dendrofit {
namespace {

constexpr double kVoxel = 0.03;
constexpr std::size_t kBins = 25;
constexpr double kSpread = 0.05;  // of all leaves, over all heights

}  // namespace

std::vector<Vec3> leaf_voxel_centres(const PointCloud& leaf_points, const Vec3& origin_shift) {
  std::vector<std::array<std::int64_t, 3>> voxels;
  voxels.reserve(leaf_points.size());
  for (const Vec3& point : leaf_points.points) {
    const Vec3 local = point + (leaf_points.origin_shift - origin_shift);
    voxels.push_back({static_cast<std::int64_t>(std::floor(local.x() / kVoxel)),
                      static_cast<std::int64_t>(std::floor(local.y() / kVoxel)),
                      static_cast<std::int64_t>(std::floor(local.z() / kVoxel))});
  }
  std::sort(voxels.begin(), voxels.end());
  voxels.erase(std::unique(voxels.begin(), voxels.end()), voxels.end());
  std::vector<Vec3> centres;
  centres.reserve(voxels.size());
  for (const auto& v : voxels)
    centres.push_back(kVoxel *
                      (Vec3(static_cast<double>(v[0]), static_cast<double>(v[1]), static_cast<double>(v[2])) +
                       Vec3::Constant(0.5)));
  return centres;
}

UnitDistribution measured_heights(const PointCloud& leaf_points, const Tree& tree) {
  if (leaf_points.empty()) throw InputError("measured leaf heights: no leaf point");
  if (tree.empty()) throw InputError("measured leaf heights: the tree has no cylinder");
  const double foot = foot_height(tree);
  double top = foot;
  for (const Vec3& end : tree.end) top = std::max(top, end.z());
  std::vector<double> votes(kBins, 0);
  const std::vector<Vec3> seen = leaf_voxel_centres(leaf_points, tree.origin_shift);
  for (const Vec3& at : seen) {
    const double height = std::clamp((at.z() - foot) / std::max(top - foot, 1e-9), 0.0, 1.0);
    votes[std::min(kBins - 1, static_cast<std::size_t>(height * kBins))] += 1 - kSpread;
  }
  for (double& vote : votes) vote += kSpread * static_cast<double>(seen.size()) / kBins;
  return UnitDistribution::histogram(votes);
}

}  // namespace dendrofit
