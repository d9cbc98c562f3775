// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/metrics.h"
#include "core/parallel.h"
#include "fit/fit_search.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace dendrofit {
namespace {

constexpr int kShowingSeeds = 16;     // the tree of one of so many is shown
constexpr double kShownMeasures = 4;  // what people look for in the one tree shown counts for so much
constexpr int kSizeSteps = 2;
// Relative errors that count as much as one standard deviation of a descriptor.
constexpr double kHeightError = 0.02, kDiameterError = 0.02, kVolumeError = 0.05, kCrownError = 0.05;
constexpr double kMeanHeightError = 0.01;

/// A grown tree whose radii are yet to be settled. In the pipe model r^v = n tip^v with n tips beyond.
struct Shown {
  Tree tree;
  std::uint64_t seed = 0;
  double internode_length_m = 0;
  std::vector<double> log_pipes;  ///< of each node: log n
  double log_stem_pipes = 0;      ///< where diameters are compared
  double observed_diameter_m = 0;
};

double mean(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

double square(double x) {
  return x * x;
}

/// Squared relative error in units of `unit`; 0 where either tree lacks the measure.
double misfit(double grown, double observed, double unit) {
  return grown > 0 && observed > 0 ? square(std::log(grown / observed) / unit) : 0;
}

void scale(Tree& tree, double ratio) {
  for (Vec3& p : tree.start) p *= ratio;
  for (Vec3& p : tree.end) p *= ratio;
  for (double& r : tree.radius) r *= ratio;
}

/// The tree of one seed, as tall as the observed one unless the internode length is given.
Shown grow_shown(const FitProblem& problem, const IgmParameters& parameters, std::uint64_t seed) {
  const DirectEstimates& observed = problem.setting.observed;
  Regrown grown = regrow(parameters, observed, seed, no_progress());
  Shown shown{std::move(grown.tree), seed, parameters.rho_m, {}, 0, 0};
  if (!problem.options.internode_length_m) {
    const double height = measure(as_observed(shown.tree, problem.setting)).height_m;
    const double ratio = std::clamp(observed.height_m / height, 0.25, 4.0);
    if (std::isfinite(ratio)) {
      scale(shown.tree, ratio);
      shown.internode_length_m *= ratio;
      grown.tip_radius_m *= ratio;
    }
  }
  const auto log_pipes = [&](double radius) {
    return parameters.pipe_exponent * std::log(radius / grown.tip_radius_m);
  };
  for (const double radius : shown.tree.radius) shown.log_pipes.push_back(log_pipes(radius));
  const ComparedDiameters diameters = compared_diameters(shown.tree, observed);
  shown.log_stem_pipes = log_pipes(0.5 * diameters.grown);
  shown.observed_diameter_m = diameters.observed;
  return shown;
}

/// The tip radius that gives the observed diameter under pipe exponent `v`, as far as tips can be so thick.
double tip_radius(const Shown& shown, double v) {
  return possible_tip_radius(0.5 * shown.observed_diameter_m / std::exp(shown.log_stem_pipes / v),
                             shown.internode_length_m);
}

/// Distance and misfits of the measures, `weight` times, together, in standard deviations squared.
double unlikeness(const FitProblem& problem, const NoiseMetric& metric, Shown& shown, double v,
                  double weight) {
  const double tip = tip_radius(shown, v);
  for (std::size_t i = 0; i < shown.tree.size(); ++i)
    shown.tree.radius[i] = tip * std::exp(shown.log_pipes[i] / v);
  const DirectEstimates& observed = problem.setting.observed;
  const std::vector<double> row =
      describe_as_observed(shown.tree, shown.internode_length_m, problem.setting, shown.seed);
  const TreeMetrics m = measure(as_observed(shown.tree, problem.setting));
  const auto used = static_cast<double>(metric.used().size());
  const double measures =
      misfit(m.height_m, observed.height_m, kHeightError) +
      misfit(2 * tip * std::exp(shown.log_stem_pipes / v), shown.observed_diameter_m, kDiameterError) +
      misfit(m.total_volume_m3, observed.total_volume_m3, kVolumeError) +
      misfit(m.crown_diameter_m, observed.crown_diameter_m, kCrownError);
  return used * metric.cost(Eigen::Map<const Eigen::RowVectorXd>(row.data(), problem.observed.size())) +
         weight * measures;
}

/// unlikeness() of every tree.
std::vector<double> unlikeness_of(const FitProblem& problem, const NoiseMetric& metric,
                                  std::vector<Shown>& trees, double v, Progress& progress,
                                  double weight = 1) {
  std::vector<double> costs(trees.size());
  parallel_blocks(trees.size(), 1, problem.options.threads, [&](std::size_t s, std::size_t) {
    progress.check();
    costs[s] = unlikeness(problem, metric, trees[s], v, weight);
  });
  return costs;
}

/// The pipe exponent (unit box) at which the trees are on average least unlike the observed one, weighed
/// against what the posterior says of it: from `unit` downhill in halving steps.
double settle_exponent(const FitProblem& problem, const NoiseMetric& metric, const SearchBox& box,
                       double unit, std::vector<Shown>& trees, Progress& progress) {
  if (problem.options.held.count("pipe_exponent")) return unit;
  const Eigen::Index row = problem.space.row("pipe_exponent");
  const auto cost = [&](double u) {
    const std::vector<double> costs =
        unlikeness_of(problem, metric, trees, problem.space.value(row, u), progress);
    return mean(costs) + huber((u - box.centre[row]) / box.deviation[row]) / box.doubt;
  };
  double least = cost(unit);
  for (const double step : {0.16, 0.08, 0.04, 0.02})
    for (const double sign : {-1.0, 1.0})
      for (;;) {
        const double next = std::clamp(unit + sign * step, 0.0, 1.0);
        const double value = next == unit ? least : cost(next);
        if (!(value < least)) break;
        unit = next;
        least = value;
      }
  return unit;
}

std::vector<Shown> grow_all(const FitProblem& problem, const Eigen::VectorXd& point, std::uint64_t key,
                            Progress& progress) {
  std::vector<Shown> trees(kShowingSeeds);
  const IgmParameters parameters = problem.space.at(point);
  progress.begin("choosing the tree to show", kShowingSeeds, "trees");
  parallel_blocks(trees.size(), 1, problem.options.threads, [&](std::size_t s, std::size_t) {
    progress.check();
    trees[s] =
        grow_shown(problem, parameters, simulation_seed(problem.options.seed, key, static_cast<int>(s)));
    progress.advance(1);
  });
  progress.end();
  return trees;
}

/// Logarithm of the observed height over the trees' on average.
double height_off(const FitProblem& problem, const std::vector<Shown>& trees) {
  std::vector<double> off;
  off.reserve(trees.size());
  for (const Shown& shown : trees)
    off.push_back(std::log(problem.setting.observed.height_m /
                           measure(as_observed(shown.tree, problem.setting)).height_m));
  return mean(off);
}

/// Where the internode length is given, trees have the observed height only by their number of internodes:
/// the size at the end of growth is moved by what their heights are off on average, as long as the trees with
/// their mean height (whose error a scan makes is a hundredth) are then less unlike the observed one.
void settle_size(const FitProblem& problem, const NoiseMetric& metric, Judged& best,
                 std::vector<Shown>& trees, Progress& progress) {
  const Eigen::Index size = problem.space.row("size"), exponent = problem.space.row("pipe_exponent");
  if (!problem.options.internode_length_m || problem.options.held.count("size")) return;
  const double v = problem.space.value(exponent, best.point[exponent]);
  const auto cost = [&](std::vector<Shown>& list) {
    return mean(unlikeness_of(problem, metric, list, v, progress)) +
           square(height_off(problem, list) / kMeanHeightError);
  };
  double least = cost(trees);
  for (int step = 0; step < kSizeSteps && std::isfinite(height_off(problem, trees)); ++step) {
    Eigen::VectorXd moved = best.point;
    moved[size] = problem.space.unit(
        size, problem.space.value(size, moved[size]) * std::exp(height_off(problem, trees)));
    std::vector<Shown> others = grow_all(problem, moved, best.key, progress);
    const double value = cost(others);
    if (!(value < least)) return;
    least = value;
    best.point = moved;
    trees = std::move(others);
  }
}

}  // namespace

Judged settle_tree(const FitProblem& problem, const NoiseMetric& metric, const SearchBox& box, Judged best,
                   Progress& progress) {
  const SimulationSetting& setting = problem.setting;
  std::vector<Shown> trees = grow_all(problem, best.point, best.key, progress);
  settle_size(problem, metric, best, trees, progress);
  const Eigen::Index row = problem.space.row("pipe_exponent");
  best.point[row] = settle_exponent(problem, metric, box, best.point[row], trees, progress);
  const std::vector<double> costs = unlikeness_of(
      problem, metric, trees, problem.space.value(row, best.point[row]), progress, kShownMeasures);
  best.shown = static_cast<int>(std::min_element(costs.begin(), costs.end()) - costs.begin());
  best.internode_length_m = trees[static_cast<std::size_t>(best.shown)].internode_length_m;

  // The distance of the whole, its radii and scale settled: shapes do not depend on the internode length, but
  // the diameter at 1.3 m, and so the radii, do.
  FitProblem settled = problem;
  settled.space.set_internode_length(best.internode_length_m);
  SimulationLog own(0);  // other trees under the same keys
  best.simulations = settled.run({best.point}, kJudgingSeeds, best.key, own, progress);
  const auto internodes = static_cast<Eigen::Index>(descriptor_row("internodes"));
  best.simulations.col(internodes).array() +=
      std::log(best.internode_length_m / setting.observed.internode_length_m);
  best.distance = metric.cost(best.simulations);
  return best;
}

}  // namespace dendrofit
