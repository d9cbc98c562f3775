// SPDX-License-Identifier: GPL-3.0-or-later
#include "fit/fit_search.h"

#include "fit/cmaes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include <fmt/format.h>

namespace dendrofit {
namespace {

constexpr double kSearchedShrinkage = 0.1;
constexpr double kBeyond = 0.25;       // of the interval's width is searched on either side of it
constexpr double kInitialStep = 0.17;  // of the box: about one posterior sd
constexpr double kSettled = 0.02;
constexpr std::size_t kBestTried = 2;
constexpr std::size_t kNearestDraws = 8;  // of the prior's simulations compete with the posterior's centre
constexpr double kNearKnown = 0.1;        // of a known coordinate's range
constexpr double kBesideStart = 0.05;     // of a coordinate's range is searched beside the start at least
constexpr double kTrusted =
    1.25;  // distance of the best start up to which the posterior is believed as it is
constexpr double kLeastDeviation = 0.03;  // of the posterior, in coordinates' ranges
constexpr std::array kNeverSearched = {"shape", "pipe_exponent", "tip_share", "tau",
                                       "alpha", "sigma",         "b_min",     "b_rise"};

/// sd of a uniform prior on the unit interval
const double kUniform = 1 / std::sqrt(12.0);

/// Points of the simulations of the prior that come nearest, of the equation and the known coordinates
/// searched for; what the search holds is held in them.
UnitPoints nearest_draws(const FitProblem& problem, const PriorInformation& prior,
                         const NoiseMetric& metric) {
  const PriorSimulations& s = prior.simulations;
  const auto& names = SearchSpace::equations();
  const auto equation = std::find(names.begin(), names.end(), problem.space.equation()) - names.begin();
  const Eigen::Index own = static_cast<Eigen::Index>(descriptor_table().size());
  std::vector<std::pair<double, Eigen::Index>> costs;
  for (Eigen::Index i = 0; i < s.unit.rows(); ++i) {
    if (!s.group.empty() && s.group[static_cast<std::size_t>(i)] != equation) continue;
    if (s.known.cols() > 0 &&
        (s.known.row(i).transpose() - prior.observation.known).cwiseAbs().maxCoeff() > kNearKnown)
      continue;
    costs.emplace_back(metric.cost(s.descriptors.row(i).head(own)), i);
  }
  const std::size_t count = std::min(kNearestDraws, costs.size());
  std::partial_sort(costs.begin(), costs.begin() + static_cast<std::ptrdiff_t>(count), costs.end());
  UnitPoints points;
  for (std::size_t k = 0; k < count; ++k) {
    points.emplace_back(s.unit.row(costs[k].second).transpose());
    for (const auto& [key, unit] : problem.options.held) points.back()[problem.space.row(key)] = unit;
  }
  return points;
}

}  // namespace

Eigen::VectorXd SearchBox::full(const Eigen::VectorXd& inner) const {
  Eigen::VectorXd point = elsewhere;
  for (std::size_t k = 0; k < rows.size(); ++k) {
    const auto i = static_cast<Eigen::Index>(k);
    point[rows[k]] = lo[i] + inner[i] * (hi[i] - lo[i]);
  }
  return point;
}

Eigen::VectorXd SearchBox::inner(const Eigen::VectorXd& full) const {
  Eigen::VectorXd point(lo.size());
  for (std::size_t k = 0; k < rows.size(); ++k) {
    const auto i = static_cast<Eigen::Index>(k);
    point[i] = std::clamp((full[rows[k]] - lo[i]) / (hi[i] - lo[i]), 0.0, 1.0);
  }
  return point;
}

PosteriorSample first_posterior(const FitProblem& problem, const PriorInformation& prior,
                                Progress& progress) {
  PosteriorSample posterior = regression_posterior(prior.simulations, prior.observation);
  if (!prior.from_bank || !problem.options.thinnest_wood_m || posterior.is_prior) return posterior;
  return regression_posterior(
      prior.simulations,
      as_whole(problem, prior.observation, search_box(problem, posterior).elsewhere, progress));
}

SearchBox search_box(const FitProblem& problem, const PosteriorSample& posterior) {
  SearchBox box;
  box.elsewhere = Eigen::VectorXd::Constant(problem.space.size(), 0.5);
  box.deviation = Eigen::VectorXd::Constant(problem.space.size(), HUGE_VAL);
  std::vector<double> lo, hi;
  for (Eigen::Index i = 0; i < problem.space.size(); ++i) {
    const std::string_view key = problem.space.rows()[static_cast<std::size_t>(i)].key;
    const Eigen::VectorXd values = posterior.unit.col(i);
    if (!posterior.is_prior) box.elsewhere[i] = weighted_quantile(values, posterior.weights, 0.5);
    if (const auto held = problem.options.held.find(std::string(key)); held != problem.options.held.end()) {
      box.elsewhere[i] = held->second;
      continue;
    }
    if (problem.space.fixed(i)) continue;
    const double sd = weighted_deviation(values, posterior.weights);
    if (!posterior.is_prior) box.deviation[i] = std::max(kLeastDeviation, sd);
    const bool never = std::find(kNeverSearched.begin(), kNeverSearched.end(), key) != kNeverSearched.end();
    if (never) continue;
    if (!posterior.is_prior && key != "size" && sd > (1 - kSearchedShrinkage) * kUniform) continue;
    double from = 0, to = 1;
    if (!posterior.is_prior) {
      from = weighted_quantile(values, posterior.weights, 0.01);
      to = weighted_quantile(values, posterior.weights, 0.99);
      const double more = std::max(0.02, kBeyond * (to - from));
      from = std::max(0.0, from - more);
      to = std::min(1.0, to + more);
    }
    box.rows.push_back(i);
    lo.push_back(from);
    hi.push_back(to);
  }
  box.lo = Eigen::Map<const Eigen::VectorXd>(lo.data(), static_cast<Eigen::Index>(lo.size()));
  box.hi = Eigen::Map<const Eigen::VectorXd>(hi.data(), static_cast<Eigen::Index>(hi.size()));
  box.centre = box.elsewhere;
  return box;
}

double SearchBox::improbability(const Eigen::VectorXd& point) const {
  return ((point - centre).array() / deviation.array()).unaryExpr(&huber).sum() / doubt;
}

double search_cost(double distance, const Eigen::VectorXd& point, const SearchBox& box,
                   const NoiseMetric& metric) {
  return distance + box.improbability(point) / static_cast<double>(metric.used().size());
}

void SearchBox::start_at(const Eigen::VectorXd& point) {
  elsewhere = point;
  for (std::size_t k = 0; k < rows.size(); ++k) {
    const auto i = static_cast<Eigen::Index>(k);
    lo[i] = std::min(lo[i], std::max(0.0, point[rows[k]] - kBesideStart));
    hi[i] = std::max(hi[i], std::min(1.0, point[rows[k]] + kBesideStart));
  }
}

Eigen::VectorXd best_start(const FitProblem& problem, const PriorInformation& prior,
                           const NoiseMetric& metric, SearchBox& box, SimulationLog& log,
                           std::vector<Tried>& tried, TreeFit& fit, Progress& progress) {
  const auto left = static_cast<std::size_t>(std::max(0, problem.options.evaluations - fit.evaluations));
  UnitPoints starts = {box.elsewhere};
  for (const Eigen::VectorXd& draw : nearest_draws(problem, prior, metric)) starts.push_back(draw);
  starts.resize(std::min(starts.size(), left));
  if (starts.empty()) return box.elsewhere;
  progress.begin("choosing where to start", static_cast<double>(starts.size()), "sets");
  const auto key = kSearchKeys + static_cast<std::uint64_t>(fit.evaluations);
  const Eigen::MatrixXd rows = problem.run(starts, problem.options.seeds, key, log, progress);
  progress.end();
  double nearest = HUGE_VAL;
  for (std::size_t p = 0; p < starts.size(); ++p)
    nearest =
        std::min(nearest, metric.cost(rows.middleRows(static_cast<Eigen::Index>(p) * problem.options.seeds,
                                                      problem.options.seeds)));
  box.doubt = std::max(1.0, std::pow(nearest / kTrusted, 2));
  const std::vector<double> costs = note(starts, rows, problem.options.seeds, metric, box, tried, fit);
  return starts[static_cast<std::size_t>(std::min_element(costs.begin(), costs.end()) - costs.begin())];
}

std::vector<double> note(const UnitPoints& points, const Eigen::MatrixXd& rows, int seeds,
                         const NoiseMetric& metric, const SearchBox& box, std::vector<Tried>& tried,
                         TreeFit& fit) {
  std::vector<double> costs;
  for (std::size_t p = 0; p < points.size(); ++p) {
    const Eigen::MatrixXd own = rows.middleRows(static_cast<Eigen::Index>(p) * seeds, seeds);
    const double distance = metric.cost(own);
    costs.push_back(search_cost(distance, points[p], box, metric));
    tried.push_back({points[p], own.colwise().mean().transpose(), costs.back()});
    fit.cost_history.push_back(
        std::min(distance, fit.cost_history.empty() ? distance : fit.cost_history.back()));
  }
  fit.evaluations += static_cast<int>(points.size());
  return costs;
}

Eigen::VectorXd search(const FitProblem& problem, const NoiseMetric& metric, const SearchBox& box,
                       SimulationLog& log, std::vector<Tried>& tried, TreeFit& fit, Progress& progress) {
  const FitOptions& options = problem.options;
  Cmaes cmaes(box.inner(box.elsewhere), {.initial_step = kInitialStep, .seed = options.seed});
  progress.begin("searching parameters", std::max(0, options.evaluations - fit.evaluations), "sets");
  fit.stop_reason = fmt::format("the budget of {} parameter sets is spent", options.evaluations);
  while (fit.evaluations + cmaes.population() <= options.evaluations) {
    if (problem.out_of_time(log)) {
      fit.stop_reason = fmt::format("the time of {} s is spent", *options.seconds);
      break;
    }
    UnitPoints generation;
    for (const Eigen::VectorXd& inner : cmaes.ask()) generation.push_back(box.full(inner));
    const auto key = kSearchKeys + static_cast<std::uint64_t>(fit.evaluations);
    const Eigen::MatrixXd rows = problem.run(generation, options.seeds, key, log, progress);
    cmaes.tell(note(generation, rows, options.seeds, metric, box, tried, fit));
    if (options.on_checkpoint) options.on_checkpoint(log.bytes(problem.seconds(log)));
    progress.remark(fmt::format("distance {:.2f}", fit.cost_history.back()));
    if (cmaes.converged(kSettled)) {
      fit.converged = true;
      fit.stop_reason = "the search has settled: its steps are below 2 % of every range";
      break;
    }
  }
  progress.end();
  return box.full(cmaes.mean());
}

Judged judge(const FitProblem& problem, const NoiseMetric& metric, const SearchBox& box, UnitPoints finalists,
             std::vector<Tried> tried, std::uint64_t first_key, SimulationLog& log, Progress& progress) {
  std::stable_sort(tried.begin(), tried.end(),
                   [](const Tried& a, const Tried& b) { return a.cost < b.cost; });
  for (std::size_t i = 0; i < std::min(kBestTried, tried.size()); ++i) finalists.push_back(tried[i].point);
  progress.begin("judging on fresh seeds", static_cast<double>(finalists.size()), "sets");
  const Eigen::MatrixXd rows = problem.run(finalists, kJudgingSeeds, first_key, log, progress);
  progress.end();
  Judged best;
  for (std::size_t i = 0; i < finalists.size(); ++i) {
    const Eigen::MatrixXd own = rows.middleRows(static_cast<Eigen::Index>(i) * kJudgingSeeds, kJudgingSeeds);
    const double distance = metric.cost(own), cost = search_cost(distance, finalists[i], box, metric);
    if (i == 0 || cost < best.cost)
      best = {finalists[i], own, distance, cost, first_key + i, problem.setting.observed.internode_length_m};
  }
  return best;
}

double seed_floor(const Eigen::MatrixXd& simulations, const NoiseMetric& metric) {
  double sum = 0;
  for (Eigen::Index i = 0; i < simulations.rows(); ++i) {
    Eigen::MatrixXd others(simulations.rows() - 1, simulations.cols());
    others << simulations.topRows(i), simulations.bottomRows(simulations.rows() - 1 - i);
    sum += metric.cost(others, simulations.row(i).transpose());
  }
  return sum / static_cast<double>(simulations.rows());
}

}  // namespace dendrofit
