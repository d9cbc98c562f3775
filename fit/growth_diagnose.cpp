// SPDX-License-Identifier: GPL-3.0-or-later
#include "fit/growth_diagnose.h"

#include "fit/growth_statistics.h"
#include "fit/growth_units.h"
#include "forward/growth_equations.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <set>
#include <sstream>

namespace dendrofit {
namespace {

std::string in_series(const MeasurementSeries& series) {
  return "series '" + series.name + "': ";
}

bool time_is_years(const GrowthOptions& options) {
  const auto unit = measurement_unit(options.time_unit);
  return unit && unit->kind == "time" && unit->factor == 1;
}

std::optional<double> metres_per_value(const GrowthOptions& options) {
  const auto unit = measurement_unit(options.value_unit);
  if (!unit || unit->kind != "length") return std::nullopt;
  return unit->factor;
}

std::vector<std::size_t> by_time(const MeasurementSeries& series) {
  std::vector<std::size_t> order(series.time.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return series.time[a] < series.time[b]; });
  return order;
}

int distinct_ages(const MeasurementSeries& series) {
  return static_cast<int>(std::set<double>(series.time.begin(), series.time.end()).size());
}

std::string row_name(const MeasurementSeries& series, std::size_t i) {
  return "row " + std::to_string(i + 1) + " (age " + plain_number(series.time[i]) + ", size " +
         plain_number(series.value[i]) + ")";
}

// Correlation of size with time.
double trend(const MeasurementSeries& series) {
  const auto n = static_cast<Eigen::Index>(series.time.size());
  const Eigen::Map<const Eigen::ArrayXd> t(series.time.data(), n), x(series.value.data(), n);
  const Eigen::ArrayXd dt = t - t.mean(), dx = x - x.mean();
  const double spread = std::sqrt(dt.square().sum() * dx.square().sum());
  return spread > 0 ? (dt * dx).sum() / spread : 0;
}

std::string counted(std::size_t count, const std::string& what) {
  return std::to_string(count) + " " + what + (count == 1 ? "" : "s");
}

// An equation that asks less of the data.
std::string simpler(const std::string& equation, const GrowthOptions& options) {
  if (options.abscissa != "age") return "the power law";
  return equation == "bertalanffy" ? "the logistic" : "Bertalanffy";
}

std::string older(const GrowthOptions& options) {
  return options.abscissa == "age" ? "older" : "thicker";
}

std::string listed(const std::vector<std::string>& items) {
  std::string text;
  for (std::size_t i = 0; i < items.size() && i < 5; ++i) text += (i ? ", " : "") + items[i];
  if (items.size() > 5) text += " and " + std::to_string(items.size() - 5) + " more";
  return text;
}

// Measurements that fall by more than a tenth of the largest size, and lone ones that would fit their
// neighbours when multiplied or divided by a unit's factor (3.28 feet to the metre, 2.54 centimetres to the
// inch).
void jump_warnings(const MeasurementSeries& series, std::vector<std::string>& warnings) {
  const auto order = by_time(series);
  if (distinct_ages(series) < static_cast<int>(order.size()))
    return;  // several trees: sizes differ at one age anyway
  const double largest = *std::max_element(series.value.begin(), series.value.end());
  std::vector<std::string> falls, mixed;
  for (std::size_t k = 1; k < order.size(); ++k) {
    const double before = series.value[order[k - 1]], now = series.value[order[k]];
    if (now < before - 0.1 * largest) falls.push_back(row_name(series, order[k]));
    if (k + 1 == order.size() || before <= 0) continue;
    const double after = series.value[order[k + 1]];
    const double share = (series.time[order[k]] - series.time[order[k - 1]]) /
                         (series.time[order[k + 1]] - series.time[order[k - 1]]);
    const double expected = before + share * (after - before);
    for (double factor : {1 / 0.3048, 0.3048, 2.54, 1 / 2.54})
      if (after >= before && expected > 0 && now > 0 && std::abs(now / expected / factor - 1) < 0.12 &&
          (now > 1.5 * after || now < before / 1.5)) {
        mixed.push_back(row_name(series, order[k]));
        break;
      }
  }
  if (!mixed.empty())
    warnings.push_back(in_series(series) +
                       "units look mixed (feet and metres, or inches and centimetres) at " + listed(mixed) +
                       ": bring all rows to one unit");
  else if (!falls.empty())
    warnings.push_back(in_series(series) + "the size falls at " + listed(falls) +
                       ": check these rows, or use a robust loss (--loss huber)");
}

}  // namespace

