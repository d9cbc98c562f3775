// SPDX-License-Identifier: GPL-3.0-or-later
#include "fit/noise_metric.h"

#include "core/errors.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Cholesky>

namespace dendrofit {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
constexpr double kMissingPenalty = 9;          // 3 sd
constexpr Eigen::Index kFewestReplicates = 8;  // with a descriptor, to tell its noise
constexpr double kMostOfTypical = 2;           // standard deviations may be so many times the typical one
constexpr double kHuber = 3;

/// Mean and standard deviation of a column's finite values; NaN where too few tell.
struct Spread {
  double mean = kNone, deviation = kNone;
};

Spread spread_of(const Eigen::VectorXd& column) {
  const auto known = column.array().isFinite();
  const auto count = static_cast<double>(known.count());
  if (count == 0) return {};
  const double mean = known.select(column.array(), 0).sum() / count;
  if (known.count() < kFewestReplicates) return {mean, kNone};
  return {mean, std::sqrt(known.select((column.array() - mean).square(), 0).sum() / (count - 1))};
}

double tempered(double typical, double local) {
  if (!std::isfinite(local)) return typical;
  if (!std::isfinite(typical)) return local;
  return std::clamp(std::sqrt(typical * local), typical / kMostOfTypical, typical * kMostOfTypical);
}

}  // namespace

double huber(double z) {
  z = std::abs(z);
  return z <= kHuber ? z * z : kHuber * (2 * z - kHuber);
}

NoiseMetric::NoiseMetric(const SeedNoise& typical, const Eigen::MatrixXd& replicates,
                         const Eigen::VectorXd& observed, const Eigen::VectorXd& error)
    : observed_(observed), noise_(Eigen::VectorXd::Constant(observed.size(), kNone)), mean_(observed) {
  std::vector<double> deviations;
  for (Eigen::Index j = 0; j < observed.size(); ++j) {
    if (!std::isfinite(observed[j])) continue;
    const Spread local = spread_of(replicates.col(j));
    const double deviation = tempered(typical.deviation(j), local.deviation);
    if (!std::isfinite(deviation)) continue;
    used_.push_back(j);
    deviations.push_back(deviation);
    noise_[j] = std::hypot(deviation, error[j]);
    if (std::isfinite(local.mean)) mean_[j] = local.mean;
  }
  if (used_.empty())
    throw SolverError("the observed tree and the simulated ones have no descriptor in common");
  const auto n = static_cast<Eigen::Index>(used_.size());
  Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(n, n);
  for (Eigen::Index a = 0; a < n; ++a) {
    const Eigen::Index i = used_[static_cast<std::size_t>(a)];
    for (Eigen::Index b = 0; b < n; ++b) {
      const Eigen::Index j = used_[static_cast<std::size_t>(b)];
      const double r = typical.covariance(i, j) / (typical.deviation(i) * typical.deviation(j));
      if (a != b && std::isfinite(r))
        covariance(a, b) =
            r * deviations[static_cast<std::size_t>(a)] * deviations[static_cast<std::size_t>(b)];
    }
    covariance(a, a) = noise_[i] * noise_[i];
  }
  const Eigen::LLT<Eigen::MatrixXd> cholesky(covariance);
  whitening_ = cholesky.matrixL().solve(Eigen::MatrixXd::Identity(n, n));
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
