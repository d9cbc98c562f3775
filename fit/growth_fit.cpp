// SPDX-License-Identifier: GPL-3.0-or-later
#include "fit/growth_fit.h"

#include "core/errors.h"
#include "fit/growth_constraints.h"
#include "fit/growth_curve.h"
#include "fit/growth_derived.h"
#include "fit/growth_diagnose.h"
#include "fit/growth_optimum.h"
#include "fit/growth_profile.h"
#include "fit/growth_solver.h"
#include "fit/growth_start.h"
#include "fit/growth_statistics.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include <Eigen/Dense>

namespace dendrofit {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// Whether the measured ages lie on the two ends of the curve only, so that it is a step.
bool is_step(const GrowthCurve& curve, const GrowthVector& natural, const GrowthData& data, int free) {
  std::vector<double> ages;
  const double size = natural[curve.asymptote_row()], foot = curve.asymptote(natural) - size;
  for (double t : data.time) {
    const double share = (curve.value(natural, t) - foot) / size;
    if (share > 1e-6 && share < 1 - 1e-6 && std::find(ages.begin(), ages.end(), t) == ages.end())
      ages.push_back(t);
  }
  return static_cast<int>(ages.size()) < free - 1;
}

void set_information_criteria(GrowthFit& fit, const GrowthData& data, int free) {
  const double n = fit.n, k = free + 1;
  double deviance = n * (std::log(2 * std::numbers::pi * fit.rss / n) + 1);
  for (double weight : data.weight) deviance -= std::log(weight);
  fit.aic = deviance + 2 * k;
  fit.bic = deviance + k * std::log(n);
  fit.aicc = n > k + 1 ? fit.aic + 2 * k * (k + 1) / (n - k - 1) : kInfinity;
}

// Covariance of the natural parameters: s^2 (J'J)^-1 through the analytic transform; with a robust loss
// Huber's sandwich.
void set_covariance(GrowthFit& fit, const GrowthProblem& problem, const GrowthVector& c,
                    const std::vector<int>& active, const GrowthOptions& options) {
  Eigen::VectorXd residuals;
  Eigen::MatrixXd all;
  if (!problem.evaluate(c, residuals, &all)) return;
  const auto m = static_cast<Eigen::Index>(active.size());
  Eigen::MatrixXd jacobian(all.rows(), m);
  for (Eigen::Index k = 0; k < m; ++k) jacobian.col(k) = all.col(active[k]);
  const Eigen::VectorXd norms = jacobian.colwise().norm();
  const Eigen::MatrixXd scaled = jacobian * norms.cwiseInverse().asDiagonal();
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(scaled, Eigen::ComputeThinU | Eigen::ComputeThinV);
  fit.scaled_condition = svd.singularValues()[0] / svd.singularValues()[m - 1];
  if (!(fit.scaled_condition < 1e12)) return;
  const Eigen::MatrixXd root =
      norms.cwiseInverse().asDiagonal() * svd.matrixV() * svd.singularValues().cwiseInverse().asDiagonal();
  Eigen::MatrixXd covariance = fit.sigma * fit.sigma * root * root.transpose();
  if (options.loss != GrowthLoss::none) {
    Eigen::MatrixXd bread = Eigen::MatrixXd::Zero(m, m), meat = bread, safe = bread;
    for (Eigen::Index i = 0; i < residuals.size(); ++i) {
      const double square = residuals[i] * residuals[i];
      const auto rho = evaluate_loss(options.loss, options.loss_scale, square);
      const Eigen::MatrixXd outer = jacobian.row(i).transpose() * jacobian.row(i);
      bread += (rho[1] + 2 * rho[2] * square) * outer;
      safe += rho[1] * outer;
      meat += rho[1] * rho[1] * square * outer;
    }
    if (bread.llt().info() != Eigen::Success) bread = safe;
    const Eigen::MatrixXd inverse = bread.ldlt().solve(Eigen::MatrixXd::Identity(m, m));
    covariance = static_cast<double>(fit.n) / static_cast<double>(fit.n - m) * inverse * meat * inverse;
  }
  GrowthMatrix transform;
  problem.curve->to_natural(problem.chart, c, &transform);
  Eigen::MatrixXd columns(transform.rows(), m);
  for (Eigen::Index k = 0; k < m; ++k) columns.col(k) = transform.col(active[k]);
  fit.covariance = columns * covariance * columns.transpose();
  for (Eigen::Index i = 0; i < fit.covariance.rows(); ++i)
    for (Eigen::Index k = 0; k < i; ++k) {
      const double scale = std::sqrt(fit.covariance(i, i) * fit.covariance(k, k));
      const double correlation = scale > 0 ? std::abs(fit.covariance(i, k)) / scale : 0;
      fit.largest_correlation = std::fmax(fit.largest_correlation, correlation);
    }
}

// Wald limits, replaced by profile ones where asked for. Returns a lower point met on the way.
std::optional<GrowthVector> set_limits(GrowthFit& fit, const GrowthProblem& problem,
                                       const GrowthVector& natural, int degrees,
                                       const GrowthOptions& options) {
  const double quantile = student_t_two_sided(options.confidence, degrees);
  // Without scatter there is nothing to profile.
  fit.profiled = options.profile_intervals && options.loss == GrowthLoss::none && fit.relative_offset > 0;
  for (int i = 0; i < problem.curve->size(); ++i) {
    GrowthParameter& parameter = fit.parameters[i];
    if (parameter.fixed) continue;
    if (!parameter.at_bound && fit.covariance.size() > 0) {
      parameter.se = std::sqrt(fit.covariance(i, i));
      parameter.lo = parameter.value - quantile * parameter.se;
      parameter.hi = parameter.value + quantile * parameter.se;
    }
    if (!fit.profiled) continue;
    const ProfileLimits limits =
        profile_limits(problem, natural, fit.rss, degrees, quantile, i, parameter.se);
    if (limits.better) return limits.better;
    parameter.lo = limits.lo;
    parameter.hi = limits.hi;
    if (i == problem.curve->asymptote_row() && !fit.asymptote_bounded) parameter.hi = kInfinity;
  }
  return std::nullopt;
}

std::vector<double> band_times(const GrowthData& data, const GrowthOptions& options) {
  if (!options.band_times.empty()) return options.band_times;
  const auto [first, last] = std::minmax_element(data.time.begin(), data.time.end());
  const double from = std::min(0.0, *first);
  std::vector<double> times;
  for (int i = 0; i <= 60; ++i) times.push_back(from + (*last - from) * i / 60);
  return times;
}

void name_parameters(GrowthFit& fit, const GrowthCurve& curve, const GrowthOptions& options) {
  for (int i = 0; i < curve.size(); ++i) {
    GrowthParameter parameter;
    parameter.name = curve.name(i);
    parameter.unit = curve.unit(i);
    for (const auto& [word, unit] : {std::pair<std::string, std::string>{"size", options.value_unit},
                                     std::pair<std::string, std::string>{"time", options.time_unit}})
      if (const auto at = parameter.unit.find(word); at != std::string::npos)
        parameter.unit.replace(at, word.size(), unit);
    fit.parameters.push_back(parameter);
  }
}

}  // namespace

