// SPDX-License-Identifier: GPL-3.0-or-later
// From a posterior to one best parameter set. Internal to the fit of a tree.
#pragma once

#include "fit/fit_problem.h"
#include "fit/noise_metric.h"

#include <vector>

#include <Eigen/Core>

namespace dendrofit {

/// The part of the unit box that is searched: coordinates the tree tells something of, within what the
/// posterior leaves them; the others stay at the posterior's median.
struct SearchBox {
  std::vector<Eigen::Index> rows;
  Eigen::VectorXd lo, hi;     ///< of those rows
  Eigen::VectorXd elsewhere;  ///< the whole point

  Eigen::VectorXd full(const Eigen::VectorXd& inner) const;
  Eigen::VectorXd inner(const Eigen::VectorXd& full) const;
  /// Makes `point` the centre, and the ranges wide enough to hold it.
  void start_at(const Eigen::VectorXd& point);
};

SearchBox search_box(const FitProblem& problem, const PosteriorSample& posterior);

/// One evaluated parameter set.
struct Tried {
  Eigen::VectorXd point;
  Eigen::VectorXd descriptors;  ///< mean over its seeds
  double cost = 0;
};

/// A parameter set judged on fresh seeds.
struct Judged {
  Eigen::VectorXd point;
  Eigen::MatrixXd simulations;
  double cost = 0;
  std::uint64_t key = 0;
  double internode_length_m = 0;
  int shown = 0;  ///< the simulation nearest to the observed tree, before its scale was settled
};

inline constexpr int kJudgingSeeds = 8;

/// Notes evaluations whose simulations stand in `rows`, `seeds` rows a point; returns their costs.
std::vector<double> note(const UnitPoints& points, const Eigen::MatrixXd& rows, int seeds,
                         const NoiseMetric& metric, std::vector<Tried>& tried, TreeFit& fit);

/// Where to start: the posterior's centre, or one of the simulations of the prior nearest to the observed
/// tree, whichever fresh seeds find nearer.
Eigen::VectorXd best_start(const FitProblem& problem, const PriorInformation& prior,
                           const NoiseMetric& metric, const SearchBox& box, SimulationLog& log,
                           std::vector<Tried>& tried, TreeFit& fit, Progress& progress);

/// CMA-ES from the box's centre until the budget, the time or the search itself ends; the centre it reached.
Eigen::VectorXd search(const FitProblem& problem, const NoiseMetric& metric, const SearchBox& box,
                       SimulationLog& log, std::vector<Tried>& tried, TreeFit& fit, Progress& progress);

/// The finalists and the best few tried, on fresh seeds, since the best of many noisy costs is partly luck.
Judged judge(const FitProblem& problem, const NoiseMetric& metric, UnitPoints finalists,
             std::vector<Tried> tried, std::uint64_t first_key, SimulationLog& log, Progress& progress);

/// Internode length is a convention unless it was given, and a scan's height is known to a hundredth: the one
/// that gives the nearest tree the observed height is taken.
Judged settle_scale(const FitProblem& problem, const NoiseMetric& metric, Judged best, Progress& progress);

/// Mean distance of each of the trees from the others: what no parameter set can get below.
double seed_floor(const Eigen::MatrixXd& simulations, const NoiseMetric& metric);

/// Minimum of a surrogate of the descriptors (linear with squares, least squares on what was tried) found by
/// Ceres within the box; nothing where too little was tried.
std::optional<Eigen::VectorXd> refine_on_surrogate(const std::vector<Tried>& tried, const SearchBox& box,
                                                   const NoiseMetric& metric, const Eigen::VectorXd& start);

}  // namespace dendrofit
