// SPDX-License-Identifier: GPL-3.0-or-later
#include "fit/fit_tree.h"

#include "core/errors.h"
#include "core/random.h"
#include "fit/cmaes.h"
#include "fit/noise_metric.h"
#include "fit/regression_posterior.h"
#include "fit/search_space.h"
#include "fit/tree_simulator.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numeric>

#include <fmt/format.h>

namespace dendrofit {
namespace {

constexpr int kLargestBank = 240;
constexpr int kJudgingSeeds = 8;
constexpr int kNoiseSeeds = 24;
constexpr double kIdentifiableShrinkage = 0.3;
constexpr double kOldestYearly = 30;  // older trees: a cycle is several years
constexpr double kCyclesOfOldTrees = 24;
constexpr double kPoorCost = 4;  // 2 sd a descriptor
// First keys of the three kinds of evaluation, so that no two share a seed.
constexpr std::uint64_t kBankKeys = 0;
constexpr std::uint64_t kSearchKeys = 1'000'000;
constexpr std::uint64_t kJudgingKeys = 2'000'000;
constexpr std::uint64_t kStartKeys = 3'000'000;

using Points = std::vector<Eigen::VectorXd>;

struct Tried {
  Eigen::VectorXd point;
  double cost = 0;
};

/// What every step of one fit shares.
struct Problem {
  const FitOptions& options;
  DirectEstimates direct;
  SearchSpace space;
  DescribeOptions comparison;
  Eigen::VectorXd observed;
  std::chrono::steady_clock::time_point started = std::chrono::steady_clock::now();

  Eigen::MatrixXd run(const Points& points, int seeds, std::uint64_t first_key, Progress& progress) const {
    return simulate(points, space, direct, comparison, seeds, options.seed, first_key, options.threads,
                    progress);
  }
  bool out_of_time() const {
    const std::chrono::duration<double> spent = std::chrono::steady_clock::now() - started;
    return options.seconds && spent.count() > *options.seconds;
  }
};

/// Both trees are compared on wood that a scan of a tree this tall shows reliably.
DescribeOptions comparison_for(double height_m) {
  return {.visible_radius_m = std::clamp(0.0008 * height_m, 0.004, 0.02),
          .shortest_axis_m = std::clamp(0.03 * height_m, 0.1, 0.5)};
}

double years_per_cycle(const FitOptions& options) {
  if (!options.age_years || *options.age_years <= kOldestYearly) return 1;
  return *options.age_years / kCyclesOfOldTrees;
}

std::optional<int> known_cycles(const FitOptions& options) {
  if (!options.age_years) return {};
  return static_cast<int>(std::lround(*options.age_years / years_per_cycle(options)));
}

Eigen::VectorXd to_vector(const std::vector<double>& values) {
  return Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size()));
}

/// Latin hypercube sample of the unit box.
Points latin_hypercube(int count, Eigen::Index dimensions, std::uint64_t seed) {
  Points points(static_cast<std::size_t>(count), Eigen::VectorXd(dimensions));
  for (Eigen::Index d = 0; d < dimensions; ++d) {
    Random random = Random(seed).child({0x1a7, static_cast<std::uint64_t>(d)});
    std::vector<int> stratum(static_cast<std::size_t>(count));
    std::iota(stratum.begin(), stratum.end(), 0);
    for (std::size_t i = stratum.size(); i > 1; --i) std::swap(stratum[i - 1], stratum[random.below(i)]);
    for (std::size_t i = 0; i < points.size(); ++i) points[i][d] = (stratum[i] + random.uniform()) / count;
  }
  return points;
}

Eigen::MatrixXd as_rows(const Points& points) {
  Eigen::MatrixXd rows(static_cast<Eigen::Index>(points.size()), points.empty() ? 0 : points.front().size());
  for (std::size_t i = 0; i < points.size(); ++i)
    rows.row(static_cast<Eigen::Index>(i)) = points[i].transpose();
  return rows;
}

