// SPDX-License-Identifier: GPL-3.0-or-later
#include "fit/growth_solver.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>

#include <Eigen/QR>
#include <ceres/ceres.h>

namespace dendrofit {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kLongestStep = 4;  // in one logarithmic coordinate

using FreeList = std::vector<int>;

FreeList free_coordinates(const GrowthProblem& problem) {
  FreeList list;
  for (int i = 0; i < problem.curve->size(); ++i)
    if (!problem.held[i]) list.push_back(i);
  return list;
}

bool is_logarithmic(const GrowthProblem& problem, int coordinate) {
  for (int i = 0; i < problem.curve->own_size(); ++i)
    if (problem.curve->is_positive(i) && problem.curve->coordinate(problem.chart, i) == coordinate)
      return true;
  return false;
}

// Orthogonal decomposition of the Jacobian's free columns at one point.
struct Tangent {
  GrowthMatrix r;        // upper triangle
  GrowthVector q_resid;  // first part of Q' residuals
  double offset = 0;
};

Tangent tangent(const Eigen::MatrixXd& jacobian, const FreeList& active, const Eigen::VectorXd& residuals) {
  const auto n = jacobian.rows();
  const auto m = static_cast<Eigen::Index>(active.size());
  Eigen::MatrixXd columns(n, m);
  for (Eigen::Index k = 0; k < m; ++k) columns.col(k) = jacobian.col(active[k]);
  const Eigen::HouseholderQR<Eigen::Ref<Eigen::MatrixXd>> qr(columns);
  Eigen::VectorXd rotated = residuals;
  rotated.applyOnTheLeft(qr.householderQ().adjoint());
  Tangent result;
  result.r = columns.topRows(m).triangularView<Eigen::Upper>();
  result.q_resid = rotated.head(m);
  const double inside = rotated.head(m).squaredNorm() / static_cast<double>(std::max<Eigen::Index>(m, 1));
  const double outside =
      rotated.tail(n - m).squaredNorm() / static_cast<double>(std::max<Eigen::Index>(n - m, 1));
  result.offset = inside == 0 ? 0 : std::sqrt(inside / std::max(outside, 1e-300));
  return result;
}

// Minimises |R d + q|^2 + damping |D d|^2.
GrowthVector damped_step(const Tangent& at, const GrowthVector& scale, double damping) {
  const auto m = at.r.cols();
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 2 * kMostGrowthParameters, kMostGrowthParameters>
      a(2 * m, m);
  Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 2 * kMostGrowthParameters, 1> b(2 * m);
  a.topRows(m) = at.r;
  a.bottomRows(m).setZero();
  for (Eigen::Index k = 0; k < m; ++k) a(m + k, k) = std::sqrt(damping) * scale[k];
  b.head(m) = -at.q_resid;
  b.tail(m).setZero();
  return a.colPivHouseholderQr().solve(b);
}

GrowthVector stepped(const GrowthProblem& problem, const GrowthVector& c, const FreeList& active,
                     GrowthVector step) {
  double shrink = 1;
  for (std::size_t k = 0; k < active.size(); ++k)
    if (is_logarithmic(problem, active[k])) shrink = std::min(shrink, kLongestStep / std::abs(step[k]));
  GrowthVector next = c;
  for (std::size_t k = 0; k < active.size(); ++k)
    next[active[k]] =
        std::clamp(c[active[k]] + shrink * step[k], problem.lo[active[k]], problem.hi[active[k]]);
  return next;
}

// The free coordinates that a bound does not stop from going downhill.
FreeList movable(const GrowthProblem& problem, const FreeList& list, const GrowthVector& c,
                 const Eigen::MatrixXd& jacobian, const Eigen::VectorXd& residuals) {
  FreeList result;
  for (int i : list) {
    const double slope = jacobian.col(i).dot(residuals);
    if ((c[i] <= problem.lo[i] && slope > 0) || (c[i] >= problem.hi[i] && slope < 0)) continue;
    result.push_back(i);
  }
  return result;
}

// No residual left: rounding of the values themselves.
bool is_exact(const GrowthProblem& problem, double rss) {
  double squares = 0;
  for (int i = 0; i < problem.data->size(); ++i)
    squares += problem.data->weight[i] * problem.data->value[i] * problem.data->value[i];
  return rss <= 1e-25 * squares;
}

std::unique_ptr<ceres::LossFunction> ceres_loss(GrowthLoss loss, double scale) {
  switch (loss) {
    case GrowthLoss::none:
      return nullptr;
    case GrowthLoss::huber:
      return std::make_unique<ceres::HuberLoss>(scale);
    case GrowthLoss::soft_l1:
      return std::make_unique<ceres::SoftLOneLoss>(scale);
    case GrowthLoss::cauchy:
      return std::make_unique<ceres::CauchyLoss>(scale);
    case GrowthLoss::arctan:
      return std::make_unique<ceres::ArctanLoss>(scale);
    case GrowthLoss::tukey:
      return std::make_unique<ceres::TukeyLoss>(scale);
  }
  return nullptr;
}

// Residuals [first, last) as functions of the free coordinates.
class CurveCost : public ceres::CostFunction {
 public:
  CurveCost(const GrowthProblem& problem, const GrowthVector& start, int first, int last)
      : problem_(problem), start_(start), free_(free_coordinates(problem)), first_(first), last_(last) {
    set_num_residuals(last - first);
    mutable_parameter_block_sizes()->push_back(static_cast<int>(free_.size()));
  }
  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override {
    GrowthVector c = start_;
    for (std::size_t k = 0; k < free_.size(); ++k) c[free_[k]] = parameters[0][k];
    GrowthMatrix transform;
    const bool slopes = jacobians && jacobians[0];
    const GrowthVector natural = problem_.curve->to_natural(problem_.chart, c, slopes ? &transform : nullptr);
    const GrowthData& data = *problem_.data;
    GrowthVector g;
    for (int i = first_; i < last_; ++i) {
      const double root = std::sqrt(data.weight[i]);
      residuals[i - first_] = root * (problem_.curve->value(natural, data.time[i]) - data.value[i]);
      if (!std::isfinite(residuals[i - first_])) return false;
      if (!slopes) continue;
      problem_.curve->gradient(natural, data.time[i], g);
      for (std::size_t k = 0; k < free_.size(); ++k) {
        const double slope = root * g.dot(transform.col(free_[k]));
        // Ceres writes to the log when derivatives fail at an accepted point; a flat one just ends the search
        // there.
        jacobians[0][static_cast<std::size_t>(i - first_) * free_.size() + k] =
            std::isfinite(slope) ? slope : 0;
      }
    }
    return true;
  }

