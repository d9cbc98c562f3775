// SPDX-License-Identifier: GPL-3.0-or-later
#include "fit/growth_constraints.h"

#include "core/errors.h"
#include "fit/growth_start.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace dendrofit {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// What the options say of natural parameter i, under any of its names.
template <class Map>
auto named(const Map& map, const GrowthCurve& curve, int i) {
  const std::string prefix = std::string(curve.equation().name) + ".";
  for (const auto& [name, value] : map) {
    const std::string own = name.starts_with(prefix) ? name.substr(prefix.size()) : name;
    if (curve.row(own) == i || (own == "asymptote" && i == curve.asymptote_row()))
      return std::optional(value);
  }
  return std::optional<typename Map::mapped_type>();
}

bool mentions(const GrowthOptions& options, const std::string& name) {
  return options.fixed.contains(name) || options.bounds.contains(name);
}

GrowthVector constrained(GrowthVector natural, const GrowthConstraints& constraints) {
  for (Eigen::Index i = 0; i < natural.size(); ++i) {
    if (constraints.fixed[i]) natural[i] = *constraints.fixed[i];
    if (constraints.bounds[i].lo) natural[i] = std::max(natural[i], *constraints.bounds[i].lo);
    if (constraints.bounds[i].hi) natural[i] = std::min(natural[i], *constraints.bounds[i].hi);
  }
  return natural;
}

}  // namespace

GrowthCurve make_growth_curve(const std::string& name, const GrowthOptions& options) {
  const GrowthEquation& equation = growth_equation(name);
  return {equation, options.fit_offset || mentions(options, "offset"),
          (options.fit_time_shift || mentions(options, "time_shift")) && equation.starts_at_zero,
          options.offset};
}

GrowthData make_growth_data(const MeasurementSeries& series, const GrowthOptions& options,
                            const std::vector<double>& weights) {
  GrowthData data{series.time, series.value, weights};
  if (weights.empty())
    for (double value : series.value)
      data.weight.push_back(options.weights == GrowthWeights::inverse_value    ? 1 / value
                            : options.weights == GrowthWeights::inverse_square ? 1 / (value * value)
                                                                               : 1);
  return data;
}

GrowthConstraints read_growth_constraints(const GrowthCurve& curve, const GrowthOptions& options) {
  GrowthConstraints constraints;
  for (int i = 0; i < curve.size(); ++i) {
    constraints.fixed.push_back(named(options.fixed, curve, i));
    constraints.bounds.push_back(named(options.bounds, curve, i).value_or(GrowthBounds{}));
    if (constraints.fixed.back() && curve.is_positive(i))
      require(*constraints.fixed.back() > 0, "fixed." + curve.name(i), *constraints.fixed.back(),
              "must be above 0");
    if (constraints.bounds.back().hi && curve.is_positive(i))
      require(*constraints.bounds.back().hi > 0, "bounds." + curve.name(i), *constraints.bounds.back().hi,
              "the upper limit must be above 0");
    constraints.any |=
        constraints.fixed.back() || constraints.bounds.back().lo || constraints.bounds.back().hi;
  }
  return constraints;
}

GrowthProblem make_growth_problem(const GrowthCurve& curve, const GrowthData& data,
                                  const GrowthConstraints& constraints) {
  GrowthProblem problem(curve, constraints.any ? GrowthChart::natural : GrowthChart::shape, data);
  for (int i = 0; constraints.any && i < curve.size(); ++i) {
    problem.held[i] = constraints.fixed[i].has_value();
    const auto coordinate = [&](double x) {
      return curve.is_positive(i) ? (x > 0 ? std::log(x) : -kInfinity) : x;
    };
    if (constraints.bounds[i].lo) problem.lo[i] = coordinate(*constraints.bounds[i].lo);
    if (constraints.bounds[i].hi) problem.hi[i] = coordinate(*constraints.bounds[i].hi);
  }
  return problem;
}

std::vector<GrowthVector> starting_points(const GrowthCurve& curve, const GrowthData& data,
                                          const GrowthConstraints& constraints,
                                          const GrowthOptions& options) {
  std::vector<GrowthVector> starts;
  if (options.automatic_starts) {
    const bool many = constraints.any || options.loss != GrowthLoss::none;
    for (const GrowthVector& natural :
         automatic_starts(curve, data, options.loss, options.loss_scale, many ? 40 : 6))
      starts.push_back(constrained(natural, constraints));
  }
  if (!options.start.empty()) {
    GrowthVector natural = starts.empty() ? GrowthVector::Zero(curve.size()) : starts.front();
    bool complete = true;
    for (int i = 0; i < curve.size(); ++i) {
      const auto given = named(options.start, curve, i);
      if (given) natural[i] = *given;
      complete &= given || constraints.fixed[i] || i >= curve.own_size() || !starts.empty();
    }
    if (complete) starts.insert(starts.begin(), constrained(natural, constraints));
  }
  return starts;
}

}  // namespace dendrofit
