// SPDX-License-Identifier: GPL-3.0-or-later
#include "fit/growth_derived.h"

#include "core/errors.h"
#include "fit/growth_curve.h"
#include "fit/growth_statistics.h"
#include "fit/growth_units.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace dendrofit {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kBreastHeight = 1.3;  // metres

GrowthVector natural_of(const std::vector<double>& values) {
  return Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size()));
}

// Last age where t X'(t) = X(t): the mean annual increment is largest. NaN where it falls from the beginning.
double culmination(const GrowthCurve& curve, const GrowthVector& natural) {
  const auto rising = [&](double t) { return t * curve.rate(natural, t) - curve.value(natural, t); };
  double lo = curve.inflection_age(natural);
  if (!(lo > 0) || !(rising(lo) > 0)) return kGrowthNaN;
  double hi = 1.5 * lo;
  for (int i = 0; rising(hi) > 0; ++i, hi *= 1.5)
    if (i == 200) return kGrowthNaN;
  for (int i = 0; i < 200 && hi - lo > 2e-16 * hi; ++i) {
    const double middle = 0.5 * (lo + hi);
    (rising(middle) > 0 ? lo : hi) = middle;
  }
  return 0.5 * (lo + hi);
}

enum Row { kAsymptote, kInflectionAge, kInflectionValue, kIncrement, kMaiAge, kMai, kBreast, kSite, kRows };
using Rows = std::array<double, kRows>;

Rows all_derived(const GrowthCurve& curve, const GrowthVector& natural, const GrowthOptions& options) {
  Rows rows;
  rows.fill(kGrowthNaN);
  rows[kAsymptote] = curve.asymptote(natural);
  rows[kInflectionAge] = curve.inflection_age(natural);
  if (std::isfinite(rows[kInflectionAge])) {
    rows[kInflectionValue] = curve.value(natural, rows[kInflectionAge]);
    rows[kIncrement] = curve.rate(natural, rows[kInflectionAge]);
  }
  rows[kMaiAge] = culmination(curve, natural);
  if (std::isfinite(rows[kMaiAge])) rows[kMai] = curve.value(natural, rows[kMaiAge]) / rows[kMaiAge];
  if (const auto unit = measurement_unit(options.value_unit); unit && unit->kind == "length")
    rows[kBreast] = curve.age_at(natural, kBreastHeight / unit->factor);
  if (options.base_age) rows[kSite] = curve.value(natural, *options.base_age);
  return rows;
}

bool has_parameter(const GrowthFit& fit, const std::string& name) {
  return fit.parameter(name) != nullptr;
}

}  // namespace

FittedGrowth::FittedGrowth(const GrowthFit& fit, const GrowthOptions& options)
    : equation_(fit.equation),
      offset_(has_parameter(fit, "offset")),
      shift_(has_parameter(fit, "time_shift")),
      base_(options.offset),
      sigma_(fit.sigma),
      covariance_(fit.covariance) {
  for (const GrowthParameter& parameter : fit.parameters) natural_.push_back(parameter.value);
  if (natural_.empty() || !natural_of(natural_).allFinite())
    throw InputError("the " + std::string(growth_equation(equation_).title) +
                     " fit has no curve: " + fit.reason);
  int free = 0;
  for (const GrowthParameter& parameter : fit.parameters)
    free += parameter.fixed || parameter.at_bound ? 0 : 1;
  quantile_ = fit.n > free ? student_t_two_sided(options.confidence, fit.n - free) : kGrowthNaN;
}

GrowthCurve FittedGrowth::curve() const {
  return {growth_equation(equation_), offset_, shift_, base_};
}

double FittedGrowth::value(double t) const {
  return curve().value(natural_of(natural_), t);
}
double FittedGrowth::increment(double t) const {
  return curve().rate(natural_of(natural_), t);
}
double FittedGrowth::age_at(double size) const {
  return curve().age_at(natural_of(natural_), size);
}

double FittedGrowth::value_se(double t) const {
  if (covariance_.size() == 0) return kGrowthNaN;
  GrowthVector g;
  curve().gradient(natural_of(natural_), t, g);
  return std::sqrt(std::max(0.0, g.dot(covariance_ * g)));
}

Interval FittedGrowth::site_index(double base_age) const {
  const double size = value(base_age), half = quantile_ * value_se(base_age);
  return {size, size - half, size + half};
}