 private:
  const GrowthProblem& problem_;
  GrowthVector start_;
  FreeList free_;
  int first_, last_;
};

GrowthSolution solve_with_ceres(const GrowthProblem& problem, const GrowthVector& start, GrowthLoss loss,
                                double scale, int most_iterations) {
  const FreeList list = free_coordinates(problem);
  GrowthSolution solution{start, problem.rss(start), kInfinity, 0, false};
  if (list.empty() || !std::isfinite(solution.rss)) return solution;
  std::vector<double> x;
  for (int i : list) x.push_back(std::clamp(start[i], problem.lo[i], problem.hi[i]));
  ceres::Problem ceres_problem;
  if (loss == GrowthLoss::none)
    ceres_problem.AddResidualBlock(new CurveCost(problem, start, 0, problem.data->size()), nullptr, x.data());
  else
    for (int i = 0; i < problem.data->size(); ++i)
      ceres_problem.AddResidualBlock(new CurveCost(problem, start, i, i + 1),
                                     ceres_loss(loss, scale).release(), x.data());
  for (std::size_t k = 0; k < list.size(); ++k) {
    if (std::isfinite(problem.lo[list[k]]))
      ceres_problem.SetParameterLowerBound(x.data(), static_cast<int>(k), problem.lo[list[k]]);
    if (std::isfinite(problem.hi[list[k]]))
      ceres_problem.SetParameterUpperBound(x.data(), static_cast<int>(k), problem.hi[list[k]]);
  }
  ceres::Solver::Options options;
  options.logging_type = ceres::SILENT;
  options.num_threads = 1;
  options.linear_solver_type = ceres::DENSE_QR;
  options.max_num_iterations = most_iterations;
  options.max_num_consecutive_invalid_steps =
      most_iterations + 1;         // giving up earlier would write to the log
  options.function_tolerance = 0;  // the default, 1e-6, stops digits too early
  options.gradient_tolerance = 0;
  options.parameter_tolerance = 1e-14;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &ceres_problem, &summary);
  for (std::size_t k = 0; k < list.size(); ++k) solution.c[list[k]] = x[k];
  solution.rss = loss == GrowthLoss::none ? problem.rss(solution.c) : 2 * summary.final_cost;
  solution.iterations = static_cast<int>(summary.iterations.size());
  solution.converged = summary.termination_type == ceres::CONVERGENCE;
  return solution;
}

