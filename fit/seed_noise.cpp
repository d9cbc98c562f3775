// SPDX-License-Identifier: GPL-3.0-or-later
#include "fit/seed_noise.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/QR>

namespace dendrofit {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
constexpr std::size_t kFewestGroups = 10;  // that tell a descriptor's deviation
constexpr Eigen::Index kFewestTrees = 8;   // with a descriptor, for what a trend leaves of it
constexpr double kFarthest = 3;            // sd
// Correlations from a few hundred trees are shrunk to none by:
constexpr double kShrinkPooled = 0.1, kShrinkTrend = 0.3;

/// sqrt(d/2) Gamma(d/2) / Gamma((d+1)/2), d = n - 1: makes a small sample's standard deviation unbiased.
double small_sample_factor(Eigen::Index n) {
  const double d = static_cast<double>(n - 1);
  return std::sqrt(d / 2) * std::exp(std::lgamma(d / 2) - std::lgamma((d + 1) / 2));
}

/// Correlation matrix of standardised residuals (0: missing), times the deviations.
SeedNoise assemble(const Eigen::MatrixXd& residuals, const Eigen::VectorXd& deviations, double shrink) {
  Eigen::MatrixXd product = residuals.transpose() * residuals;
  const Eigen::VectorXd scale = product.diagonal().cwiseMax(1e-12).cwiseSqrt().cwiseInverse();
  product = (1 - shrink) * (scale.asDiagonal() * product * scale.asDiagonal());
  product.diagonal().setOnes();
  return {deviations.asDiagonal() * product * deviations.asDiagonal()};
}

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// Residuals of y on 1, theta, theta^2 (ordinary least squares) as far as the rows carry them, scaled to be
/// free of the fit's degrees of freedom.
Eigen::MatrixXd residuals_given_parameters(const Eigen::MatrixXd& theta, const Eigen::MatrixXd& y) {
  const Eigen::Index n = theta.rows();
  const bool quadratic = n >= 4 * (1 + 2 * theta.cols());
  const bool linear = n >= 3 * (1 + theta.cols());
  Eigen::MatrixXd design(n, 1 + (linear ? theta.cols() : 0) + (quadratic ? theta.cols() : 0));
  design.col(0).setOnes();
  if (linear) design.middleCols(1, theta.cols()) = theta;
  if (quadratic) design.rightCols(theta.cols()) = theta.array().square();
  const Eigen::MatrixXd fitted = design * design.colPivHouseholderQr().solve(y);
  const double freedom = std::max(1.0, static_cast<double>(n - design.cols()));
  return (y - fitted) * std::sqrt(static_cast<double>(n) / freedom);
}

}  // namespace

double SeedNoise::deviation(Eigen::Index descriptor) const {
  return std::sqrt(covariance(descriptor, descriptor));
}

SeedNoise noise_within(const std::vector<Eigen::MatrixXd>& groups) {
  const Eigen::Index columns = groups.empty() ? 0 : groups.front().cols();
  Eigen::Index rows = 0;
  for (const Eigen::MatrixXd& group : groups) rows += group.rows();
  Eigen::MatrixXd residuals = Eigen::MatrixXd::Zero(rows, columns);
  Eigen::VectorXd deviations(columns);
  for (Eigen::Index j = 0; j < columns; ++j) {
    std::vector<double> of_groups;
    Eigen::Index at = 0;
    for (const Eigen::MatrixXd& group : groups) {
      const auto column = group.col(j).array();
      if (column.isFinite().all() && group.rows() > 1) {
        const double mean = column.mean();
        const double square = (column - mean).square().sum() / static_cast<double>(group.rows() - 1);
        of_groups.push_back(std::sqrt(square) * small_sample_factor(group.rows()));
        residuals.col(j).segment(at, group.rows()) = column - mean;
      }
      at += group.rows();
    }
    deviations[j] = of_groups.size() < kFewestGroups ? kNone : median(of_groups);
    const double farthest = kFarthest * (deviations[j] > 0 ? deviations[j] : 0);
    for (double& r : residuals.col(j)) r = std::clamp(r, -farthest, farthest);
  }
  return assemble(residuals, deviations, kShrinkPooled);
}

SeedNoise noise_about_trend(const Eigen::MatrixXd& parameters, const Eigen::MatrixXd& descriptors) {
  Eigen::MatrixXd filled = descriptors;
  Eigen::VectorXd deviations(descriptors.cols());
  for (Eigen::Index j = 0; j < descriptors.cols(); ++j) {
    const auto known = descriptors.col(j).array().isFinite();
    const Eigen::Index count = known.count();
    const double mean = known.select(descriptors.col(j).array(), 0).sum() /
                        static_cast<double>(std::max<Eigen::Index>(1, count));
    filled.col(j) = known.select(descriptors.col(j).array(), mean);
    deviations[j] = count < kFewestTrees ? kNone : 1;
  }
  const Eigen::MatrixXd residuals = residuals_given_parameters(parameters, filled);
  for (Eigen::Index j = 0; j < residuals.cols(); ++j) {
    const double square = residuals.col(j).squaredNorm() / static_cast<double>(residuals.rows());
    deviations[j] *= square > 0 ? std::sqrt(square) : kNone;
  }
  return assemble(residuals, deviations, kShrinkTrend);
}

}  // namespace dendrofit
