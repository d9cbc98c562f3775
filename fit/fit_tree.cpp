// SPDX-License-Identifier: GPL-3.0-or-later
#include "fit/fit_tree.h"

#include "core/errors.h"
#include "core/random.h"
#include "fit/fit_problem.h"
#include "fit/fit_report.h"
#include "fit/fit_search.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

namespace dendrofit {
namespace {

constexpr int kNoiseSeeds = 16;
constexpr int kPosteriorTrees = 5;

/// Noise about the posterior's centre, from replicates there, held to what is typical of trees.
NoiseMetric noise_at(const FitProblem& problem, const SeedNoise& typical, const Eigen::VectorXd& centre,
                     SimulationLog& log, Progress& progress) {
  progress.begin("measuring the noise between seeds", 1, "set");
  const Eigen::MatrixXd replicates = problem.run({centre}, kNoiseSeeds, kNoiseKeys, log, progress);
  progress.end();
  return {typical, replicates, problem.observed, problem.error};
}

/// Trees of parameter sets drawn from the posterior.
std::vector<PosteriorTree> posterior_trees(const FitProblem& problem, const NoiseMetric& metric,
                                           const PosteriorSample& posterior, double internode_length_m,
                                           SimulationLog& log, Progress& progress) {
  UnitPoints points;
  Random random = Random(problem.options.seed).child({0x70571});
  for (int k = 0; k < kPosteriorTrees; ++k) {
    double left = random.uniform();
    Eigen::Index i = 0;
    while (i + 1 < posterior.weights.size() && (left -= posterior.weights[i]) > 0) ++i;
    points.emplace_back(posterior.unit.row(i).transpose());
  }
  progress.begin("regrowing posterior trees", kPosteriorTrees, "trees");
  const Eigen::MatrixXd rows = problem.run(points, 1, kPosteriorKeys, log, progress);
  progress.end();
  SearchSpace space = problem.space;
  space.set_internode_length(internode_length_m);
  std::vector<PosteriorTree> trees;
  for (std::size_t k = 0; k < points.size(); ++k) {
    const std::uint64_t seed = simulation_seed(problem.options.seed, kPosteriorKeys + k, 0);
    IgmParameters parameters = space.at(points[k]);
    parameters.tip_radius_m = regrow(parameters, problem.setting.observed, seed, progress).tip_radius_m;
    trees.push_back({parameters, seed, metric.cost(rows.row(static_cast<Eigen::Index>(k)))});
  }
  return trees;
}

/// Takes the surrogate's minimum among the finalists, and says whether fresh seeds preferred it.
Judged judge_ends(const FitProblem& problem, const NoiseMetric& metric, const SearchBox& box,
                  const Eigen::VectorXd& found, const std::vector<Tried>& tried, SimulationLog& log,
                  TreeFit& fit, Progress& progress) {
  Judged best = judge(problem, metric, box, {found, box.elsewhere}, tried, kJudgingKeys + 1, log, progress);
  const auto refined = refine_on_surrogate(tried, box, metric, best.point);
  if (!refined) {
    fit.refinement.outcome = "not tried: too few parameter sets for a surrogate";
    return best;
  }
  const Judged other = judge(problem, metric, box, {*refined}, {}, kJudgingKeys + 100, log, progress);
  fit.refinement = {
      true, other.cost < best.cost, best.cost, other.cost,
      other.cost < best.cost ? "kept: better on fresh seeds" : "dropped: not better on fresh seeds"};
  return fit.refinement.kept ? other : best;
}

}  // namespace

void FitOptions::validate() const {
  require(evaluations >= 1, "evaluations", evaluations, "at least 1");
  require(seeds >= 1 && seeds <= 64, "seeds", seeds, "between 1 and 64");
  require(threads >= 0, "threads", threads, "0 (all cores) or more");
  if (seconds) require(std::isfinite(*seconds) && *seconds > 0, "seconds", *seconds, "must be positive");
  if (age_years)
    require(std::isfinite(*age_years) && *age_years >= 2 && *age_years <= 5000, "age_years", *age_years,
            "between 2 and 5000 years");
  if (internode_length_m)
    require(std::isfinite(*internode_length_m) && *internode_length_m > 0, "internode_length_m",
            *internode_length_m, "must be positive");
  if (dbh_m) require(std::isfinite(*dbh_m) && *dbh_m > 0, "dbh_m", *dbh_m, "must be positive");
  if (thinnest_wood_m)
    require(std::isfinite(*thinnest_wood_m) && *thinnest_wood_m > 0, "thinnest_wood_m", *thinnest_wood_m,
            "must be positive");
  if (heights && heights->time.empty()) throw InputError("heights: no measurement");
}

TreeFit fit_tree(const Tree& observed, const FitOptions& options, Progress& progress) {
  options.validate();
  observed.validate();
  FitProblem problem = pose(observed, options);
  SimulationLog log(identity(problem));
  if (!options.resume_from.empty()) log.restore(options.resume_from);

  TreeFit fit;
  fit.seed = options.seed;
  fit.comparison = problem.setting.comparison;
  fit.direct = problem.setting.observed;
  fit.age_known = problem.space.fixed(problem.space.row("cycles"));
  fit.course_known = options.heights.has_value();
  fit.years_per_cycle = problem.years_per_cycle;

  // What simulations of the prior say.
  const PriorInformation prior = prior_information(problem, log, progress);
  const PosteriorSample posterior = first_posterior(problem, prior, progress);
  fit.used_bank = prior.from_bank;
  fit.prior_simulations = static_cast<int>(prior.simulations.unit.rows());
  fit.evidence = equation_evidence(posterior, prior.simulations);

  // The search within it.
  SearchBox box = search_box(problem, posterior);
  const NoiseMetric metric = noise_at(problem, prior.noise, box.elsewhere, log, progress);
  if (options.on_checkpoint) options.on_checkpoint(log.bytes(problem.seconds(log)));
  std::vector<Tried> tried;
  note(prior.points, prior.simulations.descriptors, 1, metric, box, tried, fit);
  box.start_at(best_start(problem, prior, metric, box, log, tried, fit, progress));
  const Eigen::VectorXd found = search(problem, metric, box, log, tried, fit, progress);

  // Both ends on fresh seeds.
  const Eigen::MatrixXd before = problem.run({Eigen::VectorXd::Constant(problem.space.size(), 0.5)},
                                             kJudgingSeeds, kJudgingKeys, log, progress);
  Judged best = judge_ends(problem, metric, box, found, tried, log, fit, progress);
  best = settle_tree(problem, metric, box, std::move(best), progress);

  SearchSpace space = problem.space;
  space.set_internode_length(best.internode_length_m);
  fit.best = space.at(best.point);
  fit.best_seed = simulation_seed(options.seed, best.key, best.shown);
  fit.best.tip_radius_m = regrow(fit.best, fit.direct, fit.best_seed, progress).tip_radius_m;
  fit.cost_before = metric.cost(before);
  fit.cost_after = best.distance;
  fit.seed_floor = seed_floor(best.simulations, metric);
  fit.parameters = report_parameters(problem, posterior, fit.best);
  fit.correlated = report_correlations(problem, posterior);
  fit.descriptors = report_descriptors(problem, metric, before, best.simulations);
  fit.posterior_trees = posterior_trees(problem, metric, posterior, best.internode_length_m, log, progress);
  fit.seconds = problem.seconds(log);
  warn(problem, posterior, fit);
  return fit;
}

}  // namespace dendrofit
