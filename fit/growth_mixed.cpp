// SPDX-License-Identifier: GPL-3.0-or-later
#include "fit/growth_mixed.h"

#include "core/errors.h"
#include "fit/growth_curve.h"
#include "fit/growth_diagnose.h"
#include "fit/growth_fit.h"
#include "fit/growth_mixed_chart.h"
#include "fit/growth_statistics.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include <Eigen/Dense>

namespace dendrofit {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

// One series linearised at its own parameters: sizes, curve and slopes.
struct Group {
  const MeasurementSeries* series = nullptr;
  VectorXd b;      // random effects
  VectorXd f;      // curve
  MatrixXd slope;  // d f / d phi; random effects belong to the first q columns
};

struct Model {
  MixedChart chart;
  int q = 1;
  VectorXd beta;
  std::vector<Group> groups;
  int n = 0;
};

bool evaluate_group(const Model& model, const VectorXd& beta, Group& group) {
  VectorXd phi = beta;
  phi.head(model.q) += group.b;
  GrowthVector natural, g;
  GrowthMatrix slopes;
  if (!model.chart.to_natural(phi, natural, slopes)) return false;
  const auto n = static_cast<Eigen::Index>(group.series->time.size());
  group.f.resize(n);
  group.slope.resize(n, model.chart.size());
  for (Eigen::Index i = 0; i < n; ++i) {
    group.f[i] = model.chart.curve().value(natural, group.series->time[i]);
    model.chart.curve().gradient(natural, group.series->time[i], g);
    group.slope.row(i) = g.transpose() * slopes;
  }
  return group.f.allFinite() && group.slope.allFinite();
}

VectorXd sizes(const Group& group) {
  return Eigen::Map<const VectorXd>(group.series->value.data(),
                                    static_cast<Eigen::Index>(group.series->value.size()));
}

// Penalised sum of squares; infinite where a curve does not exist.
double penalised(const Model& model, const VectorXd& beta, std::vector<Group>& groups,
                 const MatrixXd& precision) {
  double sum = 0;
  for (Group& group : groups) {
    if (!evaluate_group(model, beta, group)) return std::numeric_limits<double>::infinity();
    sum += (sizes(group) - group.f).squaredNorm() + group.b.dot(precision * group.b);
  }
  return sum;
}

// Penalised nonlinear least squares over population and random effects, by Gauss-Newton with halving; groups
// are eliminated one by one.
bool penalised_least_squares(Model& model, const MatrixXd& precision) {
  const int p = model.chart.size(), q = model.q;
  double now = penalised(model, model.beta, model.groups, precision);
  if (!std::isfinite(now)) return false;
  for (int iteration = 0; iteration < 100; ++iteration) {
    MatrixXd a = MatrixXd::Zero(p, p);
    VectorXd g = VectorXd::Zero(p);
    std::vector<MatrixXd> inverse, cross;
    std::vector<VectorXd> pull;
    for (const Group& group : model.groups) {
      const MatrixXd z = group.slope.leftCols(q);
      const VectorXd r = sizes(group) - group.f;
      inverse.push_back((z.transpose() * z + precision).inverse());
      cross.push_back(z.transpose() * group.slope);
      pull.push_back(z.transpose() * r - precision * group.b);
      a += group.slope.transpose() * group.slope - cross.back().transpose() * inverse.back() * cross.back();
      g += group.slope.transpose() * r - cross.back().transpose() * inverse.back() * pull.back();
    }
    const VectorXd scale = a.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
    const MatrixXd scaled = scale.asDiagonal() * a * scale.asDiagonal();
    const VectorXd step = scale.asDiagonal() * scaled.ldlt().solve(scale.asDiagonal() * g);
    std::vector<VectorXd> steps;
    for (std::size_t i = 0; i < model.groups.size(); ++i)
      steps.emplace_back(inverse[i] * (pull[i] - cross[i] * step));
    bool fell = false;
    for (double share = 1; share > 1e-6 && !fell; share *= 0.5) {
      std::vector<Group> moved = model.groups;
      for (std::size_t i = 0; i < moved.size(); ++i) moved[i].b += share * steps[i];
      const VectorXd beta = model.beta + share * step;
      const double next = penalised(model, beta, moved, precision);
      if (!(next <= now)) continue;
      const bool done = now - next <= 1e-15 * now;
      model.groups = std::move(moved);
      model.beta = beta;
      now = next;
      fell = true;
      if (done) return true;
    }
    if (!fell) return true;  // rounding decides
  }
  return true;
}

// The linear mixed model of the working sizes w = y - f + X beta + Z b, by its sums of products.
class LinearMixed {
 public:
  LinearMixed(const Model& model) : p_(model.chart.size()), q_(model.q), n_(model.n) {
    for (const Group& group : model.groups) {
      const MatrixXd z = group.slope.leftCols(q_);
      const VectorXd w = sizes(group) - group.f + group.slope * model.beta + z * group.b;
      zz_.push_back(z.transpose() * z);
      zx_.push_back(z.transpose() * group.slope);
      zw_.push_back(z.transpose() * w);
      xx_.push_back(group.slope.transpose() * group.slope);
      xw_.push_back(group.slope.transpose() * w);
      ww_.push_back(w.squaredNorm());
    }
  }

