// SPDX-License-Identifier: GPL-3.0-or-later
#include "forward/growth_equations.h"

#include "core/errors.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

namespace dendrofit {
namespace {

using Parameters = std::span<const double>;
using Gradient = std::span<double>;
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kTiny = 1e-12;
constexpr double kHuge = 1e12;

// Logistic, Yi 2018 eq. 1-2: X = Xm / (1 + u), u = (Xm/X0 - 1) e^(-rt). p = X0, Xm, r.
namespace logistic {
constexpr std::array<ParameterSpec, 3> kParameters{{
    {"x0", "X0", "size", 2, kTiny, kHuge, "size at age 0", "Yi 2018 eq. 1, Table 2"},
    {"xm", "Xm", "size", 100, kTiny, kHuge, "final size", "Yi 2018 eq. 1, Table 2"},
    {"r", "r", "1/time", 0.34, kTiny, 1e6, "intrinsic growth rate", "Yi 2018 eq. 1, Table 2"},
}};
double u(Parameters p, double t) {
  return (p[1] / p[0] - 1) * std::exp(-p[2] * t);
}
// u / (1+u)^2, safe where u overflows.
double slope(double u) {
  return std::isinf(u) ? 0 : u / (1 + u) / (1 + u);
}
double value(Parameters p, double t) {
  return p[1] / (1 + u(p, t));
}
double rate(Parameters p, double t) {
  return p[2] * p[1] * slope(u(p, t));
}  // = r X (1 - X/Xm), eq. 2
void gradient(Parameters p, double t, Gradient g) {
  const double e = std::exp(-p[2] * t), ratio = p[1] / p[0], w = (ratio - 1) * e, s = 1 / (1 + w);
  const bool far = std::isinf(e) || std::isinf(w);
  g[0] = far ? 0 : s * s * ratio * ratio * e;
  g[1] = far ? 0 : s * s * (1 - e);
  g[2] = p[1] * t * slope(w);
}
double inflection(Parameters p) {
  return p[1] > p[0] ? std::log(p[1] / p[0] - 1) / p[2] : kNaN;
}
double age(Parameters p, double x) {
  const double k = p[1] / p[0] - 1, v = p[1] / x - 1;
  return x > 0 && k / v > 0 ? std::log(k / v) / p[2] : kNaN;
}
}  // namespace logistic

// Bertalanffy, Yi 2018 eq. 3: X = b1 (1 - e^(-b2 t))^3.
namespace bertalanffy {
constexpr std::array<ParameterSpec, 2> kParameters{{
    {"beta1", "b1", "size", 100, kTiny, kHuge, "final size", "Yi 2018 eq. 3"},
    {"beta2", "b2", "1/time", 0.15, kTiny, 1e6, "growth rate", "Yi 2018 eq. 3"},
}};
double grown(Parameters p, double t) {
  return t > 0 ? -std::expm1(-p[1] * t) : 0;
}
double value(Parameters p, double t) {
  const double m = grown(p, t);
  return p[0] * m * m * m;
}
double rate(Parameters p, double t) {
  const double m = grown(p, t);
  return 3 * p[0] * p[1] * (1 - m) * m * m;
}
void gradient(Parameters p, double t, Gradient g) {
  const double m = grown(p, t);
  g[0] = m * m * m;
  g[1] = 3 * p[0] * t * std::exp(-p[1] * std::max(0.0, t)) * m * m;
}
double inflection(Parameters p) {
  return std::log(3.0) / p[1];
}
double age(Parameters p, double x) {
  return x >= 0 && x < p[0] ? -std::log1p(-std::cbrt(x / p[0])) / p[1] : kNaN;
}
}  // namespace bertalanffy

// Weibull, Yi 2018: X = w1 (1 - e^(-w2 t^w3)).
namespace weibull {
constexpr std::array<ParameterSpec, 3> kParameters{{
    {"omega1", "w1", "size", 100, kTiny, kHuge, "final size", "Yi 2018, Weibull"},
    {"omega2", "w2", "1/time^w3", 0.006, 1e-300, kHuge, "rate; the scale age is w2^(-1/w3)",
     "Yi 2018, Weibull"},
    {"omega3", "w3", "", 2, 1e-3, 100, "shape; above 1 the curve has an inflection", "Yi 2018, Weibull"},
}};
double power(Parameters p, double t) {
  return t > 0 ? p[1] * std::pow(t, p[2]) : 0;
}
double value(Parameters p, double t) {
  return -p[0] * std::expm1(-power(p, t));
}
double rate(Parameters p, double t) {
  if (t <= 0) return p[2] == 1 && t == 0 ? p[0] * p[1] : 0;
  const double z = power(p, t);
  return p[0] * p[2] * (z / t) * std::exp(-z);
}
void gradient(Parameters p, double t, Gradient g) {
  const double z = power(p, t), left = p[0] * z * std::exp(-z);
  g[0] = -std::expm1(-z);
  g[1] = left / p[1];
  g[2] = t > 0 ? left * std::log(t) : 0;
}
double inflection(Parameters p) {
  return p[2] > 1 ? std::pow((p[2] - 1) / (p[1] * p[2]), 1 / p[2]) : kNaN;
}
double age(Parameters p, double x) {
  return x >= 0 && x < p[0] ? std::pow(-std::log1p(-x / p[0]) / p[1], 1 / p[2]) : kNaN;
}
}  // namespace weibull

// Gompertz: X = a exp(-b e^(-ct)).
namespace gompertz {
constexpr std::array<ParameterSpec, 3> kParameters{{
    {"a", "a", "size", 100, kTiny, kHuge, "final size", "Zeide 1993"},
    {"b", "b", "", 4, kTiny, kHuge, "ln(final size / size at age 0)", "Zeide 1993"},
    {"c", "c", "1/time", 0.2, kTiny, 1e6, "growth rate", "Zeide 1993"},
}};
double power(Parameters p, double t) {
  return p[1] * std::exp(-p[2] * t);
}
double slope(double z) {
  return std::isinf(z) ? 0 : z * std::exp(-z);
}
double value(Parameters p, double t) {
  return p[0] * std::exp(-power(p, t));
}
double rate(Parameters p, double t) {
  return p[0] * p[2] * slope(power(p, t));
}
void gradient(Parameters p, double t, Gradient g) {
  const double z = power(p, t);
  g[0] = std::exp(-z);
  g[1] = -p[0] * slope(z) / p[1];
  g[2] = p[0] * t * slope(z);
}
double inflection(Parameters p) {
  return std::log(p[1]) / p[2];
}
double age(Parameters p, double x) {
  return x > 0 && x < p[0] ? std::log(p[1] / std::log(p[0] / x)) / p[2] : kNaN;
}
}  // namespace gompertz

// Chapman-Richards: X = a (1 - e^(-bt))^c.
namespace chapman_richards {
constexpr std::array<ParameterSpec, 3> kParameters{{
    {"a", "a", "size", 100, kTiny, kHuge, "final size", "Zeide 1993"},
    {"b", "b", "1/time", 0.15, kTiny, 1e6, "growth rate", "Zeide 1993"},
    {"c", "c", "", 3, 1e-3, 1e3, "shape; above 1 the curve has an inflection", "Zeide 1993"},
}};
double value(Parameters p, double t) {
  return t > 0 ? p[0] * std::pow(-std::expm1(-p[1] * t), p[2]) : 0;
}
double rate(Parameters p, double t) {
  if (t <= 0) return p[2] == 1 && t == 0 ? p[0] * p[1] : 0;
  return p[0] * p[1] * p[2] * std::exp(-p[1] * t) * std::pow(-std::expm1(-p[1] * t), p[2] - 1);
}
void gradient(Parameters p, double t, Gradient g) {
  g[0] = g[1] = g[2] = 0;
  if (t <= 0) return;
  const double m = -std::expm1(-p[1] * t), power = std::pow(m, p[2]);
  g[0] = power;
  g[1] = p[0] * p[2] * t * std::exp(-p[1] * t) * power / m;
  g[2] = power > 0 ? p[0] * power * std::log(m) : 0;
}
double inflection(Parameters p) {
  return p[2] > 1 ? std::log(p[2]) / p[1] : kNaN;
}
double age(Parameters p, double x) {
  return x >= 0 && x < p[0] ? -std::log1p(-std::pow(x / p[0], 1 / p[2])) / p[1] : kNaN;
}
}  // namespace chapman_richards

// Korf: X = a exp(-b t^(-c)).
namespace korf {
constexpr std::array<ParameterSpec, 3> kParameters{{
    {"a", "a", "size", 100, kTiny, kHuge, "final size", "Zeide 1993"},
    {"b", "b", "time^c", 10, kTiny, 1e300, "scale", "Zeide 1993"},
    {"c", "c", "", 1, 1e-3, 100, "shape", "Zeide 1993"},
}};
double power(Parameters p, double t) {
  return p[1] * std::pow(t, -p[2]);
}
double value(Parameters p, double t) {
  return t > 0 ? p[0] * std::exp(-power(p, t)) : 0;
}
double rate(Parameters p, double t) {
  const double x = value(p, t);
  return x > 0 ? p[2] * power(p, t) / t * x : 0;
}
void gradient(Parameters p, double t, Gradient g) {
  g[0] = g[1] = g[2] = 0;
  const double x = value(p, t);
  if (x <= 0) return;
  const double z = power(p, t);
  g[0] = x / p[0];
  g[1] = -x * z / p[1];
  g[2] = x * z * std::log(t);
}
double inflection(Parameters p) {
  return std::pow(p[1] * p[2] / (p[2] + 1), 1 / p[2]);
}
double age(Parameters p, double x) {
  if (x == 0) return 0;
  return x > 0 && x < p[0] ? std::pow(p[1] / std::log(p[0] / x), 1 / p[2]) : kNaN;
}
}  // namespace korf

// Hossfeld IV: X = t^c / (b + t^c / a).
namespace hossfeld4 {
constexpr std::array<ParameterSpec, 3> kParameters{{
    {"a", "a", "size", 100, kTiny, kHuge, "final size", "Zeide 1993"},
    {"b", "b", "time^c/size", 1, 1e-300, 1e300, "scale", "Zeide 1993"},
    {"c", "c", "", 2, 1e-3, 100, "shape; above 1 the curve has an inflection", "Zeide 1993"},
}};
// b t^(-c), so that X = 1 / (power + 1/a).
double power(Parameters p, double t) {
  return p[1] * std::pow(t, -p[2]);
}
double value(Parameters p, double t) {
  return t > 0 ? 1 / (power(p, t) + 1 / p[0]) : 0;
}
double rate(Parameters p, double t) {
  const double x = value(p, t);
  if (t == 0 && p[2] == 1) return 1 / p[1];
  return x > 0 ? p[2] * power(p, t) / t * x * x : 0;
}
void gradient(Parameters p, double t, Gradient g) {
  g[0] = g[1] = g[2] = 0;
  const double x = value(p, t);
  if (x <= 0) return;
  const double z = power(p, t);
  g[0] = (x / p[0]) * (x / p[0]);
  g[1] = -x * x * z / p[1];
  g[2] = x * x * z * std::log(t);
}
double inflection(Parameters p) {
  return p[2] > 1 ? std::pow(p[0] * p[1] * (p[2] - 1) / (p[2] + 1), 1 / p[2]) : kNaN;
}
double age(Parameters p, double x) {
  if (x == 0) return 0;
  return x > 0 && x < p[0] ? std::pow(p[1] / (1 / x - 1 / p[0]), 1 / p[2]) : kNaN;
}
}  // namespace hossfeld4

// Monomolecular: X = a (1 - c e^(-bt)).
namespace monomolecular {
constexpr std::array<ParameterSpec, 3> kParameters{{
    {"a", "a", "size", 100, kTiny, kHuge, "final size", "Zeide 1993"},
    {"c", "c", "", 1, kTiny, kHuge, "1 - size at age 0 / final size", "Zeide 1993"},
    {"b", "b", "1/time", 0.1, kTiny, 1e6, "growth rate", "Zeide 1993"},
}};
double value(Parameters p, double t) {
  return p[0] * ((1 - p[1]) - p[1] * std::expm1(-p[2] * t));
}
double rate(Parameters p, double t) {
  return p[0] * p[1] * p[2] * std::exp(-p[2] * t);
}
void gradient(Parameters p, double t, Gradient g) {
  const double e = std::exp(-p[2] * t);
  g[0] = (1 - p[1]) - p[1] * std::expm1(-p[2] * t);
  g[1] = -p[0] * e;
  g[2] = p[0] * p[1] * t * e;
}
double inflection(Parameters) {
  return kNaN;
}
double age(Parameters p, double x) {
  return x < p[0] ? -std::log((1 - x / p[0]) / p[1]) / p[2] : kNaN;
}
}  // namespace monomolecular

// Richards (generalised logistic): X = a / (1 + e^(b-ct))^(1/d).
namespace richards {
constexpr std::array<ParameterSpec, 4> kParameters{{
    {"a", "a", "size", 100, kTiny, kHuge, "final size", "Richards 1959"},
    {"b", "b", "", 4, -1e4, 1e4, "position on the time axis", "Richards 1959"},
    {"c", "c", "1/time", 0.34, kTiny, 1e6, "growth rate", "Richards 1959"},
    {"d", "d", "", 1, 1e-4, 1e4, "shape; 1 is the logistic", "Richards 1959"},
}};
// ln(1 + e^x) without overflow, and its derivative.
double softplus(double x) {
  return x > 0 ? x + std::log1p(std::exp(-x)) : std::log1p(std::exp(x));
}
double share(double x) {
  return 1 / (1 + std::exp(-x));
}
double value(Parameters p, double t) {
  return p[0] * std::exp(-softplus(p[1] - p[2] * t) / p[3]);
}
double rate(Parameters p, double t) {
  return value(p, t) * share(p[1] - p[2] * t) * p[2] / p[3];
}
void gradient(Parameters p, double t, Gradient g) {
  const double x = p[1] - p[2] * t, size = value(p, t);
  g[0] = size / p[0];
  g[1] = -size * share(x) / p[3];
  g[2] = -t * g[1];
  g[3] = size * softplus(x) / (p[3] * p[3]);
}
double inflection(Parameters p) {
  return (p[1] - std::log(p[3])) / p[2];
}
double age(Parameters p, double x) {
  return x > 0 && x < p[0] ? (p[1] - std::log(std::expm1(p[3] * std::log(p[0] / x)))) / p[2] : kNaN;
}
}  // namespace richards

#define DENDROFIT_EQUATION(ns) ns::value, ns::rate, ns::gradient, ns::inflection, ns::age
constexpr std::array<GrowthEquation, 9> kEquations{{
    {"logistic", "logistic", "Xm / (1 + (Xm/X0 - 1) exp(-r t))", logistic::kParameters, false, 1,
     DENDROFIT_EQUATION(logistic)},
    {"bertalanffy", "Bertalanffy", "b1 (1 - exp(-b2 t))^3", bertalanffy::kParameters, true, 0,
     DENDROFIT_EQUATION(bertalanffy)},
    {"weibull", "Weibull", "w1 (1 - exp(-w2 t^w3))", weibull::kParameters, true, 0,
     DENDROFIT_EQUATION(weibull)},
    {"gompertz", "Gompertz", "a exp(-b exp(-c t))", gompertz::kParameters, false, 0,
     DENDROFIT_EQUATION(gompertz)},
    {"chapman_richards", "Chapman-Richards", "a (1 - exp(-b t))^c", chapman_richards::kParameters, true, 0,
     DENDROFIT_EQUATION(chapman_richards)},
    {"korf", "Korf", "a exp(-b t^(-c))", korf::kParameters, true, 0, DENDROFIT_EQUATION(korf)},
    {"hossfeld4", "Hossfeld IV", "t^c / (b + t^c / a)", hossfeld4::kParameters, true, 0,
     DENDROFIT_EQUATION(hossfeld4)},
    {"monomolecular", "monomolecular", "a (1 - c exp(-b t))", monomolecular::kParameters, false, 0,
     DENDROFIT_EQUATION(monomolecular)},
    {"richards", "Richards", "a / (1 + exp(b - c t))^(1/d)", richards::kParameters, false, 0,
     DENDROFIT_EQUATION(richards)},
}};
#undef DENDROFIT_EQUATION

}  // namespace

std::span<const GrowthEquation> growth_equations() {
  return kEquations;
}

const GrowthEquation& growth_equation(std::string_view name) {
  std::vector<std::string> known;
  for (const GrowthEquation& equation : kEquations) {
    if (equation.name == name) return equation;
    known.emplace_back(equation.name);
  }
  throw InputError("unknown growth equation '" + std::string(name) + "'; did you mean '" +
                   nearest_word(name, known) + "'?");
}

}  // namespace dendrofit
