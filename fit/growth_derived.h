// SPDX-License-Identifier: GPL-3.0-or-later
// What foresters read off a fitted curve: increments and their culmination, site index, ages for sizes,
// bands.
#pragma once

#include "core/types.h"
#include "fit/growth_options.h"
#include "fit/growth_result.h"

#include <span>
#include <vector>

namespace dendrofit {

class GrowthCurve;

/// The curve of a fit as a function: values, rates and their errors at any age. Copyable; needs the options
/// that made the fit (offset). Throws InputError where the fit has no parameters.
class FittedGrowth {
 public:
  FittedGrowth(const GrowthFit& fit, const GrowthOptions& options = {});

  double value(double t) const;
  /// Current increment dX/dt, per time unit (CAI).
  double increment(double t) const;
  /// X/t (MAI); NaN at t <= 0.
  double mean_increment(double t) const { return t > 0 ? value(t) / t : kGrowthNaN; }
  /// Age of that size; NaN where the curve never has it.
  double age_at(double size) const;
  /// Standard error of value(t) by the delta method; NaN without covariance.
  double value_se(double t) const;
  /// Size at the base age with its confidence limits; the site index where the curve is of dominant height.
  Interval site_index(double base_age) const;
  /// Age at which the curve reaches `size`, with the ages at which its confidence band does; a limit is
  /// infinite where the band never reaches it.
  Interval age_interval(double size) const;
  /// Site index of another plot of dominant height `size` at `age`, from this curve as the guide curve of a
  /// family with one shape and plot-wise asymptotes (anamorphic): size * X(base) / X(age). Throws InputError
  /// for age or size not above 0.
  double site_index_of(double age, double size, double base_age) const;
  /// The inverse: height at `age` on the family's curve of that site index.
  double size_of_site(double site_index, double base_age, double age) const;
  GrowthBandPoint band(double t) const;

 private:
  std::string equation_;
  std::vector<double> natural_;
  bool offset_ = false, shift_ = false;
  double base_ = 0, sigma_ = 0, quantile_ = 0;
  Eigen::MatrixXd covariance_;
  GrowthCurve curve() const;
};

/// Inflection, culminations, asymptote and (with units) years to 1.3 m, with delta-method errors where `fit`
/// has a covariance.
GrowthDerived derive_growth(const GrowthFit& fit, const GrowthOptions& options);

}  // namespace dendrofit
