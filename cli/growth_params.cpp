// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/growth_params.h"

#include "cli/igm_files.h"
#include "core/errors.h"
#include "fit/growth_units.h"
#include "forward/growth_equations.h"
#include "forward/igm/parameters.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

namespace dendrofit::cli {
namespace {

constexpr double kLongest = 1000;  // cycles: the growth model's limit

double internodes_per_value(const GrowthReport& report, double internode_m) {
  const auto unit = measurement_unit(report.value_unit);
  if (!unit && (report.value_unit == "internodes" || report.value_unit == "count")) return 1;
  if (!unit || unit->kind != "length")
    throw InputError(
        fmt::format("--params-out: the values are in {}, and the growth model counts internodes along "
                    "the stem: give heights, or counts of internodes (--value-unit internodes)",
                    report.value_unit));
  return unit->factor / internode_m;
}

double cycles_per_time(const GrowthReport& report) {
  const auto unit = measurement_unit(report.time_unit);
  if (unit && unit->kind == "time") return unit->factor;
  throw InputError(
      fmt::format("--params-out: '{}' is no unit of time, so that years cannot be told: give --time-unit",
                  report.time_unit));
}

// X(t) becomes sizes * X(T / times): each parameter by its unit; `shape` is the exponent that units name.
double rescaled(const ParameterSpec& spec, double value, double sizes, double times, double shape) {
  if (spec.unit == "size") return value * sizes;
  if (spec.unit == "1/time") return value / times;
  if (spec.unit == "1/time^w3") return value * std::pow(times, -shape);
  if (spec.unit == "time^c") return value * std::pow(times, shape);
  if (spec.unit == "time^c/size") return value * std::pow(times, shape) / sizes;
  return value;
}

}  // namespace

std::string growth_params_toml(const GrowthReport& report, const GrowthSeries& series, const GrowthFit& fit,
                               double offset, std::optional<double> internode_m) {
  if (fit.status != GrowthStatus::ok) throw InputError("--params-out: nothing to write: " + fit.reason);
  if (offset != 0 || fit.parameter("offset") || fit.parameter("time_shift"))
    throw InputError(
        "--params-out: the growth model's curve starts at the ground at age 0, which a curve with an offset "
        "or a "
        "time shift does not: fit total height over age from germination");
  IgmParameters parameters;
  parameters.set_equation(fit.equation);
  if (internode_m) parameters.set("rho_m", *internode_m, "--internode");
  const double sizes = internodes_per_value(report, parameters.rho_m), times = cycles_per_time(report);
  const auto table = growth_equation(fit.equation).parameters;
  double shape = 1;
  for (std::size_t i = 0; i < table.size(); ++i)
    if (table[i].symbol == "w3" || table[i].symbol == "c") shape = fit.parameters[i].value;
  for (std::size_t i = 0; i < table.size(); ++i)
    parameters.set(
        table[i].key, rescaled(table[i], fit.parameters[i].value, sizes, times, shape),
        fmt::format("--params-out, {} of series '{}' in internodes of {:.4g} m and yearly cycles (another "
                    "--internode moves it)",
                    table[i].symbol, series.name, parameters.rho_m));
  const double oldest = *std::max_element(series.time.begin(), series.time.end()) * times;
  parameters.set("cycles", std::clamp(std::round(oldest), 1.0, kLongest), "--params-out");
  parameters.validate();
  std::string name = series.name;  // a comment must stay one line
  std::replace_if(
      name.begin(), name.end(), [](unsigned char c) { return c < 32 || c == 127; }, ' ');
  const double last = growth_equation(fit.equation).value(parameters.equation_values, parameters.cycles);
  return igm_parameters_toml(
      parameters,
      {fmt::format("Growth curve of series '{}', fitted to {} measurements ({} over {}).", name, fit.n,
                   report.value_unit, report.time_unit),
       fmt::format(
           "Sizes count internodes of {:.6g} m, one cycle is one year. What the curve does not tell is the "
           "model's default.",
           parameters.rho_m),
       fmt::format(
           "The curve comes to {:.4g} internodes ({:.4g} m) at cycle {}. A grown stem stays below its curve "
           "where light, space or whole internodes run short: compare its height.",
           last, last * parameters.rho_m, parameters.cycles)});
}

}  // namespace dendrofit::cli
