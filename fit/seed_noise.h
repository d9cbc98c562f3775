// SPDX-License-Identifier: GPL-3.0-or-later
// How much the descriptors of trees grown from one parameter set differ by chance.
#pragma once

#include <vector>

#include <Eigen/Core>

namespace dendrofit {

struct SeedNoise {
  /// Between trees of one parameter set; a descriptor too seldom seen to tell has a row and a column of NaN.
  Eigen::MatrixXd covariance;

  /// Standard deviation of a descriptor; NaN where unknown.
  double deviation(Eigen::Index descriptor) const;
};

/// From groups of trees (rows: descriptors, NaN: missing) that share a parameter set each: the median of the
/// groups' standard deviations, and correlations over all groups in which no tree counts more than 3 sd; so
/// that a few parameter sets whose trees die early in some seeds do not speak for the others.
SeedNoise noise_within(const std::vector<Eigen::MatrixXd>& groups);

/// From single trees of many parameter sets (unit box): what a quadratic in each parameter leaves. More than
/// the seeds' noise where descriptors do not follow one; for want of replicates.
SeedNoise noise_about_trend(const Eigen::MatrixXd& parameters, const Eigen::MatrixXd& descriptors);

}  // namespace dendrofit
