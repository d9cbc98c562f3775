// SPDX-License-Identifier: GPL-3.0-or-later
// Posterior means as functions of descriptors, learnt by ridge regression on many simulations.
#pragma once

#include <Eigen/Core>

namespace dendrofit {

/// Regresses each column of `targets` on features of the rows of `inputs` (about standard units): their
/// principal components, squares and products of as many leading components as the number of rows can carry.
/// Ridge strength per target by leave-one-out error, in closed form.
struct SummaryRegression {
  SummaryRegression(const Eigen::MatrixXd& inputs, const Eigen::MatrixXd& targets,
                    const Eigen::VectorXd& observed);

  Eigen::MatrixXd fitted;     ///< leave-one-out prediction of each row's targets
  Eigen::VectorXd predicted;  ///< of the observed input
  Eigen::VectorXd error;      ///< root mean squared leave-one-out error
};

}  // namespace dendrofit
