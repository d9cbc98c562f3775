// SPDX-License-Identifier: GPL-3.0-or-later
// What simulations drawn from the prior say about parameters, given the descriptors of one observed tree.
#pragma once

#include <vector>

#include <Eigen/Core>

namespace dendrofit {

/// One parameter's posterior on the unit interval of its prior range (the prior is uniform there).
struct UnitPosterior {
  double median = 0.5;
  double lo = 0.05;  ///< 5 % quantile
  double hi = 0.95;  ///< 95 % quantile
  double shrinkage =
      0;  ///< 1 - posterior sd / prior sd, from errors on simulations left out; 0: nothing learnt
};

/// Regression-adjusted approximate Bayesian computation (Beaumont, Zhang & Balding 2002): parameters (rows of
/// `parameters`, unit box) regressed on descriptors (rows of `descriptors`, each column about unit noise)
/// with Epanechnikov weights by distance from `observed`, ridge strength per parameter by leave-one-out
/// error; the leave-one-out errors, not the fitted residuals, make the interval. Fewer than 30 simulations
/// give the prior. Throws InputError when the sizes disagree.
std::vector<UnitPosterior> regression_posterior(const Eigen::MatrixXd& parameters,
                                                const Eigen::MatrixXd& descriptors,
                                                const Eigen::VectorXd& observed);

}  // namespace dendrofit
