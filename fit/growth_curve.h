// SPDX-License-Identifier: GPL-3.0-or-later
// A growth equation with its optional offset and time shift, and the coordinates ("charts") in which it is
// fitted. Internal to the growth-curve files of this floor.
#pragma once

#include "forward/growth_equations.h"

#include <optional>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

namespace dendrofit {

constexpr int kMostGrowthParameters = 6;
using GrowthVector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMostGrowthParameters, 1>;
using GrowthMatrix =
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMostGrowthParameters, kMostGrowthParameters>;

/// Coordinates of a curve. `shape`: logarithms of the final size and of rates, with an age (inflection, scale
/// or start) in place of the parameter that is badly determined alone. `natural`: logarithms of the
/// equation's own positive parameters, the others as they are. In both, offset and time shift come last, as
/// they are.
enum class GrowthChart { shape, natural };

/// X(t) = base + offset + f(t + time_shift; p), with a known base (usually 0). Parameters "natural" are those
/// of the equation in its table's order, then the offset and the time shift where they are fitted.
class GrowthCurve {
 public:
  GrowthCurve(const GrowthEquation& equation, bool with_offset, bool with_time_shift, double base = 0)
      : equation_(&equation), offset_(with_offset), shift_(with_time_shift), base_(base) {}

  const GrowthEquation& equation() const { return *equation_; }
  int own_size() const { return static_cast<int>(equation_->parameters.size()); }
  int size() const { return own_size() + (offset_ ? 1 : 0) + (shift_ ? 1 : 0); }
  double base() const { return base_; }
  bool has_offset() const { return offset_; }
  bool has_time_shift() const { return shift_; }
  int asymptote_row() const { return static_cast<int>(equation_->asymptote_row); }
  /// Names as in growth.json.
  std::string name(int i) const;
  std::string unit(int i) const;
  /// Row of a growth.json name or a file key; -1 where unknown.
  int row(std::string_view name) const;
  bool is_positive(int i) const { return i < own_size() && equation_->parameters[i].lo > 0; }

  double value(const GrowthVector& natural, double t) const;
  double rate(const GrowthVector& natural, double t) const;
  void gradient(const GrowthVector& natural, double t, GrowthVector& g) const;
  /// base + offset + equation's asymptote.
  double asymptote(const GrowthVector& natural) const;
  double inflection_age(const GrowthVector& natural) const;
  double age_at(const GrowthVector& natural, double x) const;

  /// The chart coordinate that alone decides natural parameter i; none in the shape chart for a mixed one.
  std::optional<int> coordinate(GrowthChart chart, int i) const;
  GrowthVector to_chart(GrowthChart chart, const GrowthVector& natural) const;
  /// Natural parameters at chart coordinates c, and d natural / d c where asked for.
  GrowthVector to_natural(GrowthChart chart, const GrowthVector& c, GrowthMatrix* jacobian = nullptr) const;

 private:
  std::span<const double> own(const GrowthVector& natural) const {
    return {natural.data(), equation_->parameters.size()};
  }
  double offset_of(const GrowthVector& natural) const { return base_ + (offset_ ? natural[own_size()] : 0); }
  double shift_of(const GrowthVector& natural) const { return shift_ ? natural[size() - 1] : 0; }

  const GrowthEquation* equation_;
  bool offset_;
  bool shift_;
  double base_;
};

}  // namespace dendrofit
