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
  Eigen::VectorXd lo, hi;             ///< of those rows
  Eigen::VectorXd elsewhere;          ///< the whole point
  Eigen::VectorXd centre, deviation;  ///< of the posterior, whole points; deviation infinite where not
                                      ///< searched for, or without a posterior
  /// How much less the posterior is believed, in variances: above 1 where even the best start is farther from
  /// the observed tree than starts are where the model holds, and the model, with it the posterior, is off.
  double doubt = 1;

  Eigen::VectorXd full(const Eigen::VectorXd& inner) const;
  Eigen::VectorXd inner(const Eigen::VectorXd& full) const;
  /// Makes `point` the centre, and the ranges wide enough to hold it.
  void start_at(const Eigen::VectorXd& point);
  /// Sum over the coordinates of their squared distances from the posterior's centre in its deviations,
  /// beyond 3 of them going on linearly; over `doubt`.
  double improbability(const Eigen::VectorXd& point) const;
};

/// What the simulations of the prior say of the observed tree (of the bank's whole trees, as_whole()).
PosteriorSample first_posterior(const FitProblem& problem, const PriorInformation& prior, Progress& progress);

SearchBox search_box(const FitProblem& problem, const PosteriorSample& posterior);

/// What the search makes small: the distance per descriptor, each coordinate's improbability counted as one
/// descriptor more. Very different parameter sets grow trees equally near; of those, the probable one is
/// wanted.
double search_cost(double distance, const Eigen::VectorXd& point, const SearchBox& box,
                   const NoiseMetric& metric);

/// One evaluated parameter set.
struct Tried {
  Eigen::VectorXd point;
  Eigen::VectorXd descriptors;  ///< mean over its seeds
  double cost = 0;              ///< search_cost()
};

/// A parameter set judged on fresh seeds.
struct Judged {
  Eigen::VectorXd point;
  Eigen::MatrixXd simulations;
  double distance = 0;
  double cost = 0;  ///< search_cost()
  std::uint64_t key = 0;
  double internode_length_m = 0;
  int shown = 0;  ///< the seed whose tree is shown
};

inline constexpr int kJudgingSeeds = 8;

/// Notes evaluations whose simulations stand in `rows`, `seeds` rows a point; returns their search_cost()s.
std::vector<double> note(const UnitPoints& points, const Eigen::MatrixXd& rows, int seeds,
                         const NoiseMetric& metric, const SearchBox& box, std::vector<Tried>& tried,
                         TreeFit& fit);

/// Where to start: the posterior's centre, or one of the simulations of the prior nearest to the observed
/// tree, whichever fresh seeds find nearer. Their distances set the box's doubt.
Eigen::VectorXd best_start(const FitProblem& problem, const PriorInformation& prior,
                           const NoiseMetric& metric, SearchBox& box, SimulationLog& log,
                           std::vector<Tried>& tried, TreeFit& fit, Progress& progress);

/// CMA-ES from the box's centre until the budget, the time or the search itself ends; the centre it reached.
Eigen::VectorXd search(const FitProblem& problem, const NoiseMetric& metric, const SearchBox& box,
                       SimulationLog& log, std::vector<Tried>& tried, TreeFit& fit, Progress& progress);

/// The finalists and the best few tried, on fresh seeds, since the best of many noisy costs is partly luck.
Judged judge(const FitProblem& problem, const NoiseMetric& metric, const SearchBox& box, UnitPoints finalists,
             std::vector<Tried> tried, std::uint64_t first_key, SimulationLog& log, Progress& progress);

/// The end of the search as what is shown. Measures that a forester takes from a scan are met as far as
/// freely chosen quantities allow: the internode length, a convention unless it was given, by the observed
/// height; the pipe exponent, which bears on radii alone, by the wood volume (and the diameter, where tip
/// radii are at their limit), weighed against what the posterior says of it; and of some more seeds' trees
/// the one is shown that is nearest in the descriptors, height, volume and crown diameter together.
/// (settle_tree.cpp)
Judged settle_tree(const FitProblem& problem, const NoiseMetric& metric, const SearchBox& box, Judged best,
                   Progress& progress);

/// Mean distance of each of the trees from the others: what no parameter set can get below.
double seed_floor(const Eigen::MatrixXd& simulations, const NoiseMetric& metric);

/// Minimum, with the coordinates' improbability, of a surrogate of the descriptors (linear with squares,
/// least squares on what was tried) found by Ceres within the box; nothing where too little was tried.
std::optional<Eigen::VectorXd> refine_on_surrogate(const std::vector<Tried>& tried, const SearchBox& box,
                                                   const NoiseMetric& metric, const Eigen::VectorXd& start);

}  // namespace dendrofit
