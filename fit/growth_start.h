// SPDX-License-Identifier: GPL-3.0-or-later
// Where a growth-curve fit starts, and what it tends to when the final size is endless.
// Internal to the growth-curve files of this floor.
#pragma once

#include "fit/growth_curve.h"
#include "fit/growth_options.h"
#include "fit/growth_solver.h"

#include <vector>

namespace dendrofit {

/// Natural parameters of the best cells, best first, of a grid over the shape parameters (logarithmic, up to
/// 36 x 50) with the scale (and offset) by linear least squares or, with a robust loss, by reweighting. Cells
/// are local minima or lie apart. Empty where no cell has a positive size.
std::vector<GrowthVector> automatic_starts(const GrowthCurve& curve, const GrowthData& data, GrowthLoss loss,
                                           double loss_scale, int most = 6);

/// The curve that an equation tends to as its final size grows without end: X0 e^(gt) for logistic, Gompertz
/// and Richards, K t^c for Weibull, Chapman-Richards, Korf and Hossfeld IV, K t^3 for Bertalanffy, A + g t
/// for the monomolecular.
struct GrowthLimit {
  double rss = 0;
  /// Derivative of the residual sum of squares as the final size becomes finite; negative means that a finite
  /// optimum exists. Zero where it is not known.
  double slope = 0;
};
GrowthLimit fit_limit_curve(const GrowthCurve& curve, const GrowthData& data);

}  // namespace dendrofit
