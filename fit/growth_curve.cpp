// SPDX-License-Identifier: GPL-3.0-or-later
#include "fit/growth_curve.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace dendrofit {
namespace {

// Beyond e^(+-600) a size or rate means nothing and products overflow.
constexpr double kLargestExponent = 600;
double bounded_exp(double x) {
  return std::exp(std::clamp(x, -kLargestExponent, kLargestExponent));
}

// One equation's shape chart. `slot[i]`: the coordinate that alone decides natural parameter i, or -1.
struct ShapeChart {
  std::string_view equation;
  std::array<int, 4> slot;
  void (*to_shape)(const double* p, double* c);
  void (*to_natural)(const double* c, double* p, GrowthMatrix* j);
};

void set(GrowthMatrix* j, int row, int column, double value) {
  if (j) (*j)(row, column) = value;
}

// Logistic p = X0, Xm, r; c = ln Xm, ln r, inflection age; X0 = Xm / (1 + e^(r ti)).
void logistic_to_shape(const double* p, double* c) {
  c[0] = std::log(p[1]);
  c[1] = std::log(p[2]);
  c[2] = std::log(std::max(p[1] / p[0] - 1, 1e-12)) / p[2];
}
void logistic_to_natural(const double* c, double* p, GrowthMatrix* j) {
  const double xm = bounded_exp(c[0]), r = bounded_exp(c[1]), x = r * c[2];
  const double e = bounded_exp(-std::abs(x)), q = x > 0 ? e / (1 + e) : 1 / (1 + e);
  p[0] = xm * q;
  p[1] = xm;
  p[2] = r;
  const double by_age = -p[0] * r * (x > 0 ? 1 / (1 + e) : e / (1 + e));
  set(j, 0, 0, p[0]);
  set(j, 0, 1, by_age * c[2]);
  set(j, 0, 2, by_age);
  set(j, 1, 0, xm);
  set(j, 2, 1, r);
}

// Parameters that are all positive and independent: logarithms, in the table's order.
template <int N>
void log_to_shape(const double* p, double* c) {
  for (int i = 0; i < N; ++i) c[i] = std::log(p[i]);
}
template <int N>
void log_to_natural(const double* c, double* p, GrowthMatrix* j) {
  for (int i = 0; i < N; ++i) {
    p[i] = bounded_exp(c[i]);
    set(j, i, i, p[i]);
  }
}

// Weibull p = w1, w2, w3; c = ln w1, ln L, ln w3; w2 = L^(-w3).
void weibull_to_shape(const double* p, double* c) {
  c[0] = std::log(p[0]);
  c[1] = -std::log(p[1]) / p[2];
  c[2] = std::log(p[2]);
}
void weibull_to_natural(const double* c, double* p, GrowthMatrix* j) {
  p[0] = bounded_exp(c[0]);
  p[2] = bounded_exp(c[2]);
  p[1] = bounded_exp(-c[1] * p[2]);
  set(j, 0, 0, p[0]);
  set(j, 1, 1, -p[2] * p[1]);
  set(j, 1, 2, -p[2] * c[1] * p[1]);
  set(j, 2, 2, p[2]);
}

// Gompertz p = a, b, c; c = ln a, ln c, inflection age; b = e^(c ti).
// Monomolecular p = a, c, b; c = ln a, ln b, age of size 0; c = e^(b t0).
void dated_to_shape(const double* p, double* c) {
  c[0] = std::log(p[0]);
  c[1] = std::log(p[2]);
  c[2] = std::log(p[1]) / p[2];
}
void dated_to_natural(const double* c, double* p, GrowthMatrix* j) {
  p[0] = bounded_exp(c[0]);
  p[2] = bounded_exp(c[1]);
  p[1] = bounded_exp(p[2] * c[2]);
  set(j, 0, 0, p[0]);
  set(j, 1, 1, p[1] * p[2] * c[2]);
  set(j, 1, 2, p[1] * p[2]);
  set(j, 2, 1, p[2]);
}

// Korf p = a, b, c; c = ln a, ln L, ln c; b = L^c, so that X(L) = a/e.
void korf_to_shape(const double* p, double* c) {
  c[0] = std::log(p[0]);
  c[1] = std::log(p[1]) / p[2];
  c[2] = std::log(p[2]);
}
void korf_to_natural(const double* c, double* p, GrowthMatrix* j) {
  p[0] = bounded_exp(c[0]);
  p[2] = bounded_exp(c[2]);
  p[1] = bounded_exp(c[1] * p[2]);
  set(j, 0, 0, p[0]);
  set(j, 1, 1, p[2] * p[1]);
  set(j, 1, 2, p[2] * c[1] * p[1]);
  set(j, 2, 2, p[2]);
}

// Hossfeld IV p = a, b, c; c = ln a, ln L, ln c; b = L^c / a, so that X(L) = a/2.
void hossfeld_to_shape(const double* p, double* c) {
  c[0] = std::log(p[0]);
  c[1] = (std::log(p[0]) + std::log(p[1])) / p[2];
  c[2] = std::log(p[2]);
}
void hossfeld_to_natural(const double* c, double* p, GrowthMatrix* j) {
  p[0] = bounded_exp(c[0]);
  p[2] = bounded_exp(c[2]);
  p[1] = bounded_exp(c[1] * p[2] - c[0]);
  set(j, 0, 0, p[0]);
  set(j, 1, 0, -p[1]);
  set(j, 1, 1, p[2] * p[1]);
  set(j, 1, 2, p[2] * c[1] * p[1]);
  set(j, 2, 2, p[2]);
}

// Richards p = a, b, c, d; c = ln a, ln c, inflection age, ln d; b = c ti + ln d.
void richards_to_shape(const double* p, double* c) {
  c[0] = std::log(p[0]);
  c[1] = std::log(p[2]);
  c[3] = std::log(p[3]);
  c[2] = (p[1] - c[3]) / p[2];
}
void richards_to_natural(const double* c, double* p, GrowthMatrix* j) {
  p[0] = bounded_exp(c[0]);
  p[2] = bounded_exp(c[1]);
  p[3] = bounded_exp(c[3]);
  p[1] = p[2] * c[2] + c[3];
  set(j, 0, 0, p[0]);
  set(j, 1, 1, p[2] * c[2]);
  set(j, 1, 2, p[2]);
  set(j, 1, 3, 1);
  set(j, 2, 1, p[2]);
  set(j, 3, 3, p[3]);
}

constexpr std::array<ShapeChart, 9> kShapeCharts{{
    {"logistic", {-1, 0, 1, -1}, logistic_to_shape, logistic_to_natural},
    {"bertalanffy", {0, 1, -1, -1}, log_to_shape<2>, log_to_natural<2>},
    {"weibull", {0, -1, 2, -1}, weibull_to_shape, weibull_to_natural},
    {"gompertz", {0, -1, 1, -1}, dated_to_shape, dated_to_natural},
    {"chapman_richards", {0, 1, 2, -1}, log_to_shape<3>, log_to_natural<3>},
    {"korf", {0, -1, 2, -1}, korf_to_shape, korf_to_natural},
    {"hossfeld4", {0, -1, 2, -1}, hossfeld_to_shape, hossfeld_to_natural},
    {"monomolecular", {0, -1, 1, -1}, dated_to_shape, dated_to_natural},
    {"richards", {0, -1, 1, 3}, richards_to_shape, richards_to_natural},
}};

const ShapeChart& shape_chart(const GrowthEquation& equation) {
  return kShapeCharts[static_cast<std::size_t>(&equation - growth_equations().data())];
}
static_assert(kShapeCharts.size() == 9, "one shape chart per growth equation, in the table's order");

}  // namespace