// Undamped steps from c while they bring the point closer to stationarity and the sum of squares stays the
// same.
void gauss_newton(const GrowthProblem& problem, GrowthSolution& at) {
  const FreeList list = free_coordinates(problem);
  Eigen::VectorXd residuals;
  Eigen::MatrixXd jacobian;
  GrowthVector c = at.c;
  at.relative_offset = kInfinity;
  for (int iteration = 0; iteration < 60; ++iteration) {
    if (!problem.evaluate(c, residuals, &jacobian)) break;
    const double rss = residuals.squaredNorm();
    const FreeList active = movable(problem, list, c, jacobian, residuals);
    if (rss > at.rss * (1 + 1e-9) && !is_exact(problem, rss)) break;
    const Tangent here = tangent(jacobian, active, residuals);
    const bool closer = here.offset < 0.7 * at.relative_offset;
    if (here.offset < at.relative_offset) {
      at.c = c;
      at.rss = rss;
      at.relative_offset = here.offset;
    }
    if (active.empty() || here.offset == 0 || is_exact(problem, rss)) {
      at.converged = true;
      at.relative_offset = 0;  // nothing left to move, or nothing left of the residuals
      return;
    }
    if (!closer && (at.relative_offset < 1e-9 || iteration > 20)) break;
    const GrowthVector ones = GrowthVector::Ones(static_cast<Eigen::Index>(active.size()));
    c = stepped(problem, c, active, damped_step(here, ones, 0));
    ++at.iterations;
  }
  at.converged = at.relative_offset < 1e-9;
}

}  // namespace

GrowthProblem::GrowthProblem(const GrowthCurve& curve_in, GrowthChart chart_in, const GrowthData& data_in)
    : curve(&curve_in),
      chart(chart_in),
      data(&data_in),
      lo(GrowthVector::Constant(curve_in.size(), -kInfinity)),
      hi(GrowthVector::Constant(curve_in.size(), kInfinity)) {}

int GrowthProblem::free_count() const {
  return static_cast<int>(free_coordinates(*this).size());
}

bool GrowthProblem::evaluate(const GrowthVector& c, Eigen::VectorXd& residuals,
                             Eigen::MatrixXd* jacobian) const {
  const int n = data->size();
  GrowthMatrix transform;
  const GrowthVector natural = curve->to_natural(chart, c, jacobian ? &transform : nullptr);
  residuals.resize(n);
  if (jacobian) jacobian->resize(n, curve->size());
  GrowthVector g;
  for (int i = 0; i < n; ++i) {
    const double root = std::sqrt(data->weight[i]);
    residuals[i] = root * (curve->value(natural, data->time[i]) - data->value[i]);
    if (!jacobian) continue;
    curve->gradient(natural, data->time[i], g);
    for (int k = 0; k < curve->size(); ++k) (*jacobian)(i, k) = root * g.dot(transform.col(k));
  }
  return residuals.allFinite() && (!jacobian || jacobian->allFinite());
}

double GrowthProblem::rss(const GrowthVector& c) const {
  const GrowthVector natural = curve->to_natural(chart, c);
  double sum = 0;
  for (int i = 0; i < data->size(); ++i) {
    const double difference = curve->value(natural, data->time[i]) - data->value[i];
    sum += data->weight[i] * difference * difference;
  }
  return std::isfinite(sum) ? sum : kInfinity;
}