  // Profiled log-likelihood at the relative factor whose logarithmic parameters are theta; beta and sigma on
  // the way.
  double log_likelihood(const VectorXd& theta) {
    const MatrixXd factor = relative_factor(theta);
    information_ = MatrixXd::Zero(p_, p_);
    VectorXd g = VectorXd::Zero(p_);
    double squares = 0, log_det = 0;
    for (std::size_t i = 0; i < zz_.size(); ++i) {
      const MatrixXd inner = MatrixXd::Identity(q_, q_) + factor.transpose() * zz_[i] * factor;
      const Eigen::LLT<MatrixXd> llt(inner);
      const MatrixXd left = llt.matrixL().solve(factor.transpose() * zx_[i]);
      const VectorXd right = llt.matrixL().solve(factor.transpose() * zw_[i]);
      information_ += xx_[i] - left.transpose() * left;
      g += xw_[i] - left.transpose() * right;
      squares += ww_[i] - right.squaredNorm();
      log_det += 2 * MatrixXd(llt.matrixL()).diagonal().array().log().sum();
    }
    const VectorXd scale = information_.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
    const MatrixXd scaled = scale.asDiagonal() * information_ * scale.asDiagonal();
    beta_ = scale.asDiagonal() * scaled.ldlt().solve(scale.asDiagonal() * g);
    variance_ = (squares - beta_.dot(g)) / n_;
    return -0.5 * (n_ * (std::log(2 * std::numbers::pi * variance_) + 1) + log_det);
  }

  // Lower triangle with logarithmic diagonal: D = sigma^2 F F'.
  MatrixXd relative_factor(const VectorXd& theta) const {
    MatrixXd factor = MatrixXd::Zero(q_, q_);
    for (int k = 0; k < q_; ++k) factor(k, k) = std::exp(theta[k]) * unit_[k];
    if (q_ == 2) factor(1, 0) = theta[2] * unit_[1];
    return factor;
  }

  // Newton with central differences, uphill.
  VectorXd maximise(VectorXd theta) {
    const auto m = theta.size();
    double now = log_likelihood(theta);
    for (int iteration = 0; iteration < 50; ++iteration) {
      const double h = 1e-3;
      VectorXd gradient(m);
      MatrixXd hessian(m, m);
      const auto at = [&](Eigen::Index i, double di, Eigen::Index j, double dj) {
        VectorXd moved = theta;
        moved[i] += di;
        moved[j] += dj;
        return log_likelihood(moved);
      };
      for (Eigen::Index i = 0; i < m; ++i) {
        const double up = at(i, h, i, 0), down = at(i, -h, i, 0);
        gradient[i] = (up - down) / (2 * h);
        hessian(i, i) = (up - 2 * now + down) / (h * h);
        for (Eigen::Index j = 0; j < i; ++j)
          hessian(i, j) = hessian(j, i) =
              (at(i, h, j, h) - at(i, h, j, -h) - at(i, -h, j, h) + at(i, -h, j, -h)) / (4 * h * h);
      }
      const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(-hessian);
      const VectorXd curvature = eigen.eigenvalues().cwiseAbs().cwiseMax(1e-6);
      VectorXd step = eigen.eigenvectors() * curvature.cwiseInverse().asDiagonal() *
                      eigen.eigenvectors().transpose() * gradient;
      if (step.norm() > 2) step *= 2 / step.norm();
      double next = log_likelihood(theta + step);
      while (!(next >= now) && step.norm() > 1e-12) {
        step *= 0.5;
        next = log_likelihood(theta + step);
      }
      const bool done = !(next > now + 1e-12 * std::abs(now)) || theta.head(q_).minCoeff() < -30;
      if (next >= now) {
        theta += step;
        now = next;
      }
      if (done) break;
    }
    log_likelihood(theta);
    return theta;
  }

