// SPDX-License-Identifier: GPL-3.0-or-later
// One growth equation fitted to one series of measurements.
#pragma once

#include "core/measurements.h"
#include "fit/growth_options.h"
#include "fit/growth_result.h"

#include <string>

namespace dendrofit {

/// Weighted least squares (or a robust loss) from automatic starts: a logarithmic grid of the shape
/// parameters with the scale by linear least squares, the best six separated cells polished, the lowest taken
/// to convergence by Ceres and Gauss-Newton. Standard errors are scaled by rss/(n-p); limits are of the
/// profile likelihood. A series that cannot be fitted is a result whose status and reason say so. Throws
/// InputError for options that cannot be right.
///
/// `weights` (one a measurement, above 0) replace the scheme of the options where given.
GrowthFit fit_growth_equation(const MeasurementSeries& series, const std::string& equation,
                              const GrowthOptions& options = {}, const std::vector<double>& weights = {});

}  // namespace dendrofit