GrowthFit fit_growth_equation(const MeasurementSeries& given, const std::string& equation,
                              const GrowthOptions& options, const std::vector<double>& weights) {
  options.validate();
  MeasurementSeries series = given;
  if (options.origin_time)
    for (double& t : series.time) t -= *options.origin_time;
  const GrowthCurve curve = make_growth_curve(equation, options);
  const GrowthConstraints constraints = read_growth_constraints(curve, options);
  GrowthFit fit;
  fit.equation = equation;
  fit.n = static_cast<int>(series.time.size());
  name_parameters(fit, curve, options);
  fit.reason = unusable_measurements(series, options);
  if (!fit.reason.empty()) return fit;
  if (!weights.empty()) {
    require(weights.size() == series.time.size(), "weights", static_cast<double>(weights.size()),
            "must be as many as measurements");
    for (double weight : weights)
      require(weight > 0 && std::isfinite(weight), "weights", weight, "must be above 0");
  }
  const GrowthData data = make_growth_data(series, options, weights);
  const GrowthProblem problem = make_growth_problem(curve, data, constraints);
  const int free = problem.free_count();
  fit.reason = too_few_points(series, equation, free, options);
  if (!fit.reason.empty()) {
    fit.status = GrowthStatus::too_few_points;
    return fit;
  }

  std::vector<GrowthVector> starts = starting_points(curve, data, constraints, options);
  const int asymptote = curve.asymptote_row();
  const bool endless_possible = !constraints.fixed[asymptote] && !constraints.bounds[asymptote].hi;
  const double largest = *std::max_element(data.value.begin(), data.value.end());
  const bool known_limit = endless_possible && !constraints.any && options.loss == GrowthLoss::none;
  const GrowthLimit limit = known_limit ? fit_limit_curve(curve, data) : GrowthLimit{};

  for (int attempt = 0; attempt < 4; ++attempt) {
    const auto optimum = find_growth_optimum(problem, starts, options);
    if (!optimum || !std::isfinite(optimum->best.rss)) {
      fit.reason = not_converged(series, equation);
      return fit;
    }
    const GrowthSolution& best = optimum->best;
    const GrowthVector natural = curve.to_natural(problem.chart, best.c);
    fit.rss = best.rss;
    fit.relative_offset = best.relative_offset;
    fit.iterations = best.iterations;
    if (options.loss != GrowthLoss::none) {
      fit.robust_cost = 0.5 * best.rss;
      fit.rss = problem.rss(best.c);
    }

    // Finite, or better the larger the final size?
    if (known_limit) {
      fit.rss_limit = limit.rss;
    } else if (endless_possible && options.loss == GrowthLoss::none) {
      fit.rss_limit = pushed_limit(problem, best.c);
    }
    const double margin = (fit.rss_limit - fit.rss) / fit.rss_limit;
    const bool runaway = endless_possible && natural[asymptote] > 1e7 * largest;
    const bool level = std::abs(margin) <= 1e-9 ? limit.slope < 0 && !runaway : margin > 0;
    if (endless_possible && (runaway || (std::isfinite(fit.rss_limit) && fit.rss > 0 && !level))) {
      fit.status = GrowthStatus::no_finite_optimum;
      fit.reason = no_finite_optimum(series, equation, options);
      fit.rss = std::fmin(fit.rss, fit.rss_limit);
      return fit;
    }

    std::vector<int> active;
    for (int i = 0; i < curve.size(); ++i) {
      GrowthParameter& parameter = fit.parameters[i];
      parameter.value = natural[i];
      parameter.fixed = problem.held[i] && constraints.any;
      parameter.at_bound =
          constraints.any && !parameter.fixed && (best.c[i] <= problem.lo[i] || best.c[i] >= problem.hi[i]);
      if (!parameter.fixed && !parameter.at_bound) active.push_back(i);
    }
    const int degrees = fit.n - free;
    fit.sigma = std::sqrt(fit.rss / degrees);
    fit.residuals.clear();
    for (int i = 0; i < data.size(); ++i)
      fit.residuals.push_back(data.value[i] - curve.value(natural, data.time[i]));
    fit.residual_lag1 = lag1_correlation(fit.residuals);
    set_information_criteria(fit, data, free);
    if (!active.empty()) set_covariance(fit, problem, best.c, active, options);
    // Richards with d -> 0 and Chapman-Richards with c -> infinity are the Gompertz.
    if ((equation == "richards" && natural[3] < 1e-3) ||
        (equation == "chapman_richards" && natural[2] > 1e3)) {
      fit.status = GrowthStatus::no_finite_optimum;
      fit.reason = limiting_shape(series, equation);
      fit.covariance.resize(0, 0);
      for (GrowthParameter& parameter : fit.parameters) parameter.value = kGrowthNaN;
      return fit;
    }
    const bool blind = !active.empty() && !(fit.scaled_condition < 1e8);
    if (blind || is_step(curve, natural, data, free)) {
      fit.status = GrowthStatus::ill_conditioned;
      fit.reason = ill_conditioned(series, equation, options);
      fit.covariance.resize(0, 0);
      return fit;
    }
    if (options.loss == GrowthLoss::none && !(best.relative_offset < 1e-5)) {
      fit.reason = not_converged(series, equation);
      return fit;
    }
    const double quantile = student_t_two_sided(options.confidence, degrees);
    fit.asymptote_bounded = !endless_possible || !std::isfinite(fit.rss_limit) ||
                            fit.rss_limit > fit.rss * (1 + quantile * quantile / degrees);
    if (const auto better = set_limits(fit, problem, natural, degrees, options)) {
      starts.assign(1, *better);
      continue;
    }
    if (optimum->second && optimum->second->rss < fit.rss * (1 + quantile * quantile / degrees)) {
      const GrowthVector other = curve.to_natural(problem.chart, optimum->second->c);
      fit.second_best = GrowthAlternative{{other.data(), other.data() + other.size()}, optimum->second->rss};
    }
    break;
  }
  fit.status = GrowthStatus::ok;
  fit.derived = derive_growth(fit, options);
  const FittedGrowth fitted(fit, options);
  for (double t : band_times(data, options)) fit.bands.push_back(fitted.band(t));
  fit.warnings = fit_warnings(series, fit, options);
  return fit;
}

}  // namespace dendrofit
