// SPDX-License-Identifier: GPL-3.0-or-later
#include "fit/growth_optimum.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace dendrofit {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

bool same_minimum(const GrowthSolution& a, const GrowthSolution& b) {
  return std::abs(a.rss - b.rss) <= 1e-6 * std::max(a.rss, b.rss) || (a.c - b.c).cwiseAbs().maxCoeff() < 1e-3;
}

// A robust loss has many minima. Two further ways down: from the least-squares curve with the loss's scale
// narrowed step by step (graduated non-convexity), and from the lowest minima a little aside in each
// coordinate.
void search_on_robustly(const GrowthProblem& problem, const GrowthOptions& options,
                        std::vector<GrowthSolution>& found) {
  const auto lower = [](const GrowthSolution& a, const GrowthSolution& b) { return a.rss < b.rss; };
  const auto solve = [&](const GrowthVector& c, double scale) {
    return minimize_robustly(problem, c, options.loss, scale);
  };
  std::vector<GrowthSolution> wide;
  wide.reserve(found.size());
  for (const GrowthSolution& solution : found)
    wide.push_back(minimize_directly(problem, solution.c, 80, 1e-6));
  const GrowthSolution squares = *std::min_element(wide.begin(), wide.end(), lower);
  GrowthVector c = squares.c;
  for (double factor = 64; factor >= 1; factor /= 1.3) c = solve(c, factor * options.loss_scale).c;
  found.push_back(solve(c, options.loss_scale));
  found.push_back(solve(squares.c, options.loss_scale));
  for (int round = 0; round < 6; ++round) {
    const GrowthSolution best = *std::min_element(found.begin(), found.end(), lower);
    Eigen::VectorXd residuals;
    Eigen::MatrixXd jacobian;
    if (!problem.evaluate(best.c, residuals, &jacobian)) return;
    bool fell = false;
    for (int i = 0; i < problem.curve->size(); ++i)
      for (double steps : {-2.0, -1.0, -0.5, 0.5, 1.0, 2.0}) {
        if (problem.held[i]) continue;
        GrowthVector aside = best.c;
        // One step moves the curve by the loss's scale at a typical measurement.
        aside[i] += steps * options.loss_scale * std::sqrt(static_cast<double>(residuals.size())) /
                    std::max(jacobian.col(i).norm(), 1e-300);
        aside[i] = std::clamp(aside[i], problem.lo[i], problem.hi[i]);
        found.push_back(solve(aside, options.loss_scale));
        fell |= found.back().rss < best.rss * (1 - 1e-9);
      }
    if (!fell) return;
  }
}

}  // namespace

std::optional<GrowthOptimum> find_growth_optimum(const GrowthProblem& problem,
                                                 const std::vector<GrowthVector>& starts,
                                                 const GrowthOptions& options) {
  std::vector<GrowthSolution> found;
  for (const GrowthVector& natural : starts) {
    const GrowthVector c = problem.curve->to_chart(problem.chart, natural);
    if (!c.allFinite() || !std::isfinite(problem.rss(c))) continue;
    found.push_back(options.loss == GrowthLoss::none
                        ? minimize_directly(problem, c, options.automatic_starts ? 80 : 500, 1e-6)
                        : minimize_robustly(problem, c, options.loss, options.loss_scale));
  }
  if (found.empty()) return std::nullopt;
  if (options.loss != GrowthLoss::none) search_on_robustly(problem, options, found);
  std::stable_sort(found.begin(), found.end(), [](const auto& a, const auto& b) { return a.rss < b.rss; });
  GrowthOptimum optimum{found.front(), std::nullopt};
  if (options.loss == GrowthLoss::none) optimum.best = minimize_to_the_end(problem, optimum.best.c);
  for (std::size_t i = 1; i < found.size() && !optimum.second; ++i)
    if (found[i].converged && !same_minimum(optimum.best, found[i])) optimum.second = found[i];
  return optimum;
}

// The sum of squares for an endless asymptote where something is held or bounded: the asymptote pushed out in
// steps.
double pushed_limit(GrowthProblem problem, GrowthVector c) {
  const int row = problem.curve->asymptote_row();  // natural chart: coordinates are parameters
  problem.held[row] = true;
  const double largest = *std::max_element(problem.data->value.begin(), problem.data->value.end());
  const double end = std::log(1e7 * largest);
  double rss = kInfinity;
  for (int step = 1; step <= 20; ++step) {
    c[row] += (end - c[row]) / (21 - step);
    const GrowthSolution at = minimize_directly(problem, c, 100, 1e-7);
    c = at.c;
    rss = at.rss;
  }
  return rss;
}

}  // namespace dendrofit
