// SPDX-License-Identifier: GPL-3.0-or-later
#include "fit/growth_allometry.h"

#include "core/errors.h"
#include "fit/growth_fit.h"
#include "fit/growth_statistics.h"
#include "fit/growth_units.h"
#include "forward/growth_equations.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Dense>

namespace dendrofit {
namespace {

// Residuals and derivatives by a and b.
double linearise(const std::vector<double>& x, const std::vector<double>& y, double base,
                 const Eigen::Vector2d& p, Eigen::VectorXd& residuals, Eigen::MatrixX2d& jacobian) {
  const auto n = static_cast<Eigen::Index>(x.size());
  residuals.resize(n);
  jacobian.resize(n, 2);
  for (Eigen::Index i = 0; i < n; ++i) {
    const double power = std::pow(x[i], p[1]);
    residuals[i] = base + p[0] * power - y[i];
    jacobian(i, 0) = power;
    jacobian(i, 1) = p[0] * power * std::log(x[i]);
  }
  const double rss = residuals.squaredNorm();
  return std::isfinite(rss) && jacobian.allFinite() ? rss : std::numeric_limits<double>::infinity();
}

}  // namespace

double PowerLawFit::value(double x) const {
  return base + a.value * std::pow(x, b.value);
}

PowerLawFit fit_power_law(const std::vector<double>& x, const std::vector<double>& y, double base,
                          const std::vector<double>& start, double confidence) {
  require(x.size() == y.size(), "y", static_cast<double>(y.size()), "must have as many values as x");
  require(confidence > 0 && confidence < 1, "confidence", confidence, "must be between 0 and 1");
  require(start.empty() || start.size() == 2, "start", static_cast<double>(start.size()), "must be a and b");
  PowerLawFit fit;
  fit.base = base;
  fit.n = static_cast<int>(x.size());
  fit.a.name = "a";
  fit.b.name = "b";
  for (std::size_t i = 0; i < x.size(); ++i)
    if (!(x[i] > 0) || !std::isfinite(x[i]) || !std::isfinite(y[i])) {
      fit.reason = "power law: row " + std::to_string(i + 1) + " (x " + std::to_string(x[i]) + ", y " +
                   std::to_string(y[i]) + ") cannot be used: diameters must be above 0 and heights numbers";
      return fit;
    }
  std::vector<double> distinct = x;
  std::sort(distinct.begin(), distinct.end());
  distinct.erase(std::unique(distinct.begin(), distinct.end()), distinct.end());
  if (fit.n < 3 || distinct.size() < 2) {
    fit.status = GrowthStatus::too_few_points;
    fit.reason = "power law: " + std::to_string(fit.n) + " trees of " + std::to_string(distinct.size()) +
                 " diameters for 2 parameters: measure at least 3 trees of different diameters";
    return fit;
  }
  Eigen::Vector2d p(1, 1);
  if (start.size() == 2) {
    p = {start[0], start[1]};
  } else {
    double n = 0, sx = 0, sy = 0, sxx = 0, sxy = 0;
    for (std::size_t i = 0; i < x.size(); ++i) {
      if (!(y[i] > base)) continue;
      const double u = std::log(x[i]), v = std::log(y[i] - base);
      n += 1, sx += u, sy += v, sxx += u * u, sxy += u * v;
    }
    const double spread = n * sxx - sx * sx;
    if (spread > 0) p[1] = (n * sxy - sx * sy) / spread;
    if (n > 0) p[0] = std::exp((sy - p[1] * sx) / n);
  }
  Eigen::VectorXd residuals;
  Eigen::MatrixX2d jacobian;
  double rss = linearise(x, y, base, p, residuals, jacobian), damping = 1e-3;
  for (int i = 0; i < 500 && damping < 1e12; ++i) {
    const Eigen::Vector2d scale = jacobian.colwise().norm();
    Eigen::MatrixX2d system(jacobian.rows() + 2, 2);
    system << jacobian, Eigen::Matrix2d((std::sqrt(damping) * scale).asDiagonal());
    Eigen::VectorXd right(residuals.size() + 2);
    right << -residuals, 0, 0;
    const Eigen::Vector2d step = system.colPivHouseholderQr().solve(right);
    Eigen::VectorXd next_residuals;
    Eigen::MatrixX2d next_jacobian;
    const double next = linearise(x, y, base, p + step, next_residuals, next_jacobian);
    if (next <= rss) {
      const bool done = step.cwiseAbs().cwiseQuotient(p.cwiseAbs().cwiseMax(1e-300)).maxCoeff() < 1e-14;
      p += step;
      rss = next;
      residuals = next_residuals;
      jacobian = next_jacobian;
      damping *= 0.1;
      if (done) break;
    } else {
      damping = std::max(10 * damping, 1e-12);
    }
  }
  fit.rss = rss;
  fit.sigma = std::sqrt(rss / (fit.n - 2));
  const Eigen::Vector2d norms = jacobian.colwise().norm();
  const Eigen::Matrix2d normal =
      norms.cwiseInverse().asDiagonal() * jacobian.transpose() * jacobian * norms.cwiseInverse().asDiagonal();
  if (!(normal.determinant() > 1e-14)) {
    fit.status = GrowthStatus::ill_conditioned;
    fit.reason =
        "power law: the diameters are too alike to tell factor and exponent: add thinner or thicker trees";
    return fit;
  }
  const Eigen::Vector2d se = fit.sigma * normal.inverse().diagonal().cwiseSqrt().cwiseQuotient(norms);
  const double quantile = student_t_two_sided(confidence, fit.n - 2);
  for (int k = 0; k < 2; ++k) {
    GrowthParameter& parameter = k == 0 ? fit.a : fit.b;
    parameter.value = p[k];
    parameter.se = se[k];
    parameter.lo = p[k] - quantile * se[k];
    parameter.hi = p[k] + quantile * se[k];
  }
  fit.status = GrowthStatus::ok;
  return fit;
}

GrowthFit fit_height_diameter(const std::vector<double>& diameter, const std::vector<double>& height,
                              const std::string& equation, const GrowthOptions& options) {
  if (!growth_equation(equation).starts_at_zero)
    throw InputError(
        "height over diameter: the " + std::string(growth_equation(equation).title) +
        " does not start from 1.3 m; use weibull, chapman_richards, korf, hossfeld4 or bertalanffy");
  GrowthOptions own = options;
  own.equations = {equation};
  own.offset = 1.3 * unit_factor("m", options.value_unit);
  own.time_unit = "of diameter";
  MeasurementSeries series{"height over diameter", diameter, height};
  return fit_growth_equation(series, equation, own);
}

}  // namespace dendrofit
