// SPDX-License-Identifier: GPL-3.0-or-later
// What a fit of growth parameters must beat at equal cost.
#pragma once

#include "core/tree.h"
#include "fit/fit_problem.h"
#include "fit/noise_metric.h"

#include <cstdint>
#include <string>
#include <vector>

namespace dendrofit {

/// Branches of a tree as points in a space of features (length, height, angle, thickness, taper,
/// straightness, order), and the distance of two such clouds as Potapov et al. (2016) have it: the
/// Kolmogorov-Smirnov statistic of their projections on random directions, averaged.
class ProjectedKs {
 public:
  /// Features are counted in the observed tree's standard deviations. Throws SolverError for fewer than three
  /// branches.
  ProjectedKs(const Tree& observed, const DescribeOptions& comparison, std::uint64_t seed);
  /// 1, the most there is, for a tree with fewer than three branches.
  double distance(const Tree& tree) const;

 private:
  Eigen::MatrixXd scaled(const Tree& tree) const;
  DescribeOptions comparison_;
  Eigen::MatrixXd directions_;  ///< one a column
  Eigen::VectorXd scale_;
  std::vector<std::vector<double>> observed_;  ///< projected, rising, one a direction
};

/// A point of the unit box by `method`, trying `trees` simulated trees in all:
/// "mean": the middle of every range; "random": the nearest of uniform draws by `metric`, two trees a draw;
/// "genetic": a genetic algorithm on ProjectedKs, one tree an individual under a seed that stays the same, as
/// Potapov et al. have it (tournaments of two, blend crossover, Gaussian mutation, two elites).
/// Throws InputError for another method.
Eigen::VectorXd baseline(const std::string& method, const FitProblem& problem, const NoiseMetric& metric,
                         const ProjectedKs& ks, int trees);

}  // namespace dendrofit
