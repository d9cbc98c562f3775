// SPDX-License-Identifier: GPL-3.0-or-later
// Coordinates of a growth curve in which the effects of a mixed model add up.
#pragma once

#include "fit/growth_curve.h"
#include "fit/growth_options.h"

#include <string>
#include <vector>

namespace dendrofit {

/// Coordinates phi: asymptote, rate (or ln of the scale age), the rest of the shape; with
/// GrowthMixedForm::start, of equations that do not start from nothing: asymptote, rate, size at age 0.
class MixedChart {
 public:
  MixedChart(const GrowthCurve& curve, GrowthMixedForm form);

  const GrowthCurve& curve() const { return curve_; }
  int size() const { return own_; }
  /// The coordinate's name: a natural parameter's, or inflection_age, start_age, ln_scale_age, X0.
  std::string name(int k) const;
  Eigen::VectorXd from_natural(const GrowthVector& natural) const;
  /// Natural parameters at phi and their derivatives; false outside their range.
  bool to_natural(const Eigen::VectorXd& phi, GrowthVector& natural, GrowthMatrix& slopes) const;

 private:
  int natural_row(int k) const;
  bool start_to_natural(const Eigen::VectorXd& phi, GrowthVector& natural, GrowthMatrix& slopes) const;

  GrowthCurve curve_;
  int own_;
  bool start_ = false;
  std::vector<int> row_;
};

}  // namespace dendrofit