std::string plain_number(double value) {
  std::ostringstream text;
  text.precision(4);
  text << value;
  return text.str();
}

std::string series_and_equation(const std::string& series, const std::string& equation) {
  return "series '" + series + "', " + std::string(growth_equation(equation).title);
}

std::string unusable_measurements(const MeasurementSeries& series, const GrowthOptions& options) {
  if (series.time.size() != series.value.size())
    return in_series(series) + std::to_string(series.time.size()) + " ages but " +
           std::to_string(series.value.size()) + " sizes: give one size for each age";
  for (std::size_t i = 0; i < series.time.size(); ++i)
    if (!std::isfinite(series.time[i]) || !std::isfinite(series.value[i]))
      return in_series(series) + row_name(series, i) + " is not a number: leave missing values empty";
  if (series.time.empty())
    return in_series(series) + "no measurements: check the column names and the series' name";
  const auto [first, last] = std::minmax_element(series.time.begin(), series.time.end());
  if (*first > 1000 && time_is_years(options))
    return in_series(series) + "the times " + plain_number(*first) + " to " + plain_number(*last) +
           " look like calendar years, not ages: give the year of germination or planting as origin "
           "(--origin " +
           plain_number(std::floor(*first)) + " if growth began then)";
  if (*std::max_element(series.value.begin(), series.value.end()) <= options.offset)
    return in_series(series) + "no size is above " + plain_number(options.offset) +
           ": check the value column and its unit";
  if (options.weights != GrowthWeights::equal)
    for (std::size_t i = 0; i < series.value.size(); ++i)
      if (series.value[i] <= 0)
        return in_series(series) + row_name(series, i) +
               " cannot be weighted by its size: leave it out or use equal weights";
  return {};
}

std::vector<std::string> measurement_warnings(const MeasurementSeries& series, const GrowthOptions& options) {
  std::vector<std::string> warnings;
  const auto [first, last] = std::minmax_element(series.time.begin(), series.time.end());
  if (const auto metres = metres_per_value(options); metres && !options.fit_offset && options.offset == 0)
    for (std::size_t i = 0; i < series.time.size(); ++i) {
      const double height = series.value[i] * *metres;
      if (std::abs(series.time[i]) > 0.02 * (*last - *first) || height < 1.27 || height > 1.40) continue;
      warnings.push_back(
          in_series(series) + "size " + plain_number(series.value[i]) + " " + options.value_unit +
          " at age " + plain_number(series.time[i]) +
          " looks like total height against breast-height age: fit H-1.3, or use an offset (--offset 1.3 or "
          "--fit-offset)");
      break;
    }
  if (options.trunk_base_unmeasured && !options.fit_time_shift && !options.fit_offset)
    warnings.push_back(in_series(series) +
                       "the trunk base was not measured, so age 0 and size 0 are unknown: fit a time shift "
                       "(--fit-time-shift) or an offset (--fit-offset)");
  jump_warnings(series, warnings);
  return warnings;
}

std::string too_few_points(const MeasurementSeries& series, const std::string& equation, int parameters,
                           const GrowthOptions& options) {
  const int n = static_cast<int>(series.time.size()), ages = distinct_ages(series);
  const int missing = std::max(parameters + 1 - n, parameters - ages);
  if (missing <= 0) return {};
  return series_and_equation(series.name, equation) + ": " + counted(series.time.size(), "measurement") +
         " at " + counted(static_cast<std::size_t>(ages), options.abscissa) + " for " +
         std::to_string(parameters) + " parameters: add at least " + std::to_string(missing) + " more " +
         options.abscissa + (missing > 1 ? "s" : "") + ", fix a parameter, or use an equation with fewer";
}

std::string no_finite_optimum(const MeasurementSeries& series, const std::string& equation,
                              const GrowthOptions& options) {
  const auto [first, last] = std::minmax_element(series.time.begin(), series.time.end());
  return series_and_equation(series.name, equation) + ": " + options.abscissa + "s " + plain_number(*first) +
         " to " + plain_number(*last) + " " + options.time_unit +
         " show no levelling off, and the larger the final size the better the fit: give an upper bound "
         "(--bound "
         "asymptote=..:VALUE), add " +
         older(options) + " trees, or use " + simpler(equation, options);
}

