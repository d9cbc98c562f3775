// SPDX-License-Identifier: GPL-3.0-or-later
// Least-squares (and robust) minimisation of one growth curve over one set of measurements, in chart
// coordinates. Internal to the growth-curve files of this floor.
#pragma once

#include "fit/growth_curve.h"
#include "fit/growth_options.h"

#include <array>
#include <vector>

#include <Eigen/Core>

namespace dendrofit {

/// Measurements with weights (inverse relative variances; equal lengths, weights > 0).
struct GrowthData {
  std::vector<double> time;
  std::vector<double> value;
  std::vector<double> weight;
  int size() const { return static_cast<int>(time.size()); }
};

/// What is minimised: half the sum of loss(weight (X(t) - value)^2) over the coordinates that are not held.
struct GrowthProblem {
  GrowthProblem(const GrowthCurve& curve, GrowthChart chart, const GrowthData& data);

  const GrowthCurve* curve;
  GrowthChart chart;
  const GrowthData* data;
  GrowthVector lo, hi;  ///< infinite where there is no bound
  std::array<bool, kMostGrowthParameters> held{};

  int free_count() const;
  /// Weighted residuals at c, and their derivatives by every coordinate where asked for. False where not
  /// finite.
  bool evaluate(const GrowthVector& c, Eigen::VectorXd& residuals, Eigen::MatrixXd* jacobian) const;
  /// Weighted residual sum of squares; infinite where the curve is not finite.
  double rss(const GrowthVector& c) const;
};

struct GrowthSolution {
  GrowthVector c;
  double rss = 0;
  /// Bates & Watts: length of the residuals' part in the tangent plane over that outside it, per degree of
  /// freedom.
  double relative_offset = 0;
  int iterations = 0;
  bool converged = false;  ///< relative offset below the tolerance, or no residual left
};

/// Levenberg-Marquardt with bounds, by QR; the same coordinates held as in the problem.
GrowthSolution minimize_directly(const GrowthProblem& problem, const GrowthVector& start, int most_iterations,
                                 double offset_tolerance);

/// Ceres until nothing falls any more, then Gauss-Newton to a relative offset below 1e-9 (as far as rounding
/// allows).
GrowthSolution minimize_to_the_end(const GrowthProblem& problem, const GrowthVector& start);

/// Ceres with a robust loss; `rss` of the answer is twice the cost.
GrowthSolution minimize_robustly(const GrowthProblem& problem, const GrowthVector& start, GrowthLoss loss,
                                 double loss_scale);

/// Value of the loss at a squared residual and its first (the weight of a point) and second derivative, as
/// Ceres defines them.
std::array<double, 3> evaluate_loss(GrowthLoss loss, double scale, double squared_residual);

}  // namespace dendrofit
