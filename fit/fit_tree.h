// SPDX-License-Identifier: GPL-3.0-or-later
// The inverse: growth and branching parameters under which the growth model grows trees like the observed
// one.
#pragma once

#include "core/measurements.h"
#include "core/progress.h"
#include "core/tree.h"
#include "fit/descriptors.h"
#include "fit/direct_estimates.h"
#include "fit/prior_bank.h"
#include "fit/tree_simulator.h"
#include "forward/igm/parameters.h"

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace dendrofit {

/// What other trees of the same kind say of a coordinate of the search box (search_space.h).
struct SpeciesEstimate {
  std::string key;
  double unit = 0.5;
  double error = 1;  ///< standard error
};

struct FitOptions {
  int evaluations = 200;            ///< parameter sets tried at most
  std::optional<double> seconds;    ///< stop after about this long (the result then depends on the machine)
  std::optional<double> age_years;  ///< searched (in growth cycles) where it is not known
  /// Dated heights (years, metres) of this tree: their growth curve fixes the time course, and its last time
  /// the age unless that is given.
  std::optional<MeasurementSeries> heights;
  std::optional<double> internode_length_m;  ///< none: by the tree's height (scale_for)
  std::string equation = "logistic";         ///< logistic, bertalanffy or weibull
  ObservedFrom observed_from = ObservedFrom::scan;
  std::optional<double> dbh_m;  ///< measured on the scan; none: the observed tree's own
  /// Radius below which wood is missing from the observed tree (a model that was cut there), and with it some
  /// of its height: grown trees are cut alike. None: the observed tree is whole.
  std::optional<double> thinnest_wood_m;
  int seeds = 2;  ///< simulations averaged for each parameter set
  std::uint64_t seed = 1;
  int threads = 0;
  /// Simulations of the prior; none, or of another model: some of the budget goes into drawing new ones.
  std::shared_ptr<const PriorBank> bank;
  /// Compares grown trees as an observer sees them; none: as grown, on descriptors that a scan shows
  /// reliably.
  ObserveTree observe;
  std::vector<SpeciesEstimate> species;  ///< sharpens the posterior
  std::map<std::string, double> held;    ///< coordinates (unit) that the search leaves where they are
  std::string resume_from;               ///< a checkpoint of the same fit; empty: from the beginning
  /// Given a checkpoint after every generation.
  std::function<void(std::string_view checkpoint)> on_checkpoint;
  void validate() const;
};

struct FittedParameter {
  std::string key;
  std::string unit;
  std::string meaning;
  double value = 0;       ///< of the best parameter set, which regrows the tree
  double median = 0;      ///< of the posterior
  double lo = 0, hi = 0;  ///< 90 % interval of the posterior, `value` inside
  double lo50 = 0, hi50 = 0;
  double prior_lo = 0, prior_hi = 0;
  double shrinkage = 0;  ///< 1 - posterior sd / prior sd
  bool identifiable = false;
};

/// Two parameters that the tree determines only together.
struct CorrelatedPair {
  std::string first, second;
  double correlation = 0;
};

/// How well a growth equation explains the tree, over the whole prior.
struct EquationEvidence {
  std::string equation;
  double probability = 0;     ///< posterior, equal beforehand
  double log10_evidence = 0;  ///< relative to the equations' mean: 0 says nothing, 1 is strong
};

/// One descriptor of the observed tree beside those of regrown ones.
struct DescriptorFit {
  std::string name;
  std::string unit;
  double observed = 0;
  double before = 0;  ///< mean at the middle of the prior ranges, fresh seeds
  double after = 0;   ///< mean at the best parameters, fresh seeds
  double noise = 0;   ///< standard deviation between seeds, with the observation's error
};

/// A tree regrown from a draw of the posterior.
struct PosteriorTree {
  IgmParameters parameters;
  std::uint64_t seed = 1;
  double cost = 0;
};

/// The end of the search against the minimum of a surrogate of the descriptors (Ceres), on fresh seeds; costs
/// are distances and what the parameters' improbability adds.
struct SurrogateRefinement {
  bool tried = false;
  bool kept = false;
  double cost_without = 0, cost_with = 0;
  std::string outcome;
};

struct TreeFit {
  std::string model = "igm";
  IgmParameters best;
  std::uint64_t best_seed = 1;  ///< with which `best` regrows the tree nearest to the observed one
  double years_per_cycle = 1;
  bool age_known = false;
  bool course_known = false;
  DirectEstimates direct;
  std::vector<FittedParameter> parameters;
  std::vector<CorrelatedPair> correlated;
  std::vector<EquationEvidence> evidence;  ///< empty where no bank could be used
  std::vector<DescriptorFit> descriptors;
  std::vector<PosteriorTree> posterior_trees;
  SurrogateRefinement refinement;
  int prior_simulations = 0;  ///< that the posterior rests on
  bool used_bank = false;
  double cost_before = 0;  ///< distance per descriptor (1: as far as two seeds of one tree are), fresh seeds
  double cost_after = 0;
  double seed_floor = 0;  ///< the same distance between regrown trees of the best parameters themselves
  int evaluations = 0;
  bool converged = false;
  std::string stop_reason;
  std::vector<double> cost_history;  ///< best cost after each evaluation
  DescribeOptions comparison;        ///< how both trees were truncated
  std::uint64_t seed = 1;
  double seconds = 0;  ///< the only field that differs between equal runs
  std::vector<std::string> warnings;
};

/// Method: descriptors of the observed tree; a posterior from simulations of the prior (a bank made
/// beforehand, regression_posterior.h); CMA-ES inside it, every evaluation on fresh seeds, with distances
/// counted in the noise that seeds and the observation make (Wood 2010) and parameters far from the
/// posterior's centre counted against; a least-squares step on a surrogate of the descriptors, kept where
/// fresh seeds say that it is better; the end judged on fresh seeds again.
/// Radii scale with the model's tip radius, which is therefore set so that the diameter agrees. Same tree,
/// options and seed: the same result for any number of threads, interrupted and resumed or not (unless
/// `seconds` ends it). Throws InputError for bad options or an empty tree, SolverError when no simulation can
/// be compared.
TreeFit fit_tree(const Tree& observed, const FitOptions& options = {}, Progress& progress = no_progress());

}  // namespace dendrofit