std::string ill_conditioned(const MeasurementSeries& series, const std::string& equation,
                            const GrowthOptions& options) {
  const std::string lead = series_and_equation(series.name, equation) + ": ";
  const auto [least, most] = std::minmax_element(series.value.begin(), series.value.end());
  if (*most - *least <= 1e-9 * std::abs(*most))
    return lead + "every size is " + plain_number(*most) +
           ", so there is no growth to fit: check the value column, or add " + options.abscissa +
           "s at which the size was another";
  if (trend(series) < -0.5)
    return lead + "the sizes fall with " + options.abscissa +
           ", and growth curves only rise: check the columns and the order of the rows";
  return lead + "the measurements show a step between two " + options.abscissa +
         "s, so rate and shape cannot be told: add " + options.abscissa + "s between them (" +
         std::to_string(distinct_ages(series)) + " distinct " + options.abscissa + "s in " +
         options.time_unit + " now), or look for outliers";
}

std::string limiting_shape(const MeasurementSeries& series, const std::string& equation) {
  return series_and_equation(series.name, equation) +
         ": the shape runs to its limit, where this curve is a Gompertz: use Gompertz, or fix the shape "
         "(--fix)";
}

std::string not_converged(const MeasurementSeries& series, const std::string& equation) {
  return series_and_equation(series.name, equation) +
         ": no curve of this form could be found for these measurements: check them for outliers and mixed "
         "units, or use "
         "another equation";
}

std::vector<std::string> fit_warnings(const MeasurementSeries& series, const GrowthFit& fit,
                                      const GrowthOptions& options) {
  std::vector<std::string> warnings;
  const std::string lead = series_and_equation(series.name, fit.equation) + ": ";
  const GrowthEquation& equation = growth_equation(fit.equation);
  const double oldest = *std::max_element(series.time.begin(), series.time.end());
  const GrowthParameter& asymptote = fit.parameters[equation.asymptote_row];
  if (!fit.asymptote_bounded && !asymptote.fixed) {
    std::string text = lead + options.abscissa + "s reach " + plain_number(oldest) + " " + options.time_unit +
                       "; the data bound the maximum size only from below";
    if (std::isfinite(asymptote.lo))
      text += " (>= " + plain_number(asymptote.lo + options.offset) + " " + options.value_unit + ")";
    text += ": give an upper bound (--bound asymptote=..:VALUE), add " + older(options) + " trees";
    if (fit.equation != "bertalanffy") text += ", or use " + simpler(fit.equation, options);
    warnings.push_back(text);
  }
  if (const GrowthParameter* start = fit.parameter("X0"); start && !start->fixed) {
    const bool early = std::isfinite(fit.derived.inflection_age) && oldest < fit.derived.inflection_age;
    const bool touches_zero = fit.profiled ? start->lo < 0.01 * start->value : start->lo <= 0;
    if (touches_zero || early || fit.largest_correlation > 0.99)
      warnings.push_back(
          lead +
          "X0 is an extrapolation to age 0 that the data hardly determine: report the inflection age (" +
          plain_number(fit.derived.inflection_age) + " " + options.time_unit +
          ") instead, or add young ages");
  }
  if (fit.parameter("time_shift") && fit.largest_correlation > 0.99)
    warnings.push_back(lead +
                       "the time shift can hardly be told from the rate: add young ages, or fix it "
                       "(--fix time_shift=YEARS)");
  const int ages = distinct_ages(series);
  if (options.abscissa == "age" && fit.n >= 8 && 5 * ages >= 4 * fit.n) {
    std::vector<double> ordered;
    for (std::size_t i : by_time(series)) ordered.push_back(fit.residuals[i]);
    if (lag1_correlation(ordered) > 2 / std::sqrt(static_cast<double>(fit.n)) || runs_z(ordered) < -1.96)
      warnings.push_back(
          lead + "residuals of neighbouring ages are alike (correlation " + plain_number(fit.residual_lag1) +
          "), as in cumulated increments of one tree, so the errors are too small: resample whole trees, or "
          "use the mixed model (--mixed)");
  }
  if (fit.second_best)
    warnings.push_back(lead + "two different curves fit almost equally well (residual sums of squares " +
                       plain_number(fit.rss) + " and " + plain_number(fit.second_best->rss) +
                       "): both are reported; add measurements where they differ");
  for (const GrowthParameter& parameter : fit.parameters)
    if (parameter.at_bound)
      warnings.push_back(lead + parameter.name + " stopped at the given bound " +
                         plain_number(parameter.value) + ": widen the bound if it was only a guess");
  return warnings;
}

}  // namespace dendrofit
