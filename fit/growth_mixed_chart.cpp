// SPDX-License-Identifier: GPL-3.0-or-later
#include "fit/growth_mixed_chart.h"

#include <cmath>
#include <string_view>

namespace dendrofit {

using Eigen::VectorXd;

MixedChart::MixedChart(const GrowthCurve& curve, GrowthMixedForm form)
    : curve_(curve), own_(curve.own_size()) {
  const std::string_view name = curve.equation().name;
  start_ =
      form == GrowthMixedForm::start && (name == "logistic" || name == "gompertz" || name == "monomolecular");
  for (int k = 0; k < own_; ++k) row_.push_back(natural_row(k));
}

std::string MixedChart::name(int k) const {
  if (start_ && k == 2) return "X0";
  if (row_[k] >= 0) return curve_.name(row_[k]);
  if (curve_.equation().name == "logistic" || curve_.equation().name == "gompertz" ||
      curve_.equation().name == "richards")
    return "inflection_age";
  return curve_.equation().name == "monomolecular" ? "start_age" : "ln_scale_age";
}

VectorXd MixedChart::from_natural(const GrowthVector& natural) const {
  VectorXd phi(own_);
  const GrowthVector c = curve_.to_chart(GrowthChart::shape, natural);
  for (int k = 0; k < own_; ++k) phi[k] = row_[k] >= 0 ? natural[row_[k]] : c[k];
  if (start_) phi[2] = curve_.value(natural, 0) - curve_.base();
  return phi;
}

bool MixedChart::to_natural(const VectorXd& phi, GrowthVector& natural, GrowthMatrix& slopes) const {
  if (!(phi[0] > 0)) return false;
  if (start_) return start_to_natural(phi, natural, slopes);
  GrowthVector c(own_);
  for (int k = 0; k < own_; ++k) {
    if (row_[k] >= 0 && !(phi[k] > 0)) return false;
    c[k] = row_[k] >= 0 ? std::log(phi[k]) : phi[k];
  }
  natural = curve_.to_natural(GrowthChart::shape, c, &slopes);
  for (int k = 0; k < own_; ++k)
    if (row_[k] >= 0) slopes.col(k) /= phi[k];
  return natural.allFinite() && slopes.allFinite();
}

// The positive natural parameter that shape coordinate k is the logarithm of, or -1.
int MixedChart::natural_row(int k) const {
  for (int i = 0; i < own_; ++i)
    if (curve_.is_positive(i) && curve_.coordinate(GrowthChart::shape, i) == k) return i;
  return -1;
}

bool MixedChart::start_to_natural(const VectorXd& phi, GrowthVector& natural, GrowthMatrix& slopes) const {
  const double a = phi[0], rate = phi[1], x0 = phi[2];
  natural.resize(3);
  slopes.setZero(3, 3);
  if (!(rate > 0)) return false;
  if (curve_.equation().name == "logistic") {  // X0, Xm, r
    natural << x0, a, rate;
    slopes(0, 2) = slopes(1, 0) = slopes(2, 1) = 1;
    return x0 > 0;
  }
  if (curve_.equation().name == "gompertz") {  // a, b = ln(a/X0), c
    if (!(x0 > 0) || !(a > x0)) return false;
    natural << a, std::log(a / x0), rate;
    slopes(0, 0) = slopes(2, 1) = 1;
    slopes(1, 0) = 1 / a;
    slopes(1, 2) = -1 / x0;
    return true;
  }
  natural << a, 1 - x0 / a, rate;  // monomolecular: a, c = 1 - X0/a, b
  slopes(0, 0) = slopes(2, 1) = 1;
  slopes(1, 0) = x0 / (a * a);
  slopes(1, 2) = -1 / a;
  return true;
}

}  // namespace dendrofit
