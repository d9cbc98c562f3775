// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/growth_table.h"

#include "forward/growth_equations.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

namespace dendrofit::cli {
namespace {

// "value" or "value +- se".
std::string with_error(double value, double se) {
  return std::isfinite(se) ? fmt::format("{} +- {}", brief_number(value), brief_number(se))
                           : brief_number(value);
}

std::string derived_lines(const GrowthReport& report, const GrowthDerived& d, double oldest) {
  const std::string& unit = report.time_unit;
  const std::string one = unit.ends_with('s') ? unit.substr(0, unit.size() - 1) : unit;
  std::string text;
  if (std::isfinite(d.inflection_age))
    text += fmt::format("      fastest growth at {} {}: {} {} a {}\n",
                        with_error(d.inflection_age, d.inflection_age_se), unit,
                        with_error(d.max_increment, d.max_increment_se), report.value_unit, one);
  if (std::isfinite(d.mai_culmination_age))
    text += fmt::format("      mean increment culminates at {} {}: {}\n",
                        with_error(d.mai_culmination_age, d.mai_culmination_age_se), unit,
                        brief_number(d.max_mai));
  if (std::isfinite(d.scale_age))
    text += fmt::format("      63 % of the final size at {} {}\n", brief_number(d.scale_age), unit);
  if (d.years_to_breast_height >= 0 && d.years_to_breast_height <= oldest)
    text += fmt::format("      1.3 m reached at {} {}\n", brief_number(d.years_to_breast_height), unit);
  if (std::isfinite(d.site_index))
    text +=
        fmt::format("      site index {} {}\n", with_error(d.site_index, d.site_index_se), report.value_unit);
  return text;
}

std::string fit_lines(const GrowthReport& report, const GrowthFit& fit, double oldest) {
  if (fit.status != GrowthStatus::ok)
    return fmt::format("  {:<17} {}: {}\n", form_title(fit.equation), growth_status_name(fit.status),
                       fit.reason);
  std::string text =
      fmt::format("  {:<17} AICc {:<9} error {:<8} ", form_title(fit.equation),
                  std::isfinite(fit.aicc) ? brief_number(fit.aicc) : "-", brief_number(fit.sigma));
  if (std::isinf(fit.derived.asymptote))
    text += "no asymptote\n";
  else
    text += fmt::format("asymptote {:<9} {}\n", brief_number(fit.derived.asymptote),
                        fit.asymptote_bounded ? "bounded by the data" : "NOT bounded by the data");
  for (const GrowthParameter& parameter : fit.parameters) text += "      " + parameter_line(parameter) + "\n";
  if (report.abscissa == "age") text += derived_lines(report, fit.derived, oldest);
  for (const std::string& warning : fit.warnings) text += "      ! " + warning + "\n";
  return text;
}

}  // namespace

std::string form_title(const std::string& form) {
  return form == "power" ? "power law" : std::string(growth_equation(form).title);
}

std::string brief_number(double x) {
  if (std::isnan(x)) return "-";
  return fmt::format("{:.4g}", x == 0 ? 0.0 : x);
}

std::string parameter_line(const GrowthParameter& parameter) {
  std::string text = parameter.name + " = " + brief_number(parameter.value);
  if (!parameter.unit.empty()) text += " " + parameter.unit;
  if (parameter.fixed) return text + " (fixed)";
  if (parameter.at_bound) return text + " (at the given bound)";
  if (std::isnan(parameter.lo) && std::isnan(parameter.hi)) return text;
  return text + fmt::format(" [{}, {}]", brief_number(parameter.lo),
                            std::isinf(parameter.hi) ? "unbounded" : brief_number(parameter.hi));
}

std::string growth_table(const GrowthReport& report, const GrowthSeries& series) {
  std::string text = fmt::format("{}: {} measurement{}", series.name, series.time.size(),
                                 series.time.size() == 1 ? "" : "s");
  if (!series.best.empty()) text += ", best by AICc: " + form_title(series.best);
  text += fmt::format(" ({} = {:.4g} % limits)\n", "[lo, hi]", 100 * report.confidence);
  for (const std::string& warning : series.warnings) text += "  ! " + warning + "\n";
  const double oldest = series.time.empty() ? 0 : *std::max_element(series.time.begin(), series.time.end());
  for (const GrowthFit& fit : series.fits) text += fit_lines(report, fit, oldest);
  return text;
}

std::string mixed_table(const GrowthReport& report, const GrowthMixed& mixed) {
  if (mixed.status != GrowthStatus::ok)
    return fmt::format("mixed model, {}: {}: {}\n", form_title(mixed.equation),
                       growth_status_name(mixed.status), mixed.reason);
  std::string text = fmt::format(
      "mixed model, {}: {} series, {} measurements, log-likelihood {}, residual error {} {} (Wald limits)\n",
      form_title(mixed.equation), mixed.series.size(), mixed.n, brief_number(mixed.log_likelihood),
      brief_number(mixed.sigma), report.value_unit);
  for (const GrowthParameter& parameter : mixed.fixed) text += "      " + parameter_line(parameter) + "\n";
  for (std::size_t i = 0; i < mixed.random.size(); ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    text += fmt::format("      {} varies between series with standard deviation {}\n", mixed.random[i],
                        brief_number(std::sqrt(mixed.random_covariance(k, k))));
  }
  return text;
}

}  // namespace dendrofit::cli
