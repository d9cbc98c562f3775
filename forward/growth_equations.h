// SPDX-License-Identifier: GPL-3.0-or-later
// Growth equations X(t): size over age, each one row of a table. Sizes are in whatever unit the asymptote has
// and ages in whatever unit the rates are the inverse of (metres and years for a fit, internodes and cycles
// in a simulation). Forms: Yi 2018 (eq. 1-3: logistic, Bertalanffy, Weibull) and Zeide 1993, For. Sci. 39:594
// (the others).
#pragma once

#include "core/parameters.h"

#include <span>
#include <string_view>

namespace dendrofit {

/// One growth equation. `p` are the parameters in the order of `parameters`, all inside their bounds. Every
/// function is pure and never throws; equations that start from nothing (starts_at_zero) are 0 at and before
/// age 0.
struct GrowthEquation {
  std::string_view name;                      ///< as in files and on the command line
  std::string_view title;                     ///< as in a sentence
  std::string_view formula;                   ///< in the parameters' symbols
  std::span<const ParameterSpec> parameters;  ///< `symbol` is the name in growth.json
  bool starts_at_zero = false;
  std::size_t asymptote_row = 0;  ///< the parameter that is the final size

  double (*value)(std::span<const double> p, double t) = nullptr;
  double (*rate)(std::span<const double> p, double t) = nullptr;  ///< dX/dt
  /// dX/dp into `g`, as many entries as parameters.
  void (*gradient)(std::span<const double> p, double t, std::span<double> g) = nullptr;
  /// Age where the rate is largest (d2X/dt2 = 0); NaN where the curve has no inflection at all. May be
  /// negative.
  double (*inflection_age)(std::span<const double> p) = nullptr;
  /// Age at which the size is `x`: the inverse of value. NaN where the curve never has that size.
  double (*age_at)(std::span<const double> p, double x) = nullptr;

  double asymptote(std::span<const double> p) const { return p[asymptote_row]; }
};

/// All equations: logistic, bertalanffy, weibull (the paper's), gompertz, chapman_richards, korf, hossfeld4,
/// monomolecular, richards.
std::span<const GrowthEquation> growth_equations();

/// The equation of that name; throws InputError naming the nearest known one.
const GrowthEquation& growth_equation(std::string_view name);

}  // namespace dendrofit
