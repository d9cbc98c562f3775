// SPDX-License-Identifier: GPL-3.0-or-later
#include "fit/fit_trees.h"

#include "core/errors.h"
#include "fit/fit_problem.h"

#include <algorithm>
#include <cmath>
#include <string>

namespace dendrofit {
namespace {

constexpr double kPriorMean = 0.5;
constexpr double kPriorPrecision = 12;  // of a uniform distribution on the unit interval
constexpr double kLeastDeviation = 0.01;
constexpr double kNoInformation = 1;  // precision below which a likelihood tells nothing
constexpr double kIdentifiableShrinkage = 0.3;
constexpr double kNinety = 1.6449, kFifty = 0.6745;  // normal quantiles

/// A normal likelihood, as precision and precision times mean, so that a product is a sum.
struct Likelihood {
  double precision = 0;
  double weighted = 0;
};

/// Per coordinate of the box.
using Likelihoods = std::vector<Likelihood>;

Likelihoods likelihoods_of(const Tree& tree, const FitOptions& options, Progress& progress) {
  FitProblem problem = pose(tree, options);
  SimulationLog log(0);
  const PriorInformation prior = prior_information(problem, log, progress);
  if (!prior.from_bank)
    throw InputError(
        "several trees are fitted together from the bank of prior simulations, which cannot be used for one "
        "of them; fit them one by one");
  const PosteriorSample posterior = regression_posterior(prior.simulations, prior.observation);
  Likelihoods all;
  for (Eigen::Index i = 0; i < problem.space.size(); ++i) {
    const double mean = posterior.weights.dot(posterior.unit.col(i));
    const double sd = std::max(kLeastDeviation, weighted_deviation(posterior.unit.col(i), posterior.weights));
    // posterior over prior
    const double precision = std::max(0.0, 1 / (sd * sd) - kPriorPrecision);
    all.push_back({precision, precision > 0 ? mean / (sd * sd) - kPriorMean * kPriorPrecision : 0});
  }
  return all;
}

Likelihood product(const std::vector<Likelihoods>& trees, std::size_t row, std::size_t without) {
  Likelihood sum;
  for (std::size_t t = 0; t < trees.size(); ++t) {
    if (t == without) continue;
    sum.precision += trees[t][row].precision;
    sum.weighted += trees[t][row].weighted;
  }
  return sum;
}

}  // namespace

TreesFit fit_trees(const std::vector<Tree>& trees, const FitOptions& options, Progress& progress) {
  if (trees.size() < 2) throw InputError("fit_trees: two trees or more are needed");
  if (options.heights) throw InputError("fit_trees: dated heights belong to one tree; fit it alone");
  if (!options.resume_from.empty()) throw InputError("fit_trees: a joint fit cannot be resumed");
  std::vector<Likelihoods> likelihoods;
  for (const Tree& tree : trees) likelihoods.push_back(likelihoods_of(tree, options, progress));

  const SearchSpace space(options.equation);
  const std::vector<ReportedRow> reported = space.reported();
  const std::vector<ParameterSpec> table = igm_parameter_table(options.equation);
  TreesFit fit;
  FitOptions joint = options;
  for (std::size_t i = 0; i < space.rows().size(); ++i) {
    const SearchRow& row = space.rows()[i];
    if (!row.of_species) continue;
    const Likelihood all = product(likelihoods, i, trees.size());
    const double precision = all.precision + kPriorPrecision;
    const double mean = std::clamp((all.weighted + kPriorMean * kPriorPrecision) / precision, 0.0, 1.0);
    joint.held[std::string(row.key)] = mean;
    const auto known = std::find_if(reported.begin(), reported.end(),
                                    [&](const ReportedRow& r) { return r.key == row.key; });
    if (known == reported.end()) continue;
    const auto spec =
        std::find_if(table.begin(), table.end(), [&](const ParameterSpec& s) { return s.key == row.key; });
    const double sd = 1 / std::sqrt(precision);
    const auto at = [&](double z) { return space.value(static_cast<Eigen::Index>(i), mean + z * sd); };
    FittedParameter p;
    p.key = row.key;
    p.unit = spec->unit;
    p.meaning = spec->meaning;
    p.value = p.median = at(0);
    p.lo = at(-kNinety);
    p.hi = at(kNinety);
    p.lo50 = at(-kFifty);
    p.hi50 = at(kFifty);
    p.prior_lo = known->lo;
    p.prior_hi = known->hi;
    p.shrinkage = 1 - sd * std::sqrt(kPriorPrecision);
    p.identifiable = p.shrinkage >= kIdentifiableShrinkage;
    fit.shared.push_back(p);
  }

  for (std::size_t t = 0; t < trees.size(); ++t) {
    FitOptions own = joint;
    for (std::size_t i = 0; i < space.rows().size(); ++i) {
      const Likelihood others = product(likelihoods, i, t);
      if (!space.rows()[i].of_species || others.precision < kNoInformation) continue;
      own.species.push_back({std::string(space.rows()[i].key), others.weighted / others.precision,
                             1 / std::sqrt(others.precision)});
    }
    fit.trees.push_back(fit_tree(trees[t], own, progress));
  }
  return fit;
}

}  // namespace dendrofit
