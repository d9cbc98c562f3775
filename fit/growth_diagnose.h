// SPDX-License-Identifier: GPL-3.0-or-later
// What measurements and fits cannot say, told in the field's words: each message names the series, the cause
// and the remedy. Internal to the growth-curve files of this floor.
#pragma once

#include "core/measurements.h"
#include "fit/growth_options.h"
#include "fit/growth_result.h"

#include <string>
#include <vector>

namespace dendrofit {

/// A number as people write it: four significant digits.
std::string plain_number(double value);

/// "series 'A1', Weibull".
std::string series_and_equation(const std::string& series, const std::string& equation);

/// Why no equation at all can be fitted (times or values not finite, calendar years, no size above 0); empty
/// otherwise.
std::string unusable_measurements(const MeasurementSeries& series, const GrowthOptions& options);

/// Traps in the measurements themselves: sizes against breast-height age, an unmeasured trunk base, falling
/// sizes, mixed units.
std::vector<std::string> measurement_warnings(const MeasurementSeries& series, const GrowthOptions& options);

/// Refusal for too few ages with how many are missing; empty where there are enough for `parameters` of them.
std::string too_few_points(const MeasurementSeries& series, const std::string& equation, int parameters,
                           const GrowthOptions& options);

std::string no_finite_optimum(const MeasurementSeries& series, const std::string& equation,
                              const GrowthOptions& options);
std::string ill_conditioned(const MeasurementSeries& series, const std::string& equation,
                            const GrowthOptions& options);
std::string limiting_shape(const MeasurementSeries& series, const std::string& equation);
std::string not_converged(const MeasurementSeries& series, const std::string& equation);

/// What a finished fit cannot say: endless asymptote, extrapolated X0, correlated residuals, rival minima.
std::vector<std::string> fit_warnings(const MeasurementSeries& series, const GrowthFit& fit,
                                      const GrowthOptions& options);

}  // namespace dendrofit
