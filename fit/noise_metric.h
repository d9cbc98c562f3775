// SPDX-License-Identifier: GPL-3.0-or-later
// How far apart two descriptor vectors are, counted in what chance alone makes of it.
#pragma once

#include <vector>

#include <Eigen/Core>

namespace dendrofit {

/// Mahalanobis distance on the descriptors the observed tree has, with the covariance that simulations show
/// around their expectation given the parameters, plus the observation's own error.
class NoiseMetric {
 public:
  /// `parameters` (unit box) and `descriptors` (NaN: missing) hold one simulation a row. The expectation is a
  /// quadratic in each parameter; its residuals are the noise. Without columns in `parameters`, the
  /// simulations are replicates of one parameter set. `error` is the observation's standard error of each
  /// descriptor. Throws SolverError when no descriptor is left. `wider`, where given, lends its noise for
  /// descriptors that too few of these simulations have.
  NoiseMetric(const Eigen::MatrixXd& parameters, const Eigen::MatrixXd& descriptors,
              const Eigen::VectorXd& observed, const Eigen::VectorXd& error,
              const NoiseMetric* wider = nullptr);

  /// Squared distance per descriptor of the observed tree from a simulation, averaged over the simulations of
  /// one parameter set (rows): 1 is what another seed of the same tree would have. Tree by tree, not from
  /// their mean: parameters whose trees differ wildly are no answer because their average fits. A descriptor
  /// that a simulation lacks counts as 3 sd.
  double cost(const Eigen::MatrixXd& simulations) const { return cost(simulations, observed_); }
  double cost(const Eigen::MatrixXd& simulations, const Eigen::VectorXd& observed) const;

  /// Rows of descriptors in use, whitened to unit noise; missing values become the simulations' mean.
  Eigen::MatrixXd whiten(const Eigen::MatrixXd& descriptors) const;
  Eigen::VectorXd whitened_observed() const;

  const std::vector<Eigen::Index>& used() const { return used_; }
  double noise(Eigen::Index descriptor) const { return noise_[descriptor]; }

 private:
  double cost_of_one(const Eigen::RowVectorXd& simulation, const Eigen::VectorXd& observed) const;

  Eigen::VectorXd observed_;
  std::vector<Eigen::Index> used_;  ///< columns
  Eigen::VectorXd noise_;           ///< sd per column, NaN where unused
  Eigen::VectorXd mean_;            ///< bank mean per column, to fill gaps
  Eigen::MatrixXd whitening_;       ///< of the used columns
};

}  // namespace dendrofit