Interval FittedGrowth::age_interval(double size) const {
  const double age = age_at(size);
  Interval result{age, -kInfinity, kInfinity};
  if (!std::isfinite(age) || !std::isfinite(value_se(age))) return result;
  // The band's upper edge reaches the size earlier, its lower edge later.
  const auto edge = [&](double t, double side) { return value(t) + side * quantile_ * value_se(t) - size; };
  const auto cross = [&](double inside, double outside, double side) {
    for (int i = 0; i < 100; ++i) {
      const double middle = 0.5 * (inside + outside);
      (edge(middle, side) * side > 0 ? inside : outside) = middle;
    }
    return 0.5 * (inside + outside);
  };
  double early = age, late = age;
  const double step = std::max(std::abs(age), 1e-12) / 64;
  for (int i = 0; i < 128 && edge(early, 1) > 0; ++i) early -= step;
  if (edge(early, 1) <= 0) result.lo = cross(age, early, 1);
  for (int i = 0; i < 640 && edge(late, -1) < 0; ++i) late += step;
  if (edge(late, -1) >= 0) result.hi = cross(age, late, -1);
  return result;
}

double FittedGrowth::site_index_of(double age, double size, double base_age) const {
  require(age > 0, "age", age, "must be above 0");
  require(size > 0, "size", size, "must be above 0");
  return base_ + (size - base_) * (value(base_age) - base_) / (value(age) - base_);
}

double FittedGrowth::size_of_site(double site_index, double base_age, double age) const {
  require(site_index > 0, "site_index", site_index, "must be above 0");
  return base_ + (site_index - base_) * (value(age) - base_) / (value(base_age) - base_);
}

GrowthBandPoint FittedGrowth::band(double t) const {
  GrowthBandPoint point;
  point.time = t;
  point.fit = value(t);
  point.se = value_se(t);
  const double wide = quantile_ * std::hypot(point.se, sigma_);
  point.confidence_lo = point.fit - quantile_ * point.se;
  point.confidence_hi = point.fit + quantile_ * point.se;
  point.prediction_lo = point.fit - wide;
  point.prediction_hi = point.fit + wide;
  point.cai = increment(t);
  point.mai = mean_increment(t);
  return point;
}

GrowthDerived derive_growth(const GrowthFit& fit, const GrowthOptions& options) {
  const GrowthCurve curve(growth_equation(fit.equation), has_parameter(fit, "offset"),
                          has_parameter(fit, "time_shift"), options.offset);
  std::vector<double> values;
  for (const GrowthParameter& parameter : fit.parameters) values.push_back(parameter.value);
  const GrowthVector natural = natural_of(values);
  const Rows rows = all_derived(curve, natural, options);
  Rows errors;
  errors.fill(kGrowthNaN);
  if (fit.covariance.size() > 0) {
    Eigen::MatrixXd slopes(static_cast<Eigen::Index>(kRows), natural.size());
    for (Eigen::Index i = 0; i < natural.size(); ++i) {
      const double step =
          1e-5 * (natural[i] != 0 ? std::abs(natural[i]) : std::sqrt(fit.covariance(i, i)) + 1e-12);
      GrowthVector up = natural, down = natural;
      up[i] += step;
      down[i] -= step;
      const Rows a = all_derived(curve, up, options), b = all_derived(curve, down, options);
      for (int k = 0; k < kRows; ++k) slopes(k, i) = (a[k] - b[k]) / (2 * step);
    }
    for (int k = 0; k < kRows; ++k)
      errors[k] = std::sqrt((slopes.row(k) * fit.covariance * slopes.row(k).transpose()).value());
  }
  GrowthDerived derived;
  derived.asymptote = rows[kAsymptote];
  derived.asymptote_se = errors[kAsymptote];
  derived.inflection_age = rows[kInflectionAge];
  derived.inflection_age_se = errors[kInflectionAge];
  derived.inflection_value = rows[kInflectionValue];
  derived.max_increment = rows[kIncrement];
  derived.max_increment_se = errors[kIncrement];
  derived.mai_culmination_age = rows[kMaiAge];
  derived.mai_culmination_age_se = errors[kMaiAge];
  derived.max_mai = rows[kMai];
  derived.years_to_breast_height = rows[kBreast];
  derived.site_index = rows[kSite];
  derived.site_index_se = errors[kSite];
  if (fit.equation == "weibull") derived.scale_age = std::pow(values[1], -1 / values[2]);
  return derived;
}

}  // namespace dendrofit
