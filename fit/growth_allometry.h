// SPDX-License-Identifier: GPL-3.0-or-later
// Height from diameter (and any other power law) for trees measured once.
#pragma once

#include "core/measurements.h"
#include "core/progress.h"
#include "fit/growth_options.h"
#include "fit/growth_result.h"

#include <string>
#include <vector>

namespace dendrofit {

/// y = base + a x^b. Status, reason and limits (Student's t) as in a growth fit.
struct PowerLawFit {
  GrowthStatus status = GrowthStatus::failed;
  std::string reason;
  double base = 0;
  GrowthParameter a, b;
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Zero();  ///< of a and b
  int n = 0;
  double rss = kGrowthNaN, sigma = kGrowthNaN;
  double value(double x) const;
};

/// Least squares, started from the regression of ln(y - base) on ln x (or from `start` = a, b where given).
/// Too few or unusable points are a result. Throws InputError for vectors of different length or a confidence
/// outside (0, 1).
PowerLawFit fit_power_law(const std::vector<double>& x, const std::vector<double>& y, double base = 0,
                          const std::vector<double>& start = {}, double confidence = 0.95);

/// H = 1.3 m + f(D) with a growth equation that starts from nothing (Weibull, Chapman-Richards, Korf,
/// Hossfeld IV, Bertalanffy) of the diameter in place of age. `options.value_unit` is the heights' unit.
/// Throws InputError for other equations.
GrowthFit fit_height_diameter(const std::vector<double>& diameter, const std::vector<double>& height,
                              const std::string& equation, const GrowthOptions& options = {});

/// Height over diameter of trees measured once, in every form named: "power" (H = 1.3 m + a D^b) or an
/// equation that fit_height_diameter takes. `series` hold diameters as times and heights as values;
/// options.time_unit and options.value_unit are their units. The report's `abscissa` is "diameter"; each
/// series names its best form by AICc, and all series as one follow as pooled where there are several. Throws
/// InputError for an unknown form, an unknown unit of height, or no series.
GrowthReport fit_allometry(const std::vector<MeasurementSeries>& series,
                           const std::vector<std::string>& forms, const GrowthOptions& options = {},
                           Progress& progress = no_progress());

}  // namespace dendrofit
