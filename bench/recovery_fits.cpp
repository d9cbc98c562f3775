// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/recovery_fits.h"

#include "core/errors.h"
#include "core/metrics.h"
#include "core/tree_topology.h"
#include "fit/fit_problem.h"
#include "fit/fit_report.h"
#include "fit/fit_search.h"

#include "bench/recovery_baselines.h"

namespace dendrofit {
namespace {

constexpr int kRegrown = 8;

/// Trees regrown from `best` on fresh seeds beside the true one: means of their measures (the height also of
/// what of each would be seen, beside what was), and two distances from the tree as seen: in typical noise,
/// and by projected Kolmogorov-Smirnov statistics. Each distance is judged by what the true parameters' own
/// trees have.
void judge_regrown(const Truth& truth, const Tree& seen, const FitOptions& options, const IgmParameters& best,
                   std::vector<RecoveryLine>& lines) {
  const FitProblem problem = pose(seen, options);
  const NoiseMetric metric(options.bank->noise.at(problem.level), Eigen::MatrixXd(0, problem.observed.size()),
                           problem.observed, problem.error);
  const ProjectedKs ks(seen, problem.setting.comparison, truth.seed);
  struct Judged {
    double height = 0, seen_height = 0, dbh = 0, volume = 0, crown = 0, cost = 0, ks = 0;
  };
  const auto judged = [&](const IgmParameters& parameters) {
    Judged sum;
    for (int s = 0; s < kRegrown; ++s) {
      const Tree tree =
          regrow(parameters, problem.setting.observed, simulation_seed(truth.seed, 99, s), no_progress())
              .tree;
      const TreeMetrics m = measure(tree);
      const Tree part = as_observed(tree, problem.setting);
      const std::vector<double> d = describe(part, problem.setting.comparison);
      sum.height += m.height_m / kRegrown;
      sum.seen_height += measure(part).height_m / kRegrown;
      sum.crown += m.crown_diameter_m / kRegrown;
      sum.dbh += m.dbh_m.value_or(0) / kRegrown;
      sum.volume += m.total_volume_m3 / kRegrown;
      sum.cost +=
          metric.cost(Eigen::Map<const Eigen::RowVectorXd>(d.data(), problem.observed.size())) / kRegrown;
      sum.ks += ks.distance(tree) / kRegrown;
    }
    return sum;
  };
  const Judged own = judged(best), floor = judged(truth.parameters);
  Tree stem = truth.tree;
  assign_axes_by_thickness(stem);
  const TreeMetrics m = measure(stem);
  const auto line = [&](const char* key, double value, double estimate) {
    RecoveryLine l;
    l.truth = truth.index;
    l.key = key;
    l.value = value;
    l.estimate = estimate;
    lines.push_back(l);
  };
  line("tree_height_percent", 0, 100 * (own.height / m.height_m - 1));
  line("tree_height_seen_percent", 0, 100 * (own.seen_height / problem.setting.observed.height_m - 1));
  line("tree_crown_percent", 0, 100 * (own.crown / m.crown_diameter_m - 1));
  if (m.dbh_m) line("tree_dbh_percent", 0, 100 * (own.dbh / *m.dbh_m - 1));
  line("tree_volume_percent", 0, 100 * (own.volume / m.total_volume_m3 - 1));
  line("distance", floor.cost, own.cost);
  line("distance_ks", floor.ks, own.ks);
}

}  // namespace

std::vector<RecoveryLine> first_posterior(const Truth& truth, const Tree& seen, const FitOptions& options) {
  FitProblem problem = pose(seen, options);
  SimulationLog log(0);
  const PriorInformation prior = prior_information(problem, log, no_progress());
  if (!prior.from_bank) throw SolverError("the bank cannot be used");
  const PosteriorSample posterior = dendrofit::first_posterior(problem, prior, no_progress());
  const auto rows = problem.space.reported();
  const auto parameters = report_parameters(problem, posterior, truth.parameters);
  std::vector<RecoveryLine> lines;
  for (std::size_t k = 0; k < rows.size(); ++k) {
    RecoveryLine line{truth.index, rows[k].key, truth.parameters.get(rows[k].key)};
    Eigen::VectorXd values(posterior.unit.rows());
    for (Eigen::Index i = 0; i < values.size(); ++i)
      values[i] = problem.space.report(posterior.unit.row(i).transpose(), rows)[static_cast<Eigen::Index>(k)];
    line.estimate = parameters[k].median;
    line.lo = weighted_quantile(values, posterior.weights, 0.05);
    line.hi = weighted_quantile(values, posterior.weights, 0.95);
    line.lo50 = parameters[k].lo50;
    line.hi50 = parameters[k].hi50;
    line.shrinkage = parameters[k].shrinkage;
    for (Eigen::Index i = 0; i < values.size(); ++i)
      if (values[i] < line.value) line.rank += posterior.weights[i];
    lines.push_back(line);
  }
  return lines;
}

std::vector<RecoveryLine> whole_fit(const Truth& truth, const Tree& seen, const FitOptions& options) {
  const TreeFit fit = fit_tree(seen, options);
  std::vector<RecoveryLine> lines;
  for (const FittedParameter& p : fit.parameters) {
    lines.push_back({truth.index, p.key, truth.parameters.get(p.key), p.value, p.lo, p.hi, p.lo50, p.hi50,
                     p.shrinkage, 0.5});
    lines.push_back({truth.index, p.key + "_median", truth.parameters.get(p.key), p.median, p.lo, p.hi,
                     p.lo50, p.hi50, p.shrinkage, 0.5});
  }
  judge_regrown(truth, seen, options, fit.best, lines);
  lines.push_back({truth.index, "cost_over_floor", 1, fit.cost_after / fit.seed_floor});
  lines.push_back({truth.index, "surrogate_kept", 0, fit.refinement.kept ? 1.0 : 0.0});
  lines.push_back({truth.index, "surrogate_gain", 0, fit.refinement.cost_without - fit.refinement.cost_with});
  return lines;
}

std::vector<RecoveryLine> baseline_fit(const std::string& method, const Truth& truth, const Tree& seen,
                                       const FitOptions& options) {
  const FitProblem problem = pose(seen, options);
  const NoiseMetric metric(options.bank->noise.at(problem.level), Eigen::MatrixXd(0, problem.observed.size()),
                           problem.observed, problem.error);
  const ProjectedKs ks(seen, problem.setting.comparison, truth.seed);
  const Eigen::VectorXd found = baseline(method, problem, metric, ks, options.evaluations * options.seeds);
  const IgmParameters best = problem.space.at(found);
  std::vector<RecoveryLine> lines;
  for (const ReportedRow& row : problem.space.reported())
    lines.push_back({truth.index, row.key, truth.parameters.get(row.key), best.get(row.key)});
  judge_regrown(truth, seen, options, best, lines);
  return lines;
}

}  // namespace dendrofit
