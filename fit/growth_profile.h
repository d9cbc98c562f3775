// SPDX-License-Identifier: GPL-3.0-or-later
// Profile-likelihood limits of single parameters (Bates & Watts 1988, ch. 6).
// Internal to the growth-curve files of this floor.
#pragma once

#include "fit/growth_solver.h"

#include <optional>

namespace dendrofit {

struct ProfileLimits {
  double lo = 0;  ///< natural parameter; 0 or -infinity where nothing bounds it from below
  double hi = 0;  ///< infinity where nothing bounds it from above
  /// A lower sum of squares met on the way: the fit was not the lowest, start again from here.
  std::optional<GrowthVector> better;
};

/// Where the residual sum of squares, minimised over all other free parameters, reaches rss + threshold^2
/// sigma^2 with sigma^2 = rss / degrees. `natural` is the optimum of `problem` in natural parameters, `row`
/// the parameter, `se` its standard error (only a first guess of the step).
ProfileLimits profile_limits(const GrowthProblem& problem, const GrowthVector& natural, double rss,
                             int degrees, double threshold, int row, double se);

}  // namespace dendrofit
