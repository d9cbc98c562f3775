// SPDX-License-Identifier: GPL-3.0-or-later
#include "fit/cmaes.h"

#include "core/errors.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <Eigen/Eigenvalues>

namespace dendrofit {
namespace {

/// Folds x into [0, 1] as a mirror at either end would.
double reflect(double x) {
  x = std::fmod(std::abs(x), 2.0);
  return x > 1 ? 2 - x : x;
}

}  // namespace

void CmaesOptions::validate() const {
  require(initial_step > 0 && initial_step <= 1, "initial_step", initial_step, "must lie in (0, 1]");
  require(population == 0 || population >= 4, "population", population, "at least 4 (or 0 for the default)");
}

Cmaes::Cmaes(const Eigen::VectorXd& start, const CmaesOptions& options)
    : n_(start.size()), seed_(options.seed), step_(options.initial_step), mean_(start) {
  options.validate();
  const auto n = static_cast<double>(n_);
  lambda_ = options.population > 0 ? static_cast<std::size_t>(options.population)
                                   : 4 + static_cast<std::size_t>(3 * std::log(n));
  const auto mu = static_cast<Eigen::Index>(lambda_ / 2);
  weights_.resize(mu);
  for (Eigen::Index i = 0; i < mu; ++i)
    weights_[i] = std::log((static_cast<double>(lambda_) + 1) / 2) - std::log(static_cast<double>(i) + 1);
  weights_ /= weights_.sum();
  mu_eff_ = 1 / weights_.squaredNorm();
  c_sigma_ = (mu_eff_ + 2) / (n + mu_eff_ + 5);
  d_sigma_ = 1 + 2 * std::max(0.0, std::sqrt((mu_eff_ - 1) / (n + 1)) - 1) + c_sigma_;
  c_c_ = (4 + mu_eff_ / n) / (n + 4 + 2 * mu_eff_ / n);
  c_1_ = 2 / ((n + 1.3) * (n + 1.3) + mu_eff_);
  c_mu_ = std::min(1 - c_1_, 2 * (mu_eff_ - 2 + 1 / mu_eff_) / ((n + 2) * (n + 2) + mu_eff_));
  chi_n_ = std::sqrt(n) * (1 - 1 / (4 * n) + 1 / (21 * n * n));
  path_sigma_ = Eigen::VectorXd::Zero(n_);
  path_c_ = Eigen::VectorXd::Zero(n_);
  covariance_ = Eigen::MatrixXd::Identity(n_, n_);
  decompose();
}

void Cmaes::decompose() {
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(covariance_);
  basis_ = solver.eigenvectors();
  axes_ = solver.eigenvalues().cwiseMax(1e-20).cwiseSqrt();
}

const std::vector<Eigen::VectorXd>& Cmaes::ask() {
  candidates_.resize(lambda_);
  for (std::size_t k = 0; k < lambda_; ++k) {
    Random random = Random(seed_).child({static_cast<std::uint64_t>(generation_), k});
    Eigen::VectorXd z(n_);
    for (double& value : z) value = random.normal();
    candidates_[k] = (mean_ + step_ * (basis_ * axes_.cwiseProduct(z))).unaryExpr(&reflect);
  }
  return candidates_;
}

void Cmaes::tell(const std::vector<double>& costs) {
  std::vector<std::size_t> rank(lambda_);
  std::iota(rank.begin(), rank.end(), std::size_t{0});
  const auto worth = [&](std::size_t i) { return std::isnan(costs[i]) ? HUGE_VAL : costs[i]; };
  std::stable_sort(rank.begin(), rank.end(),
                   [&](std::size_t a, std::size_t b) { return worth(a) < worth(b); });

  const auto n = static_cast<double>(n_);
  const Eigen::VectorXd old = mean_;
  mean_.setZero();
  for (Eigen::Index i = 0; i < weights_.size(); ++i)
    mean_ += weights_[i] * candidates_[rank[static_cast<std::size_t>(i)]];
  const Eigen::VectorXd y = (mean_ - old) / step_;

  ++generation_;
  path_sigma_ = (1 - c_sigma_) * path_sigma_ + std::sqrt(c_sigma_ * (2 - c_sigma_) * mu_eff_) *
                                                   (basis_ * (basis_.transpose() * y).cwiseQuotient(axes_));
  const double expected =
      std::sqrt(1 - std::pow(1 - c_sigma_, 2.0 * generation_)) * (1.4 + 2 / (n + 1)) * chi_n_;
  const bool moving = path_sigma_.norm() < expected;
  path_c_ = (1 - c_c_) * path_c_ + (moving ? std::sqrt(c_c_ * (2 - c_c_) * mu_eff_) : 0.0) * y;

  const double stalled = moving ? 0 : c_1_ * c_c_ * (2 - c_c_);
  covariance_ = (1 - c_1_ - c_mu_ + stalled) * covariance_ + c_1_ * path_c_ * path_c_.transpose();
  for (Eigen::Index i = 0; i < weights_.size(); ++i) {
    const Eigen::VectorXd step = (candidates_[rank[static_cast<std::size_t>(i)]] - old) / step_;
    covariance_ += c_mu_ * weights_[i] * step * step.transpose();
  }
  step_ = std::min(1.0, step_ * std::exp(c_sigma_ / d_sigma_ * (path_sigma_.norm() / chi_n_ - 1)));
  decompose();
}

bool Cmaes::converged(double tolerance) const {
  return step_ * std::sqrt(covariance_.diagonal().maxCoeff()) < tolerance;
}

}  // namespace dendrofit
