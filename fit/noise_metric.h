// SPDX-License-Identifier: GPL-3.0-or-later
// How far apart two descriptor vectors are, counted in what chance alone makes of it.
#pragma once

#include "fit/seed_noise.h"

#include <vector>

#include <Eigen/Core>

namespace dendrofit {

/// z^2 up to 3 (standard deviations), going on linearly: what the model cannot meet must not drown the rest.
double huber(double z);

/// Mahalanobis distance on the descriptors the observed tree has, with the covariance that chance makes
/// between trees of one parameter set, plus the observation's own error.
class NoiseMetric {
 public:
  /// `typical` is the noise of trees in general; `replicates` (rows: descriptors, NaN: missing; may be none)
  /// show it where the fit is. Of a descriptor that both tell, the deviation is their geometric mean, at most
  /// twice and at least half the typical one: where some seeds die early, trees differ so much that a metric
  /// of their own noise would find anything near. Correlations are the typical ones. `error` is the
  /// observation's standard error of each descriptor. Throws SolverError when no descriptor is left.
  NoiseMetric(const SeedNoise& typical, const Eigen::MatrixXd& replicates, const Eigen::VectorXd& observed,
              const Eigen::VectorXd& error);

  /// Squared distance per descriptor of the observed tree from a simulation, averaged over the simulations of
  /// one parameter set (rows): 1 is what another seed of the same tree would have. Tree by tree, not from
  /// their mean: parameters whose trees differ wildly are no answer because their average fits. A descriptor
  /// that a simulation lacks counts as 3 sd.
  double cost(const Eigen::MatrixXd& simulations) const { return cost(simulations, observed_); }
  double cost(const Eigen::MatrixXd& simulations, const Eigen::VectorXd& observed) const;

  /// Rows of descriptors in use, whitened to unit noise; missing values become the replicates' mean.
  Eigen::MatrixXd whiten(const Eigen::MatrixXd& descriptors) const;
  Eigen::VectorXd whitened_observed() const;

  const std::vector<Eigen::Index>& used() const { return used_; }
  double noise(Eigen::Index descriptor) const { return noise_[descriptor]; }

 private:
  double cost_of_one(const Eigen::RowVectorXd& simulation, const Eigen::VectorXd& observed) const;

  Eigen::VectorXd observed_;
  std::vector<Eigen::Index> used_;  ///< columns
  Eigen::VectorXd noise_;           ///< sd per column, NaN where unused
  Eigen::VectorXd mean_;            ///< per column, to fill gaps
  Eigen::MatrixXd whitening_;       ///< of the used columns
};

}  // namespace dendrofit
