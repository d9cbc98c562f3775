// SPDX-License-Identifier: GPL-3.0-or-later
#include "recon/image/poses.h"

#include "core/errors.h"
#include "core/parallel.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include <Eigen/Geometry>
#include <ceres/ceres.h>
#include <ceres/rotation.h>

namespace dendrofit {
namespace {

constexpr std::size_t kFewestSightings = 30;
constexpr double kLossScale = 1.0;  // pixels

/// How far, along `normal`, a point projects from `target` once the camera is turned and shifted by `move`
/// (rotation vector, then translation, in camera axes).
struct AcrossError {
  Vec3 in_camera;
  const Camera* camera;
  Eigen::Vector2d target, normal;

  template <typename T>
  bool operator()(const T* move, T* residual) const {
    const std::array<T, 3> from{T(in_camera.x()), T(in_camera.y()), T(in_camera.z())};
    std::array<T, 3> p;
    ceres::AngleAxisRotatePoint(move, from.data(), p.data());
    for (std::size_t k = 0; k < 3; ++k) p[k] += move[3 + k];
    if (p[2] < T(1e-6)) return false;
    const T x = p[0] / p[2], y = p[1] / p[2], r2 = x * x + y * y;
    const T stretch = T(1) + r2 * (T(camera->k1) + r2 * T(camera->k2));
    residual[0] = normal.x() * (camera->fx * x * stretch + camera->cx - target.x()) +
                  normal.y() * (camera->fy * y * stretch + camera->cy - target.y());
    return true;
  }
};

/// Keeps the pose near what was told.
struct Prior {
  double turn_doubt, shift_doubt;
  template <typename T>
  bool operator()(const T* move, T* residual) const {
    for (int k = 0; k < 3; ++k) {
      residual[k] = move[k] / turn_doubt;
      residual[3 + k] = move[3 + k] / shift_doubt;
    }
    return true;
  }
};

Camera refine(const Tree& tree, const Sightings& sightings, const Camera& camera, std::int32_t view,
              const PoseOptions& options) {
  ceres::Problem problem;
  std::array<double, 6> move{};
  std::size_t count = 0;
  for (std::size_t i = 0; i < tree.size(); ++i)
    for (const Sighting& s : sightings[i]) {
      if (s.view != view || !s.alone) continue;
      const Vec3 middle = 0.5 * (tree.start[i] + tree.end[i]);
      const auto at = camera.project(middle), beside = camera.project(middle + 1e-3 * s.across);
      if (!at || !beside) continue;
      const Eigen::Vector2d normal = (*beside - *at).normalized();
      auto* error = new AcrossError{camera.rotation * middle + camera.translation, &camera,
                                    *at + s.offset_px * normal, normal};
      problem.AddResidualBlock(new ceres::AutoDiffCostFunction<AcrossError, 1, 6>(error),
                               new ceres::CauchyLoss(kLossScale), move.data());
      ++count;
    }
  if (count < kFewestSightings) return camera;
  problem.AddResidualBlock(new ceres::AutoDiffCostFunction<Prior, 6, 6>(new Prior{
                               options.turn_doubt_deg * std::numbers::pi / 180, options.shift_doubt_m}),
                           nullptr, move.data());
  ceres::Solver::Options solver;
  solver.linear_solver_type = ceres::DENSE_QR;
  solver.max_num_iterations = 30;
  solver.num_threads = 1;
  solver.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(solver, &problem, &summary);
  if (!summary.IsSolutionUsable()) return camera;
  const Vec3 turn(move[0], move[1], move[2]);
  const double angle = turn.norm();
  Camera moved = camera;
  if (angle > 0) {
    const Eigen::Matrix3d by = Eigen::AngleAxisd(angle, turn / angle).toRotationMatrix();
    moved.rotation = by * camera.rotation;
    moved.translation = by * camera.translation;
  }
  moved.translation += Vec3(move[3], move[4], move[5]);
  return moved;
}

}  // namespace

void PoseOptions::validate() const {
  require(std::isfinite(turn_doubt_deg) && turn_doubt_deg > 0, "turn_doubt_deg", turn_doubt_deg,
          "must be positive");
  require(std::isfinite(shift_doubt_m) && shift_doubt_m > 0, "shift_doubt_m", shift_doubt_m,
          "must be positive");
}

std::vector<Camera> refine_poses(const Tree& tree, const Sightings& sightings,
                                 const std::vector<Camera>& cameras, const PoseOptions& options) {
  options.validate();
  std::vector<Camera> refined = cameras;
  parallel_blocks(cameras.size(), 1, options.threads, [&](std::size_t first, std::size_t end) {
    for (std::size_t v = first; v < end; ++v)
      refined[v] = refine(tree, sightings, cameras[v], static_cast<std::int32_t>(v), options);
  });
  return refined;
}

std::vector<double> median_offsets_px(const Sightings& sightings, std::size_t views) {
  std::vector<std::vector<double>> offsets(views);
  for (const auto& of_cylinder : sightings)
    for (const Sighting& s : of_cylinder)
      if (s.alone) offsets[static_cast<std::size_t>(s.view)].push_back(std::abs(s.offset_px));
  std::vector<double> result;
  for (auto& o : offsets) {
    if (o.empty()) {
      result.push_back(std::numeric_limits<double>::quiet_NaN());
      continue;
    }
    const auto middle = o.begin() + static_cast<std::ptrdiff_t>(o.size() / 2);
    std::nth_element(o.begin(), middle, o.end());
    result.push_back(*middle);
  }
  return result;
}

}  // namespace dendrofit
