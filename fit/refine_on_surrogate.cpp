// SPDX-License-Identifier: GPL-3.0-or-later
#include "fit/fit_search.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>
#include <ceres/ceres.h>

namespace dendrofit {
namespace {

constexpr double kRidge = 1e-3;
constexpr double kLoss = 3;                 // as in the noise metric
constexpr std::size_t kRowsPerUnknown = 2;  // tried parameter sets for each coefficient of a descriptor

/// Whitened descriptors as quadratics without products of the box's inner coordinates.
struct Surrogate {
  Eigen::MatrixXd slopes;  ///< (1 + 2 d) x descriptors
  Eigen::VectorXd observed;

  static Eigen::VectorXd features(const Eigen::VectorXd& u) {
    Eigen::VectorXd f(1 + 2 * u.size());
    f << 1, u, u.cwiseAbs2();
    return f;
  }
  Eigen::VectorXd residual(const Eigen::VectorXd& u) const {
    return slopes.transpose() * features(u) - observed;
  }
};

class SurrogateResidual : public ceres::CostFunction {
 public:
  SurrogateResidual(const Surrogate& surrogate, Eigen::Index descriptor)
      : surrogate_(surrogate), descriptor_(descriptor) {
    set_num_residuals(1);
    mutable_parameter_block_sizes()->push_back(static_cast<int>((surrogate.slopes.rows() - 1) / 2));
  }
  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override {
    const Eigen::Index d = (surrogate_.slopes.rows() - 1) / 2;
    const Eigen::Map<const Eigen::VectorXd> u(parameters[0], d);
    const auto slopes = surrogate_.slopes.col(descriptor_);
    residuals[0] = slopes.dot(Surrogate::features(u)) - surrogate_.observed[descriptor_];
    if (jacobians && jacobians[0])
      for (Eigen::Index i = 0; i < d; ++i) jacobians[0][i] = slopes[1 + i] + 2 * u[i] * slopes[1 + d + i];
    return true;
  }

 private:
  const Surrogate& surrogate_;
  Eigen::Index descriptor_;
};

/// Distance of one coordinate from the posterior's centre, in its deviations.
class ImprobabilityResidual : public ceres::CostFunction {
 public:
  ImprobabilityResidual(const SearchBox& box, int coordinate) : coordinate_(coordinate) {
    set_num_residuals(1);
    mutable_parameter_block_sizes()->push_back(static_cast<int>(box.rows.size()));
    const Eigen::Index row = box.rows[static_cast<std::size_t>(coordinate)];
    const double deviation = box.deviation[row] * std::sqrt(box.doubt);
    slope_ = (box.hi[coordinate] - box.lo[coordinate]) / deviation;
    offset_ = (box.lo[coordinate] - box.centre[row]) / deviation;
  }
  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override {
    residuals[0] = offset_ + slope_ * parameters[0][coordinate_];
    if (jacobians && jacobians[0]) {
      std::fill_n(jacobians[0], parameter_block_sizes()[0], 0.0);
      jacobians[0][coordinate_] = slope_;
    }
    return true;
  }

 private:
  int coordinate_;
  double slope_ = 0, offset_ = 0;
};

}  // namespace

std::optional<Eigen::VectorXd> refine_on_surrogate(const std::vector<Tried>& tried, const SearchBox& box,
                                                   const NoiseMetric& metric, const Eigen::VectorXd& start) {
  const auto d = static_cast<Eigen::Index>(box.rows.size());
  const std::size_t unknowns = 1 + 2 * box.rows.size();
  if (d == 0 || tried.size() < kRowsPerUnknown * unknowns) return {};
  const auto n = static_cast<Eigen::Index>(tried.size());
  Eigen::MatrixXd features(n, static_cast<Eigen::Index>(unknowns));
  Eigen::MatrixXd descriptors(n, tried.front().descriptors.size());
  for (Eigen::Index i = 0; i < n; ++i) {
    const Tried& one = tried[static_cast<std::size_t>(i)];
    features.row(i) = Surrogate::features(box.inner(one.point)).transpose();
    descriptors.row(i) = one.descriptors.transpose();
  }
  Eigen::MatrixXd normal = features.transpose() * features / static_cast<double>(n);
  normal.diagonal().tail(2 * d).array() += kRidge;
  Surrogate surrogate;
  surrogate.slopes =
      normal.ldlt().solve(features.transpose() * metric.whiten(descriptors) / static_cast<double>(n));
  surrogate.observed = metric.whitened_observed();

  Eigen::VectorXd u = box.inner(start).cwiseMax(1e-6).cwiseMin(1 - 1e-6);
  ceres::Problem problem;
  for (Eigen::Index j = 0; j < surrogate.observed.size(); ++j)
    problem.AddResidualBlock(new SurrogateResidual(surrogate, j), new ceres::HuberLoss(kLoss), u.data());
  for (int i = 0; i < d; ++i) {
    problem.AddResidualBlock(new ImprobabilityResidual(box, i), new ceres::HuberLoss(kLoss), u.data());
    problem.SetParameterLowerBound(u.data(), i, 0);
    problem.SetParameterUpperBound(u.data(), i, 1);
  }
  ceres::Solver::Options options;
  options.num_threads = 1;
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  if (!summary.IsSolutionUsable() || !u.allFinite()) return {};
  return box.full(u);
}

}  // namespace dendrofit