GrowthSolution minimize_directly(const GrowthProblem& problem, const GrowthVector& start, int most_iterations,
                                 double offset_tolerance) {
  const FreeList list = free_coordinates(problem);
  GrowthSolution at{start, problem.rss(start), kInfinity, 0, false};
  Eigen::VectorXd residuals;
  Eigen::MatrixXd jacobian;
  double damping = 1e-3, raise = 4;
  GrowthVector largest = GrowthVector::Zero(problem.curve->size());
  while (at.iterations < most_iterations) {
    if (!problem.evaluate(at.c, residuals, &jacobian)) return at;
    const FreeList active = movable(problem, list, at.c, jacobian, residuals);
    const Tangent here = tangent(jacobian, active, residuals);
    at.relative_offset = here.offset;
    if (active.empty() || here.offset <= offset_tolerance || is_exact(problem, at.rss)) {
      if (active.empty() || is_exact(problem, at.rss)) at.relative_offset = 0;
      at.converged = true;
      return at;
    }
    GrowthVector scale(static_cast<Eigen::Index>(active.size()));
    for (std::size_t k = 0; k < active.size(); ++k) {
      largest[active[k]] = std::max(largest[active[k]], jacobian.col(active[k]).norm());
      scale[static_cast<Eigen::Index>(k)] = std::max(largest[active[k]], 1e-300);
    }
    bool fell = false;
    while (!fell && at.iterations < most_iterations) {
      ++at.iterations;
      const GrowthVector step = damped_step(here, scale, damping);
      const GrowthVector next = step.allFinite() ? stepped(problem, at.c, active, step) : at.c;
      const double rss = problem.rss(next);
      if (rss < at.rss) {
        GrowthVector moved(step.size());
        for (std::size_t k = 0; k < active.size(); ++k)
          moved[static_cast<Eigen::Index>(k)] = next[active[k]] - at.c[active[k]];
        const double predicted = here.q_resid.squaredNorm() - (here.r * moved + here.q_resid).squaredNorm();
        const double gain = (at.rss - rss) / std::max(predicted, 1e-300);
        damping *= gain > 0.75 ? 0.1 : gain > 0.25 ? 0.5 : 2;
        damping = std::max(damping, 1e-14);
        raise = 4;
        at.c = next;
        at.rss = rss;
        fell = true;
      } else {
        damping *= raise;
        raise *= 2;
        if (damping > 1e12) return at;
      }
    }
  }
  return at;
}

GrowthSolution minimize_to_the_end(const GrowthProblem& problem, const GrowthVector& start) {
  GrowthSolution at = solve_with_ceres(problem, start, GrowthLoss::none, 1, 200);
  gauss_newton(problem, at);
  if (at.converged) return at;
  // A flat valley: our own steps follow it further than Ceres' do.
  GrowthSolution further = minimize_directly(problem, at.c, 500, 1e-9);
  gauss_newton(problem, further);
  if (further.rss > at.rss) return at;
  further.iterations += at.iterations;
  return further;
}

GrowthSolution minimize_robustly(const GrowthProblem& problem, const GrowthVector& start, GrowthLoss loss,
                                 double loss_scale) {
  return solve_with_ceres(problem, start, loss, loss_scale, 500);
}

std::array<double, 3> evaluate_loss(GrowthLoss loss, double scale, double squared_residual) {
  std::array<double, 3> rho{squared_residual, 1, 0};
  switch (loss) {
    case GrowthLoss::none:
      break;
    case GrowthLoss::huber:
      ceres::HuberLoss(scale).Evaluate(squared_residual, rho.data());
      break;
    case GrowthLoss::soft_l1:
      ceres::SoftLOneLoss(scale).Evaluate(squared_residual, rho.data());
      break;
    case GrowthLoss::cauchy:
      ceres::CauchyLoss(scale).Evaluate(squared_residual, rho.data());
      break;
    case GrowthLoss::arctan:
      ceres::ArctanLoss(scale).Evaluate(squared_residual, rho.data());
      break;
    case GrowthLoss::tukey:
      ceres::TukeyLoss(scale).Evaluate(squared_residual, rho.data());
      break;
  }
  return rho;
}

}  // namespace dendrofit
