// SPDX-License-Identifier: GPL-3.0-or-later
// The lowest point of a growth-curve fit over all its starts. Internal to the growth-curve files of this
// floor.
#pragma once

#include "fit/growth_options.h"
#include "fit/growth_solver.h"

#include <optional>
#include <vector>

namespace dendrofit {

struct GrowthOptimum {
  GrowthSolution best;                   ///< taken to convergence
  std::optional<GrowthSolution> second;  ///< the lowest other minimum met
};

/// From each start (natural parameters) downhill, then the lowest to the end. Nothing where no start has a
/// finite curve.
std::optional<GrowthOptimum> find_growth_optimum(const GrowthProblem& problem,
                                                 const std::vector<GrowthVector>& starts,
                                                 const GrowthOptions& options);

/// The sum of squares for an endless asymptote where something is held or bounded: the asymptote pushed out
/// in steps from `c`. The problem is in the natural chart.
double pushed_limit(GrowthProblem problem, GrowthVector c);

}  // namespace dendrofit
