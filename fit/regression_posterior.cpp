// SPDX-License-Identifier: GPL-3.0-or-later
#include "fit/regression_posterior.h"

#include "core/errors.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <Eigen/Eigenvalues>

namespace dendrofit {
namespace {

constexpr Eigen::Index kFewest = 30;
constexpr double kNearestShare = 0.7;  // of the simulations get a weight

Eigen::VectorXd kernel_weights(const Eigen::MatrixXd& descriptors, const Eigen::VectorXd& observed) {
  const Eigen::VectorXd distance = (descriptors.rowwise() - observed.transpose()).rowwise().norm();
  std::vector<double> sorted(distance.begin(), distance.end());
  std::sort(sorted.begin(), sorted.end());
  const double reach = std::max(
      1e-12, sorted[static_cast<std::size_t>(kNearestShare * static_cast<double>(sorted.size() - 1))]);
  return distance.unaryExpr([&](double d) { return std::max(0.0, 1 - (d / reach) * (d / reach)); });
}

/// Weighted ridge regression in the eigenbasis of the descriptors' covariance, with leave-one-out errors in
/// closed form for any ridge strength.
struct Ridge {
  Eigen::VectorXd weights;    ///< summing to 1
  Eigen::VectorXd centre;     ///< weighted mean descriptor
  Eigen::MatrixXd basis;      ///< eigenvectors
  Eigen::VectorXd variances;  ///< eigenvalues
  Eigen::MatrixXd scores;     ///< descriptors in the basis

  Ridge(const Eigen::MatrixXd& x, const Eigen::VectorXd& w) : weights(w / w.sum()) {
    centre = x.transpose() * weights;
    const Eigen::MatrixXd centred = x.rowwise() - centre.transpose();
    const Eigen::MatrixXd covariance = centred.transpose() * weights.asDiagonal() * centred;
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(covariance);
    basis = solver.eigenvectors();
    variances = solver.eigenvalues().cwiseMax(0);
    scores = centred * basis;
  }

  struct Fit {
    double prediction = 0;
    double error = 0;          ///< weighted mean squared leave-one-out error
    Eigen::VectorXd left_out;  ///< leave-one-out error of each simulation
  };

  Fit fit(const Eigen::VectorXd& y, const Eigen::VectorXd& observed, double strength) const {
    const double mean = weights.dot(y);
    const Eigen::VectorXd inverse = (variances.array() + strength).inverse();
    const Eigen::VectorXd slope =
        inverse.cwiseProduct(scores.transpose() * weights.cwiseProduct((y.array() - mean).matrix()));
    Fit result;
    result.prediction = mean + (basis.transpose() * (observed - centre)).dot(slope);
    const Eigen::VectorXd residual = (y.array() - mean).matrix() - scores * slope;
    const Eigen::VectorXd leverage =
        weights.array() * (1 + (scores.array().square().matrix() * inverse).array());
    result.left_out = residual.array() / (1 - leverage.array().min(0.95));
    result.error = weights.dot(result.left_out.cwiseAbs2());
    return result;
  }
};

double weighted_quantile(const Eigen::VectorXd& values, const Eigen::VectorXd& weights, double share) {
  std::vector<Eigen::Index> order(static_cast<std::size_t>(values.size()));
  std::iota(order.begin(), order.end(), Eigen::Index{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](Eigen::Index a, Eigen::Index b) { return values[a] < values[b]; });
  double sum = 0;
  for (const Eigen::Index i : order) {
    sum += weights[i];
    if (sum >= share) return values[i];
  }
  return values[order.back()];
}

}  // namespace

std::vector<UnitPosterior> regression_posterior(const Eigen::MatrixXd& parameters,
                                                const Eigen::MatrixXd& descriptors,
                                                const Eigen::VectorXd& observed) {
  if (parameters.rows() != descriptors.rows() || descriptors.cols() != observed.size())
    throw InputError("regression_posterior: parameters, descriptors and observation do not fit together");
  std::vector<UnitPosterior> posterior(static_cast<std::size_t>(parameters.cols()));
  if (parameters.rows() < kFewest || observed.size() == 0) return posterior;

  const Ridge ridge(descriptors, kernel_weights(descriptors, observed));
  const double scale = std::max(1e-12, ridge.variances.mean());
  for (Eigen::Index j = 0; j < parameters.cols(); ++j) {
    const Eigen::VectorXd y = parameters.col(j);
    Ridge::Fit best;
    best.error = HUGE_VAL;
    for (double strength = 1e-4; strength < 2e3; strength *= 4) {
      Ridge::Fit fit = ridge.fit(y, observed, strength * scale);
      if (fit.error < best.error) best = std::move(fit);
    }
    const double prior_sd = std::sqrt((y.array() - y.mean()).square().mean());
    const auto at = [&](double share) {
      return std::clamp(best.prediction + weighted_quantile(best.left_out, ridge.weights, share), 0.0, 1.0);
    };
    UnitPosterior& p = posterior[static_cast<std::size_t>(j)];
    p = {at(0.5), at(0.05), at(0.95), std::clamp(1 - std::sqrt(best.error) / prior_sd, 0.0, 1.0)};
  }
  return posterior;
}

}  // namespace dendrofit