  void set_units(const VectorXd& unit) { unit_ = unit; }
  const VectorXd& beta() const { return beta_; }
  double variance() const { return variance_; }
  const MatrixXd& information() const { return information_; }

 private:
  int p_, q_, n_;
  std::vector<MatrixXd> zz_, zx_, xx_;
  std::vector<VectorXd> zw_, xw_;
  std::vector<double> ww_;
  VectorXd unit_ = VectorXd::Ones(2);  // sizes of the random effects relative to sigma where theta = 0
  VectorXd beta_;
  MatrixXd information_;
  double variance_ = 0;
};

MeasurementSeries together(const std::vector<MeasurementSeries>& series) {
  MeasurementSeries all;
  all.name = "all series";
  for (const MeasurementSeries& one : series) {
    all.time.insert(all.time.end(), one.time.begin(), one.time.end());
    all.value.insert(all.value.end(), one.value.begin(), one.value.end());
  }
  return all;
}

// Asymptotes that scale the population curve to each series; their spread starts the random effects.
double scale_spread(const Model& model) {
  double sum = 0, squares = 0;
  for (const Group& group : model.groups) {
    const double scale = model.beta[0] * group.f.dot(sizes(group)) / group.f.squaredNorm();
    sum += scale;
    squares += scale * scale;
  }
  const double n = static_cast<double>(model.groups.size());
  return std::sqrt(std::max(squares / n - sum * sum / (n * n), 1e-6 * model.beta[0] * model.beta[0]));
}

GrowthParameter mixed_parameter(const std::string& name, double value, double se, double quantile) {
  GrowthParameter parameter;
  parameter.name = name;
  parameter.value = value;
  parameter.se = se;
  parameter.lo = value - quantile * se;
  parameter.hi = value + quantile * se;
  return parameter;
}

void fill_result(GrowthMixed& mixed, Model& model, const LinearMixed& linear, const MatrixXd& factor,
                 const GrowthOptions& options) {
  const int p = model.chart.size();
  // The population effects' errors with the degrees of freedom that they use up.
  const double inflation = static_cast<double>(model.n) / (model.n - p);
  const VectorXd scale = linear.information().diagonal().cwiseSqrt().cwiseInverse();
  const MatrixXd inverse = (scale.asDiagonal() * linear.information() * scale.asDiagonal()).inverse();
  const MatrixXd covariance =
      inflation * linear.variance() * (scale.asDiagonal() * inverse * scale.asDiagonal()).eval();
  const double quantile = student_t_two_sided(options.confidence, model.n - p);
  for (int k = 0; k < p; ++k)
    mixed.fixed.push_back(
        mixed_parameter(model.chart.name(k), model.beta[k], std::sqrt(covariance(k, k)), quantile));
  for (int k = 0; k < model.q; ++k) mixed.random.push_back(model.chart.name(k));
  mixed.random_covariance = linear.variance() * factor * factor.transpose();
  mixed.sigma = std::sqrt(linear.variance());
  const double parameters = p + 0.5 * model.q * (model.q + 1) + 1;
  mixed.aic = 2 * (parameters - mixed.log_likelihood);
  mixed.bic = parameters * std::log(static_cast<double>(model.n)) - 2 * mixed.log_likelihood;
  double last = 0, first = 0;
  for (const Group& group : model.groups) {
    VectorXd phi = model.beta;
    phi.head(model.q) += group.b;
    mixed.series.push_back({group.series->name, {phi.data(), phi.data() + phi.size()}});
    last = std::max(last, *std::max_element(group.series->time.begin(), group.series->time.end()));
    first = std::min(first, *std::min_element(group.series->time.begin(), group.series->time.end()));
  }
  std::vector<double> times = options.band_times;
  for (int i = 0; times.size() < 61 && options.band_times.empty(); ++i)
    times.push_back(first + (last - first) * i / 60);
  MeasurementSeries at;
  at.time = times;
  at.value.assign(times.size(), 0);
  Group population{&at, VectorXd::Zero(model.q), {}, {}};
  if (!evaluate_group(model, model.beta, population)) return;
  for (std::size_t i = 0; i < times.size(); ++i) {
    const VectorXd g = population.slope.row(static_cast<Eigen::Index>(i));
    const VectorXd z = g.head(model.q);
    GrowthBandPoint point;
    point.time = times[i];
    point.fit = population.f[static_cast<Eigen::Index>(i)];
    const double variance = g.dot(covariance * g);
    point.se = std::sqrt(variance);
    const double wide =
        quantile * std::sqrt(variance + z.dot(mixed.random_covariance * z) + linear.variance());
    point.confidence_lo = point.fit - quantile * point.se;
    point.confidence_hi = point.fit + quantile * point.se;
    point.prediction_lo = point.fit - wide;
    point.prediction_hi = point.fit + wide;
    GrowthVector natural;
    GrowthMatrix slopes;
    model.chart.to_natural(model.beta, natural, slopes);
    point.cai = model.chart.curve().rate(natural, times[i]);
    point.mai = times[i] > 0 ? point.fit / times[i] : kGrowthNaN;
    mixed.population.push_back(point);
  }
}

}  // namespace