/// Costs of points whose simulations stand in `rows`, `seeds` rows a point.
std::vector<double> costs_of(const Eigen::MatrixXd& rows, int seeds, const NoiseMetric& metric) {
  std::vector<double> costs;
  for (Eigen::Index first = 0; first < rows.rows(); first += seeds)
    costs.push_back(metric.cost(rows.middleRows(first, seeds)));
  return costs;
}

std::vector<Tried> with_costs(const Points& points, const std::vector<double>& costs) {
  std::vector<Tried> tried;
  for (std::size_t i = 0; i < points.size(); ++i) tried.push_back({points[i], costs[i]});
  return tried;
}

void remember(const Points& points, const std::vector<double>& costs, std::vector<Tried>& tried,
              TreeFit& fit) {
  for (const Tried& one : with_costs(points, costs)) {
    tried.push_back(one);
    fit.cost_history.push_back(
        std::min(one.cost, fit.cost_history.empty() ? one.cost : fit.cost_history.back()));
  }
  fit.evaluations += static_cast<int>(points.size());
}

/// CMA-ES from `start` until the budget, the time or the search itself ends.
Eigen::VectorXd search(const Problem& problem, const NoiseMetric& metric, const Eigen::VectorXd& start,
                       std::vector<Tried>& tried, TreeFit& fit, Progress& progress) {
  Cmaes cmaes(start, {.initial_step = 0.18, .seed = problem.options.seed});
  const int budget = problem.options.evaluations;
  progress.begin("searching parameters", std::max(0, budget - fit.evaluations), "trees");
  fit.stop_reason = fmt::format("the budget of {} parameter sets is spent", budget);
  while (fit.evaluations + cmaes.population() <= budget) {
    if (problem.out_of_time()) {
      fit.stop_reason = fmt::format("the time of {} s is spent", *problem.options.seconds);
      break;
    }
    const Points& generation = cmaes.ask();
    const auto key = kSearchKeys + static_cast<std::uint64_t>(fit.evaluations);
    const auto costs = costs_of(problem.run(generation, problem.options.seeds, key, progress),
                                problem.options.seeds, metric);
    remember(generation, costs, tried, fit);
    cmaes.tell(costs);
    progress.remark(fmt::format("distance {:.2f}", fit.cost_history.back()));
    if (cmaes.converged(0.02)) {
      fit.converged = true;
      fit.stop_reason = "the search has settled: its steps are below 2 % of every range";
      break;
    }
  }
  progress.end();
  return cmaes.mean();
}

/// The finalists: the search's centre, the posterior's and the best few tried, judged on fresh seeds, since
/// the best of many noisy costs is partly luck.
struct Judged {
  Eigen::VectorXd point;
  Eigen::MatrixXd simulations;
  double cost = 0;
  std::uint64_t key = 0;
  double internode_length_m = 0;
};

Judged judge(const Problem& problem, const NoiseMetric& metric, Points finalists, std::vector<Tried> tried,
             std::uint64_t first_key, Progress& progress) {
  std::stable_sort(tried.begin(), tried.end(),
                   [](const Tried& a, const Tried& b) { return a.cost < b.cost; });
  for (std::size_t i = 0; i < std::min<std::size_t>(3, tried.size()); ++i)
    finalists.push_back(tried[i].point);
  progress.begin("judging on fresh seeds", static_cast<double>(finalists.size()), "trees");
  const Eigen::MatrixXd rows = problem.run(finalists, kJudgingSeeds, first_key, progress);
  progress.end();
  const auto costs = costs_of(rows, kJudgingSeeds, metric);
  const auto best = static_cast<std::size_t>(std::min_element(costs.begin(), costs.end()) - costs.begin());
  return {finalists[best], rows.middleRows(static_cast<Eigen::Index>(best) * kJudgingSeeds, kJudgingSeeds),
          costs[best], first_key + best, problem.direct.internode_length_m};
}

