// SPDX-License-Identifier: GPL-3.0-or-later
// The inverse: growth and branching parameters under which the growth model grows trees like the observed
// one.
#pragma once

#include "core/progress.h"
#include "core/tree.h"
#include "fit/descriptors.h"
#include "forward/igm/parameters.h"

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace dendrofit {

struct FitOptions {
  int evaluations = 500;            ///< parameter sets tried at most, the bank's included
  std::optional<double> seconds;    ///< stop after about this long (the result then depends on the machine)
  std::optional<double> age_years;  ///< searched (in growth cycles) where it is not known
  std::optional<double> internode_length_m;  ///< none: by the tree's height (search_space.h)
  std::string equation = "logistic";         ///< logistic, bertalanffy or weibull
  int seeds = 2;                             ///< simulations averaged for each parameter set
  std::uint64_t seed = 1;
  int threads = 0;
  void validate() const;
};

struct FittedParameter {
  std::string key;
  std::string unit;
  std::string meaning;
  double value = 0;       ///< of the best parameter set, which regrows the tree
  double lo = 0, hi = 0;  ///< 90 % interval, `value` inside
  double prior_lo = 0, prior_hi = 0;
  double shrinkage = 0;  ///< 1 - posterior sd / prior sd
  bool identifiable = false;
};

/// One descriptor of the observed tree beside those of regrown ones.
struct DescriptorFit {
  std::string name;
  std::string unit;
  double observed = 0;
  double before = 0;  ///< mean at the middle of the prior ranges, fresh seeds
  double after = 0;   ///< mean at the best parameters, fresh seeds
  double noise = 0;   ///< standard deviation between seeds, with the scan's error
};

struct TreeFit {
  std::string model = "igm";
  IgmParameters best;
  std::uint64_t best_seed = 1;  ///< with which `best` regrows the tree nearest to the observed one
  double years_per_cycle = 1;
  bool age_known = false;
  std::vector<FittedParameter> parameters;
  std::vector<DescriptorFit> descriptors;
  double cost_before = 0;  ///< distance per descriptor (1: as far as two seeds of one tree are), fresh seeds
  double cost_after = 0;
  double seed_floor = 0;  ///< the same distance between regrown trees of the best parameters themselves
  int evaluations = 0;
  bool converged = false;
  std::string stop_reason;
  std::vector<double> cost_history;  ///< best cost after each evaluation
  DescribeOptions comparison;        ///< how both trees were truncated
  std::uint64_t seed = 1;
  std::vector<std::string> warnings;
};

/// Method: descriptors of the observed tree; a bank of simulations drawn from the prior, which gives the
/// noise metric (residual covariance of descriptors given parameters, after Wood 2010) and a regression-ABC
/// posterior; CMA-ES from the posterior's centre, every evaluation on fresh seeds; the end judged on fresh
/// seeds again. Radii scale with the model's tip radius, which is therefore set, not searched, so that the
/// diameter agrees. Same tree, options and seed: the same result for any number of threads (unless `seconds`
/// ends it). Throws InputError for bad options or an empty tree, SolverError when no simulation can be
/// compared.
TreeFit fit_tree(const Tree& observed, const FitOptions& options = {}, Progress& progress = no_progress());

}  // namespace dendrofit
