// SPDX-License-Identifier: GPL-3.0-or-later
// One fit's setting, worked out from the observed tree and the options. Internal to the fit of a tree.
#pragma once

#include "fit/fit_tree.h"
#include "fit/regression_posterior.h"
#include "fit/search_space.h"
#include "fit/seed_noise.h"
#include "fit/simulation_log.h"

#include <chrono>
#include <string>
#include <vector>

#include <Eigen/Core>

namespace dendrofit {

using UnitPoints = std::vector<Eigen::VectorXd>;

// First keys of the kinds of evaluation, so that no two share a seed.
inline constexpr std::uint64_t kPriorKeys = 0;
inline constexpr std::uint64_t kSearchKeys = 1'000'000;
inline constexpr std::uint64_t kJudgingKeys = 2'000'000;
inline constexpr std::uint64_t kNoiseKeys = 3'000'000;
inline constexpr std::uint64_t kPosteriorKeys = 4'000'000;
inline constexpr std::uint64_t kCutKeys = 5'000'000;

struct FitProblem {
  const FitOptions& options;
  SimulationSetting setting;
  SearchSpace space;
  std::size_t level = 0;     ///< of kVisibleShares
  Eigen::VectorXd observed;  ///< descriptors; NaN where missing or to be left out
  Eigen::VectorXd error;     ///< of the observation
  double years_per_cycle = 1;
  std::vector<std::string> warnings;
  std::chrono::steady_clock::time_point started = std::chrono::steady_clock::now();

  /// Simulations of `points` in `space` (or another), logged.
  Eigen::MatrixXd run(const UnitPoints& points, int seeds, std::uint64_t first_key, SimulationLog& log,
                      Progress& progress) const;
  double seconds(const SimulationLog& log) const;
  bool out_of_time(const SimulationLog& log) const;
};

/// Throws as fit_tree().
FitProblem pose(const Tree& observed, const FitOptions& options);

/// A digest of all that decides the result.
std::uint64_t identity(const FitProblem& problem);

/// Simulations of the prior that the posterior rests on.
struct PriorInformation {
  PriorSimulations simulations;
  Observation observation;
  SeedNoise noise;    ///< typical of trees, at the truncation in use
  UnitPoints points;  ///< those simulated here, in the order of their keys; empty with a bank
  bool from_bank = false;
};

/// From the bank where there is one that fits the model and the tree, else up to half the budget is spent on
/// new ones (and `problem.space` narrowed to the tree's size); why is said in problem.warnings.
PriorInformation prior_information(FitProblem& problem, SimulationLog& log, Progress& progress);

/// The observation as the bank's whole trees would be seen: of a tree that lacks its thin wood, the height
/// with what trees at `centre` lose of theirs to the same cut, on average.
Observation as_whole(const FitProblem& problem, const Observation& observation, const Eigen::VectorXd& centre,
                     Progress& progress);

/// Probabilities and evidence of the growth equations under a posterior from the bank.
std::vector<EquationEvidence> equation_evidence(const PosteriorSample& posterior,
                                                const PriorSimulations& simulations);

}  // namespace dendrofit
