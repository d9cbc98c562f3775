// SPDX-License-Identifier: GPL-3.0-or-later
#include "fit/growth_report.h"

#include "core/errors.h"
#include "core/parallel.h"
#include "fit/growth_diagnose.h"
#include "fit/growth_fit.h"
#include "fit/growth_mixed.h"
#include "forward/growth_equations.h"

#include <algorithm>
#include <cmath>
#include <exception>
#include <set>

namespace dendrofit {
namespace {

GrowthFit fit_or_say_why(const MeasurementSeries& series, const std::string& equation,
                         const GrowthOptions& options) {
  try {
    return fit_growth_equation(series, equation, options);
  } catch (const InputError&) {
    throw;  // the options', not the series'
  } catch (const std::exception& error) {
    GrowthFit fit;
    fit.equation = equation;
    fit.n = static_cast<int>(series.time.size());
    fit.reason = series_and_equation(series.name, equation) + ": " + error.what() +
                 "; leave this series out and report the fault";
    return fit;
  }
}

// Lowest AICc; where no fit has enough measurements for it, lowest AIC.
std::string best_equation(const std::vector<GrowthFit>& fits) {
  for (double GrowthFit::*criterion : {&GrowthFit::aicc, &GrowthFit::aic}) {
    const GrowthFit* best = nullptr;
    for (const GrowthFit& fit : fits)
      if (fit.status == GrowthStatus::ok && std::isfinite(fit.*criterion) &&
          (!best || fit.*criterion < best->*criterion))
        best = &fit;
    if (best) return best->equation;
  }
  return {};
}

GrowthSeries fit_one_series(MeasurementSeries series, const GrowthOptions& options) {
  GrowthSeries result;
  result.name = series.name;
  for (const std::string& equation : options.equations)
    result.fits.push_back(fit_or_say_why(series, equation, options));
  if (options.origin_time)
    for (double& t : series.time) t -= *options.origin_time;
  result.time = series.time;
  result.value = series.value;
  if (const std::string unusable = unusable_measurements(series, options); !unusable.empty())
    result.warnings.push_back(unusable);
  else
    result.warnings = measurement_warnings(series, options);
  result.best = best_equation(result.fits);
  return result;
}

MeasurementSeries pooled_series(const std::vector<MeasurementSeries>& series, const GrowthOptions& options) {
  MeasurementSeries all;
  all.name = "pooled";
  for (const MeasurementSeries& one : series) {
    MeasurementSeries shifted = one;
    if (options.origin_time)
      for (double& t : shifted.time) t -= *options.origin_time;
    if (!unusable_measurements(shifted, options).empty()) continue;
    all.time.insert(all.time.end(), one.time.begin(), one.time.end());
    all.value.insert(all.value.end(), one.value.begin(), one.value.end());
  }
  return all;
}

}  // namespace

GrowthReport fit_growth(const std::vector<MeasurementSeries>& series, const GrowthOptions& options,
                        Progress& progress) {
  options.validate();
  if (series.empty())
    throw InputError(
        "no measurement series: expected a table with the columns series,time,value and at least one row");
  GrowthReport report;
  report.time_unit = options.time_unit;
  report.value_unit = options.value_unit;
  report.confidence = options.confidence;
  report.series.resize(series.size());
  progress.begin("growth curves", static_cast<double>(series.size()), "series");
  parallel_blocks(series.size(), 1, options.threads, [&](std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i) {
      progress.check();
      report.series[i] = fit_one_series(series[i], options);
      progress.advance(1);
    }
  });
  progress.end();

  std::set<std::string> named;
  for (const GrowthSeries& one : report.series) {
    if (!named.insert(one.name).second)
      report.warnings.push_back("series '" + one.name + "' occurs twice: give each series its own name");
    if (one.best.empty())
      for (const GrowthFit& fit : one.fits) report.warnings.push_back(fit.reason);
  }
  if (series.size() > 1 && options.pooled) {
    progress.begin("pooled curve", 1, "fit");
    const MeasurementSeries all = pooled_series(series, options);
    report.pooled = fit_one_series(all, options);
    report.pooled->warnings.push_back(
        "pooled: measurements of one series are not independent, so these errors are too small: use the "
        "mixed model (--mixed) "
        "for the population");
    progress.end();
  }
  if (options.mixed != GrowthMixedEffects::none) {
    progress.begin("mixed models", static_cast<double>(options.equations.size()), "fits");
    for (const std::string& equation : options.equations) {
      report.mixed.push_back(fit_mixed_growth(series, equation, options, progress));
      if (report.mixed.back().status != GrowthStatus::ok)
        report.warnings.push_back(report.mixed.back().reason);
      progress.advance(1);
    }
    progress.end();
  }
  return report;
}

}  // namespace dendrofit