/// Internode length is a convention unless it was given: one that brings the trees to the observed height is
/// taken where it brings them nearer as a whole.
Judged settle_scale(const Problem& problem, const NoiseMetric& metric, Judged best, Progress& progress) {
  best.internode_length_m = problem.direct.internode_length_m;
  if (problem.options.internode_length_m) return best;
  double height = 0;  // descriptor 0 is the logarithm of the height
  for (const double log_height : best.simulations.col(0)) height += std::exp(log_height) / kJudgingSeeds;
  const double ratio = std::clamp(problem.direct.height_m / height, 0.6, 1.6);
  Problem scaled = problem;
  scaled.space = problem.space.rescaled(problem.direct.internode_length_m * ratio);
  const Eigen::MatrixXd simulations = scaled.run({best.point}, kJudgingSeeds, best.key, progress);
  const double cost = metric.cost(simulations);
  if (cost >= best.cost) return best;
  return {best.point, simulations, cost, best.key, problem.direct.internode_length_m * ratio};
}

/// Mean distance of each of the trees from the others: what no parameter set can get below.
double seed_floor(const Eigen::MatrixXd& simulations, const NoiseMetric& metric) {
  double sum = 0;
  for (Eigen::Index i = 0; i < simulations.rows(); ++i) {
    Eigen::MatrixXd others(simulations.rows() - 1, simulations.cols());
    others << simulations.topRows(i), simulations.bottomRows(simulations.rows() - 1 - i);
    sum += metric.cost(others, simulations.row(i).transpose());
  }
  return sum / static_cast<double>(simulations.rows());
}

int nearest_simulation(const Eigen::MatrixXd& simulations, const NoiseMetric& metric) {
  int best = 0;
  for (int i = 1; i < simulations.rows(); ++i)
    if (metric.cost(simulations.row(i)) < metric.cost(simulations.row(best))) best = i;
  return best;
}

std::vector<FittedParameter> report_parameters(const SearchSpace& space, const IgmParameters& best,
                                               const std::vector<UnitPosterior>& posterior) {
  const std::vector<ParameterSpec> table = igm_parameter_table(best.equation);
  std::vector<FittedParameter> report;
  for (Eigen::Index i = 0; i < space.size(); ++i) {
    const SearchRow& row = space.rows()[static_cast<std::size_t>(i)];
    const UnitPosterior& p = posterior[static_cast<std::size_t>(i)];
    const auto spec =
        std::find_if(table.begin(), table.end(), [&](const ParameterSpec& s) { return s.key == row.key; });
    FittedParameter fitted;
    fitted.key = row.key;
    fitted.unit = spec->unit;
    fitted.meaning = spec->meaning;
    fitted.value = best.get(row.key);
    fitted.prior_lo = row.lo;
    fitted.prior_hi = row.hi;
    fitted.shrinkage = p.shrinkage;
    fitted.identifiable = p.shrinkage >= kIdentifiableShrinkage;
    fitted.lo = std::min(fitted.value, space.value(i, p.lo));
    fitted.hi = std::max(fitted.value, space.value(i, p.hi));
    report.push_back(fitted);
  }
  return report;
}

std::vector<DescriptorFit> report_descriptors(const Problem& problem, const NoiseMetric& metric,
                                              const Eigen::MatrixXd& before, const Eigen::MatrixXd& after) {
  std::vector<DescriptorFit> report;
  for (const Eigen::Index j : metric.used()) {
    const DescriptorRow& row = descriptor_table()[static_cast<std::size_t>(j)];
    report.push_back({std::string(row.name), std::string(row.unit), problem.observed[j], before.col(j).mean(),
                      after.col(j).mean(), metric.noise(j)});
  }
  return report;
}