GrowthMixed fit_mixed_growth(const std::vector<MeasurementSeries>& given, const std::string& equation,
                             const GrowthOptions& options, Progress& progress) {
  options.validate();
  require(options.mixed != GrowthMixedEffects::none, "mixed", 0, "must be asymptote or asymptote_and_rate");
  GrowthMixed mixed;
  mixed.equation = equation;
  const std::string lead = "mixed model, " + std::string(growth_equation(equation).title) + ": ";
  std::vector<MeasurementSeries> series;
  for (const MeasurementSeries& one : given)
    if (unusable_measurements(one, options).empty()) series.push_back(one);
  if (series.size() < 2) {
    mixed.reason = lead + std::to_string(series.size()) +
                   " usable series: it needs two or more, name them in a column 'series'";
    return mixed;
  }
  GrowthOptions plain = options;
  plain.profile_intervals = false;
  plain.weights = GrowthWeights::equal;
  plain.loss = GrowthLoss::none;
  plain.fixed.clear();
  plain.bounds.clear();
  plain.fit_offset = plain.fit_time_shift = false;
  const GrowthFit pooled = fit_growth_equation(together(series), equation, plain);
  if (pooled.status != GrowthStatus::ok) {
    mixed.status = pooled.status;
    mixed.reason = lead + "the pooled curve has no answer (" + pooled.reason + ")";
    return mixed;
  }
  if (options.origin_time)
    for (MeasurementSeries& one : series)
      for (double& t : one.time) t -= *options.origin_time;

  const GrowthCurve curve(growth_equation(equation), false, false, options.offset);
  Model model{MixedChart(curve, options.mixed_form),
              options.mixed == GrowthMixedEffects::asymptote ? 1 : 2,
              {},
              {},
              0};
  GrowthVector natural(curve.size());
  for (int i = 0; i < curve.size(); ++i) natural[i] = pooled.parameters[i].value;
  model.beta = model.chart.from_natural(natural);
  for (const MeasurementSeries& one : series) {
    Group group{&one, VectorXd::Zero(model.q), {}, {}};
    if (!evaluate_group(model, model.beta, group)) {
      mixed.reason = lead + "series '" + one.name + "' leaves the population curve's range: check its units";
      return mixed;
    }
    model.n += static_cast<int>(one.time.size());
    model.groups.push_back(std::move(group));
  }
  mixed.n = model.n;

  // theta = 0 stands for the spread seen, relative to a residual error of a quarter of the pooled one.
  VectorXd unit = VectorXd::Ones(2);
  unit[0] = scale_spread(model) / (0.25 * pooled.sigma);
  if (model.q == 2) unit[1] = 0.2 * std::max(std::abs(model.beta[1]), 1e-12) / (0.25 * pooled.sigma);
  VectorXd theta = VectorXd::Zero(model.q == 1 ? 1 : 3);
  double before = -std::numeric_limits<double>::infinity();
  for (mixed.iterations = 1; mixed.iterations <= 200; ++mixed.iterations) {
    progress.check();
    LinearMixed shape(model);
    shape.set_units(unit);
    const MatrixXd factor = shape.relative_factor(theta);
    const MatrixXd precision = (factor * factor.transpose()).inverse();
    if (!precision.allFinite() || !penalised_least_squares(model, precision)) break;
    LinearMixed linear(model);
    linear.set_units(unit);
    theta = linear.maximise(theta);
    mixed.log_likelihood = linear.log_likelihood(theta);
    if (std::abs(mixed.log_likelihood - before) < 1e-9 * std::abs(before)) {
      mixed.status = GrowthStatus::ok;
      fill_result(mixed, model, linear, linear.relative_factor(theta), options);
      return mixed;
    }
    before = mixed.log_likelihood;
  }
  mixed.reason = lead +
                 "the spread between series cannot be told from the scatter within them: let only the "
                 "asymptote vary, add series or "
                 "older trees, or use the pooled curve";
  return mixed;
}

}  // namespace dendrofit
