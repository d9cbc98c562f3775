// SPDX-License-Identifier: GPL-3.0-or-later
// What the options ask of one fit: the curve, the weights, what is held or bounded, and where to start.
// Internal to the growth-curve files of this floor.
#pragma once

#include "core/measurements.h"
#include "fit/growth_curve.h"
#include "fit/growth_options.h"
#include "fit/growth_solver.h"

#include <optional>
#include <string>
#include <vector>

namespace dendrofit {

/// By natural parameter of the curve.
struct GrowthConstraints {
  bool any = false;
  std::vector<std::optional<double>> fixed;
  std::vector<GrowthBounds> bounds;
};

GrowthCurve make_growth_curve(const std::string& name, const GrowthOptions& options);

/// `weights` where given, else by the options' scheme.
GrowthData make_growth_data(const MeasurementSeries& series, const GrowthOptions& options,
                            const std::vector<double>& weights);

/// Throws InputError for values outside a parameter's range.
GrowthConstraints read_growth_constraints(const GrowthCurve& curve, const GrowthOptions& options);

/// In the shape chart, or in the natural one where anything is held or bounded.
GrowthProblem make_growth_problem(const GrowthCurve& curve, const GrowthData& data,
                                  const GrowthConstraints& constraints);

/// Natural parameters: the user's start first, then the automatic ones.
std::vector<GrowthVector> starting_points(const GrowthCurve& curve, const GrowthData& data,
                                          const GrowthConstraints& constraints, const GrowthOptions& options);

}  // namespace dendrofit
