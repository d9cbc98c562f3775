// SPDX-License-Identifier: GPL-3.0-or-later
#include "fit/noise_metric.h"

#include "core/errors.h"

#include <cmath>
#include <limits>

#include <Eigen/Cholesky>
#include <Eigen/QR>

namespace dendrofit {
namespace {

constexpr double kMissingPenalty = 9;      // 3 sd
constexpr double kShrinkToDiagonal = 0.3;  // few simulations estimate correlations badly
constexpr double kHuber = 3;          // sd; a descriptor that the model cannot meet must not drown the others
constexpr double kFewestShare = 0.2;  // of simulations that must have a descriptor for it to be used

/// z^2 up to kHuber, going on linearly.
double huber(double z) {
  z = std::abs(z);
  return z <= kHuber ? z * z : kHuber * (2 * z - kHuber);
}

Eigen::VectorXd finite_column_means(const Eigen::MatrixXd& values) {
  Eigen::VectorXd means(values.cols());
  for (Eigen::Index j = 0; j < values.cols(); ++j) {
    double sum = 0;
    int count = 0;
    for (const double v : values.col(j))
      if (std::isfinite(v)) {
        sum += v;
        ++count;
      }
    means[j] = count > 0 ? sum / count : std::numeric_limits<double>::quiet_NaN();
  }
  return means;
}

double finite_share(const Eigen::VectorXd& column) {
  return static_cast<double>(column.array().isFinite().count()) /
         static_cast<double>(std::max<Eigen::Index>(1, column.size()));
}

/// Residuals of y on 1, theta, theta^2 (ordinary least squares), scaled to be free of the fit's degrees of
/// freedom.
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

bool lends(const NoiseMetric* wider, Eigen::Index descriptor) {
  return wider && std::isfinite(wider->noise(descriptor));
}

}  // namespace

NoiseMetric::NoiseMetric(const Eigen::MatrixXd& parameters, const Eigen::MatrixXd& descriptors,
                         const Eigen::VectorXd& observed, const Eigen::VectorXd& error,
                         const NoiseMetric* wider)
    : observed_(observed), mean_(finite_column_means(descriptors)) {
  for (Eigen::Index j = 0; j < observed.size(); ++j)
    if (std::isfinite(observed[j]) && (finite_share(descriptors.col(j)) >= kFewestShare || lends(wider, j)))
      used_.push_back(j);
  if (used_.empty())
    throw SolverError("the observed tree and the simulated ones have no descriptor in common");
  Eigen::MatrixXd filled = descriptors(Eigen::all, used_);
  for (Eigen::Index k = 0; k < filled.cols(); ++k)
    for (double& v : filled.col(k))
      if (!std::isfinite(v))
        v = std::isfinite(mean_[used_[static_cast<std::size_t>(k)]])
                ? mean_[used_[static_cast<std::size_t>(k)]]
                : 0;
  const Eigen::MatrixXd residuals = residuals_given_parameters(parameters, filled);
  Eigen::MatrixXd covariance = residuals.transpose() * residuals / static_cast<double>(residuals.rows());
  const Eigen::VectorXd variances = covariance.diagonal();
  covariance *= 1 - kShrinkToDiagonal;
  noise_ = Eigen::VectorXd::Constant(observed.size(), std::numeric_limits<double>::quiet_NaN());
  for (Eigen::Index k = 0; k < covariance.cols(); ++k) {
    const Eigen::Index j = used_[static_cast<std::size_t>(k)];
    const bool lent = finite_share(descriptors.col(j)) < kFewestShare;
    if (lent) {
      covariance.row(k).setZero();
      covariance.col(k).setZero();
    }
    const double variance = lent ? wider->noise(j) * wider->noise(j) : variances[k] + error[j] * error[j];
    covariance(k, k) = variance;
    noise_[j] = std::sqrt(variance);
  }
  const Eigen::LLT<Eigen::MatrixXd> cholesky(covariance);
  whitening_ = cholesky.matrixL().solve(Eigen::MatrixXd::Identity(covariance.rows(), covariance.cols()));
}

double NoiseMetric::cost(const Eigen::MatrixXd& simulations, const Eigen::VectorXd& observed) const {
  double sum = 0;
  for (Eigen::Index i = 0; i < simulations.rows(); ++i) sum += cost_of_one(simulations.row(i), observed);
  return sum / static_cast<double>(simulations.rows());
}

double NoiseMetric::cost_of_one(const Eigen::RowVectorXd& simulation, const Eigen::VectorXd& observed) const {
  Eigen::VectorXd difference(static_cast<Eigen::Index>(used_.size()));
  double penalty = 0;
  for (std::size_t k = 0; k < used_.size(); ++k) {
    const double d = observed[used_[k]] - simulation[used_[k]];
    difference[static_cast<Eigen::Index>(k)] = std::isfinite(d) ? d : 0;
    if (!std::isfinite(d)) penalty += kMissingPenalty;
  }
  // Both trees are one draw each: their difference has twice a tree's variance.
  const double distance = (whitening_ * difference / std::sqrt(2.0)).unaryExpr(&huber).sum();
  return (distance + penalty) / static_cast<double>(used_.size());
}

Eigen::MatrixXd NoiseMetric::whiten(const Eigen::MatrixXd& descriptors) const {
  Eigen::MatrixXd values = descriptors(Eigen::all, used_);
  for (Eigen::Index k = 0; k < values.cols(); ++k)
    for (double& v : values.col(k))
      if (!std::isfinite(v)) v = mean_[used_[static_cast<std::size_t>(k)]];
  return values * whitening_.transpose();
}

Eigen::VectorXd NoiseMetric::whitened_observed() const {
  return whiten(observed_.transpose()).row(0).transpose();
}

}  // namespace dendrofit