std::string GrowthCurve::name(int i) const {
  if (i < own_size()) return std::string(equation_->parameters[i].symbol);
  return offset_ && i == own_size() ? "offset" : "time_shift";
}

std::string GrowthCurve::unit(int i) const {
  if (i < own_size()) return std::string(equation_->parameters[i].unit);
  return offset_ && i == own_size() ? "size" : "time";
}

int GrowthCurve::row(std::string_view wanted) const {
  for (int i = 0; i < size(); ++i)
    if (name(i) == wanted || (i < own_size() && equation_->parameters[i].key == wanted)) return i;
  return -1;
}

double GrowthCurve::value(const GrowthVector& natural, double t) const {
  return offset_of(natural) + equation_->value(own(natural), t + shift_of(natural));
}

double GrowthCurve::rate(const GrowthVector& natural, double t) const {
  return equation_->rate(own(natural), t + shift_of(natural));
}

void GrowthCurve::gradient(const GrowthVector& natural, double t, GrowthVector& g) const {
  g.resize(size());
  equation_->gradient(own(natural), t + shift_of(natural), {g.data(), equation_->parameters.size()});
  if (offset_) g[own_size()] = 1;
  if (shift_) g[size() - 1] = rate(natural, t);
}

double GrowthCurve::asymptote(const GrowthVector& natural) const {
  return offset_of(natural) + natural[asymptote_row()];
}

double GrowthCurve::inflection_age(const GrowthVector& natural) const {
  return equation_->inflection_age(own(natural)) - shift_of(natural);
}

double GrowthCurve::age_at(const GrowthVector& natural, double x) const {
  return equation_->age_at(own(natural), x - offset_of(natural)) - shift_of(natural);
}

std::optional<int> GrowthCurve::coordinate(GrowthChart chart, int i) const {
  if (i >= own_size() || chart == GrowthChart::natural) return i;
  const int slot = shape_chart(*equation_).slot[i];
  return slot < 0 ? std::nullopt : std::optional<int>(slot);
}

GrowthVector GrowthCurve::to_chart(GrowthChart chart, const GrowthVector& natural) const {
  GrowthVector c = natural;
  if (chart == GrowthChart::shape)
    shape_chart(*equation_).to_shape(natural.data(), c.data());
  else
    for (int i = 0; i < own_size(); ++i)
      if (is_positive(i)) c[i] = std::log(natural[i]);
  return c;
}

GrowthVector GrowthCurve::to_natural(GrowthChart chart, const GrowthVector& c, GrowthMatrix* jacobian) const {
  GrowthVector natural = c;
  if (jacobian) {
    jacobian->setZero(size(), size());
    for (int i = own_size(); i < size(); ++i) (*jacobian)(i, i) = 1;
  }
  if (chart == GrowthChart::shape) {
    shape_chart(*equation_).to_natural(c.data(), natural.data(), jacobian);
    return natural;
  }
  for (int i = 0; i < own_size(); ++i) {
    if (is_positive(i)) natural[i] = bounded_exp(c[i]);
    if (jacobian) (*jacobian)(i, i) = is_positive(i) ? natural[i] : 1;
  }
  return natural;
}

}  // namespace dendrofit
