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
#include <numbers>

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

// The power law with its bands (delta method), as the other forms come.
GrowthFit power_law_as_growth(const MeasurementSeries& trees, double base, const GrowthOptions& options) {
  const PowerLawFit power = fit_power_law(trees.time, trees.value, base, {}, options.confidence);
  GrowthFit fit;
  fit.equation = "power";
  fit.status = power.status;
  fit.reason = power.reason;
  fit.n = power.n;
  fit.parameters = {power.a, power.b};
  fit.rss = power.rss;
  fit.sigma = power.sigma;
  if (fit.status != GrowthStatus::ok) return fit;
  const double n = power.n, k = 3;
  const double deviance = n * (std::log(2 * std::numbers::pi * power.rss / n) + 1);
  fit.aic = deviance + 2 * k;
  fit.bic = deviance + k * std::log(n);
  fit.aicc = n > k + 1 ? fit.aic + 2 * k * (k + 1) / (n - k - 1) : std::numeric_limits<double>::infinity();
  fit.covariance = power.covariance;
  fit.derived.asymptote = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < trees.time.size(); ++i)
    fit.residuals.push_back(trees.value[i] - power.value(trees.time[i]));
  const double quantile = student_t_two_sided(options.confidence, power.n - 2);
  const double last = *std::max_element(trees.time.begin(), trees.time.end());
  std::vector<double> diameters = options.band_times;
  for (int i = 0; i <= 60 && options.band_times.empty(); ++i) diameters.push_back(last * i / 60);
  for (const double d : diameters) {
    GrowthBandPoint point;
    point.time = d;
    point.fit = d > 0 ? power.value(d) : base;
    const double grown = d > 0 ? std::pow(d, power.b.value) : 0;
    const Eigen::Vector2d g(grown, d > 0 ? power.a.value * grown * std::log(d) : 0);
    point.se = std::sqrt(g.dot(power.covariance * g));
    const double wide = quantile * std::hypot(point.se, power.sigma);
    point.confidence_lo = point.fit - quantile * point.se;
    point.confidence_hi = point.fit + quantile * point.se;
    point.prediction_lo = point.fit - wide;
    point.prediction_hi = point.fit + wide;
    point.cai = d > 0 ? power.b.value * power.a.value * grown / d : kGrowthNaN;
    point.mai = d > 0 ? point.fit / d : kGrowthNaN;
    fit.bands.push_back(point);
  }
  return fit;
}

// Messages call the trees by their own name.
void name_trees(GrowthFit& fit, const std::string& name) {
  const auto rename = [&](std::string& text) {
    const std::string general = "series 'height over diameter'";
    if (const auto at = text.find(general); at != std::string::npos)
      text.replace(at, general.size(), "series '" + name + "'");
    else if (text.starts_with("power law"))
      text = "series '" + name + "', " + text;
  };
  rename(fit.reason);
  for (std::string& warning : fit.warnings) rename(warning);
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
  fit.covariance = fit.sigma * fit.sigma *
                   (norms.cwiseInverse().asDiagonal() * normal.inverse() * norms.cwiseInverse().asDiagonal());
  const Eigen::Vector2d se = fit.covariance.diagonal().cwiseSqrt();
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
        " does not start from 1.3 m; use power, weibull, chapman_richards, korf, hossfeld4 or bertalanffy");
  GrowthOptions own = options;
  own.equations = {equation};
  own.offset = 1.3 * unit_factor("m", options.value_unit);
  own.abscissa = "diameter";
  MeasurementSeries series{"height over diameter", diameter, height};
  GrowthFit fit = fit_growth_equation(series, equation, own);
  fit.derived.mai_culmination_age = fit.derived.max_mai = fit.derived.years_to_breast_height = kGrowthNaN;
  return fit;
}

GrowthReport fit_allometry(const std::vector<MeasurementSeries>& series,
                           const std::vector<std::string>& forms, const GrowthOptions& options,
                           Progress& progress) {
  if (series.empty())
    throw InputError("no trees: expected a table with the columns dbh,height and a row a tree");
  const double breast_height = 1.3 * unit_factor("m", options.value_unit);
  GrowthReport report;
  report.abscissa = "diameter";
  report.ordinate = "height";
  report.time_unit = options.time_unit;
  report.value_unit = options.value_unit;
  report.confidence = options.confidence;
  const auto fit_all = [&](const MeasurementSeries& trees) {
    progress.check();
    GrowthSeries result;
    result.name = trees.name;
    result.time = trees.time;
    result.value = trees.value;
    for (const std::string& form : forms)
      result.fits.push_back(form == "power" ? power_law_as_growth(trees, breast_height, options)
                                            : fit_height_diameter(trees.time, trees.value, form, options));
    for (GrowthFit& fit : result.fits) name_trees(fit, trees.name);
    for (const GrowthFit& fit : result.fits)
      if (fit.status == GrowthStatus::ok && std::isfinite(fit.aicc) &&
          (result.best.empty() || fit.aicc < result.fit(result.best)->aicc))
        result.best = fit.equation;
    return result;
  };
  MeasurementSeries all{"pooled", {}, {}};
  for (const MeasurementSeries& trees : series) {
    report.series.push_back(fit_all(trees));
    all.time.insert(all.time.end(), trees.time.begin(), trees.time.end());
    all.value.insert(all.value.end(), trees.value.begin(), trees.value.end());
    if (report.series.back().best.empty())
      for (const GrowthFit& fit : report.series.back().fits) report.warnings.push_back(fit.reason);
  }
  if (series.size() > 1 && options.pooled) report.pooled = fit_all(all);
  return report;
}

}  // namespace dendrofit
