// SPDX-License-Identifier: GPL-3.0-or-later
// What simulations drawn from the prior say about parameters, given the descriptors of one observed tree.
#pragma once

#include <vector>

#include <Eigen/Core>

namespace dendrofit {

/// Simulations, one a row.
struct PriorSimulations {
  Eigen::MatrixXd unit;         ///< parameters in the unit box, uniform there
  Eigen::MatrixXd descriptors;  ///< NaN: missing
  Eigen::MatrixXd known;        ///< further columns whose value is known of the observed tree (its age, ...),
                                ///< each about of unit range; may have none
  std::vector<int> group;       ///< e.g. the growth equation; empty: all the same
};

struct Observation {
  Eigen::VectorXd descriptors;  ///< NaN: missing, or to be left out
  Eigen::VectorXd error;        ///< standard error of each, beyond what the simulations show; 0: exact
  Eigen::VectorXd known;        ///< values of PriorSimulations::known
};

/// A weighted sample from the posterior on the unit box.
struct PosteriorSample {
  Eigen::MatrixXd unit;            ///< one draw a row
  Eigen::VectorXd weights;         ///< summing to 1
  std::vector<Eigen::Index> rows;  ///< simulation each draw comes from, nearest first
  /// Descriptors outside what 99.8 % of the simulations have: the model hardly makes such trees.
  std::vector<Eigen::Index> outlying;
  bool is_prior = false;  ///< too few simulations to tell anything
};

/// Approximate Bayesian computation with regression (Beaumont, Zhang & Balding 2002) on semi-automatic
/// summaries (Fearnhead & Prangle 2012): each parameter's posterior mean is learnt by ridge regression on the
/// descriptors, their principal components' squares and products, strength by leave-one-out error; the
/// nearest simulations in those summaries carry their leave-one-out errors over to the observed tree. The
/// observation's errors are added to the simulations first, by draws keyed by row and column. Fewer than 30
/// simulations give the prior. Throws InputError when sizes disagree.
PosteriorSample regression_posterior(const PriorSimulations& simulations, const Observation& observed);

/// Of one column of values under the sample's weights.
double weighted_quantile(const Eigen::VectorXd& values, const Eigen::VectorXd& weights, double share);
double weighted_deviation(const Eigen::VectorXd& values, const Eigen::VectorXd& weights);

}  // namespace dendrofit