void warn(const Problem& problem, const NoiseMetric& metric, TreeFit& fit, std::size_t bank) {
  if (bank < 30)
    fit.warnings.push_back(
        fmt::format("a budget of {} parameter sets is too small to tell what the scan says of each "
                    "parameter; 100 or more give intervals",
                    problem.options.evaluations));
  if (metric.used().size() < descriptor_table().size() / 2)
    fit.warnings.emplace_back(
        "the tree has hardly any branches that can be compared: parameters of branching cannot be told from "
        "it");
  if (fit.cost_after > kPoorCost) {
    auto worst = fit.descriptors;
    std::stable_sort(worst.begin(), worst.end(), [](const DescriptorFit& a, const DescriptorFit& b) {
      return std::abs(a.after - a.observed) / a.noise > std::abs(b.after - b.observed) / b.noise;
    });
    std::string names;
    for (std::size_t i = 0; i < std::min<std::size_t>(3, worst.size()); ++i)
      names += (i ? ", " : "") + worst[i].name;
    fit.warnings.push_back("the growth model cannot follow this tree: even the best parameters miss its " +
                           names + "; take the parameters as a description, not as measurements");
  }
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
}

TreeFit fit_tree(const Tree& observed, const FitOptions& options, Progress& progress) {
  options.validate();
  observed.validate();
  const DirectEstimates direct = estimate_directly(observed, options.internode_length_m);
  const DescribeOptions comparison = comparison_for(direct.height_m);
  const Problem problem{options, direct, SearchSpace(direct, options.equation, known_cycles(options)),
                        comparison, to_vector(describe(observed, comparison))};

  TreeFit fit;
  fit.seed = options.seed;
  fit.comparison = comparison;
  fit.age_known = options.age_years.has_value();
  fit.years_per_cycle = years_per_cycle(options);

  // A bank of simulations from the prior: the noise metric and a first posterior.
  const Eigen::Index dimensions = problem.space.size();
  const int bank_size = std::clamp(options.evaluations / 2, 1, kLargestBank);
  const Points bank = latin_hypercube(bank_size, dimensions, options.seed);
  progress.begin("simulating the prior", bank_size, "trees");
  const Eigen::MatrixXd simulated = problem.run(bank, 1, kBankKeys, progress);
  progress.end();
  const Eigen::MatrixXd bank_points = as_rows(bank);
  const NoiseMetric wide(bank_points, simulated, problem.observed);
  const auto posterior = regression_posterior(bank_points, wide.whiten(simulated), wide.whitened_observed());
  Eigen::VectorXd centre(dimensions);
  for (Eigen::Index i = 0; i < dimensions; ++i) centre[i] = posterior[static_cast<std::size_t>(i)].median;

  // The search starts from the better of the posterior's centre and the bank's best, and counts distances in
  // the noise between seeds that trees there show.
  const Judged start =
      judge(problem, wide, {centre}, with_costs(bank, costs_of(simulated, 1, wide)), kStartKeys, progress);
  const Eigen::MatrixXd replicates = problem.run({start.point}, kNoiseSeeds, kStartKeys + 100, progress);
  const NoiseMetric metric(Eigen::MatrixXd(kNoiseSeeds, 0), replicates, problem.observed, &wide);
  std::vector<Tried> tried;
  remember(bank, costs_of(simulated, 1, metric), tried, fit);
  const Eigen::VectorXd found = search(problem, metric, start.point, tried, fit, progress);

  // Both ends on fresh seeds.
  const Eigen::MatrixXd before =
      problem.run({Eigen::VectorXd::Constant(dimensions, 0.5)}, kJudgingSeeds, kJudgingKeys, progress);
  const Judged best =
      settle_scale(problem, metric,
                   judge(problem, metric, {found, start.point}, tried, kJudgingKeys + 1, progress), progress);
  const int nearest = nearest_simulation(best.simulations, metric);

  fit.best = problem.space.rescaled(best.internode_length_m).at(best.point);
  fit.best_seed = simulation_seed(options.seed, best.key, nearest);
  fit.best.tip_radius_m = regrow(fit.best, direct, fit.best_seed, progress).tip_radius_m;
  fit.cost_before = metric.cost(before);
  fit.cost_after = best.cost;
  fit.seed_floor = seed_floor(best.simulations, metric);
  fit.parameters = report_parameters(problem.space, fit.best, posterior);
  fit.descriptors = report_descriptors(problem, metric, before, best.simulations);
  warn(problem, metric, fit, bank.size());
  return fit;
}

}  // namespace dendrofit
