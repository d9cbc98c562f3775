// SPDX-License-Identifier: GPL-3.0-or-later
// Which IGM parameters a fit searches and over which ranges: the same for every tree, in internodes and
// cycles, so that simulations drawn from them serve every fit.
#pragma once

#include "forward/igm/parameters.h"

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

namespace dendrofit {

/// How a coordinate of the unit box becomes a value.
enum class SearchScale { linear, logarithmic, whole };

/// One searched coordinate; the prior is uniform between lo and hi on its scale.
struct SearchRow {
  std::string_view key;
  double lo = 0;
  double hi = 0;
  SearchScale scale = SearchScale::linear;
  bool of_species =
      true;  ///< the same for all trees of one kind (size, age and the like are each tree's own)
};

/// A parameter as fit.json names it, with its range over the whole box.
struct ReportedRow {
  std::string key;
  double lo = 0;
  double hi = 0;
};

/// The time course of a growth curve known from dated measurements: the equation's own parameters with the
/// asymptote set to 1 and time in cycles.
struct GrowthCourse {
  std::vector<double> equation_values;
};

/// Maps the unit box to parameter sets. The growth equation is searched in coordinates that mean the same for
/// each of the three: `size` (X at the end, internodes), `maturity` (the share of the asymptote reached by
/// then), `cycles` and `shape` (Weibull's third parameter; without influence on the others). Its own
/// parameters follow. The shape of the tree does not depend on the internode length, which is set apart.
class SearchSpace {
 public:
  /// `equation`: logistic, bertalanffy or weibull; throws InputError for another.
  explicit SearchSpace(const std::string& equation);

  /// The growth equations that have a search space.
  static const std::vector<std::string>& equations();

  const std::vector<SearchRow>& rows() const { return rows_; }
  Eigen::Index size() const { return static_cast<Eigen::Index>(rows_.size()); }
  Eigen::Index row(std::string_view key) const;
  const std::string& equation() const { return base_.equation; }

  /// Holds a coordinate at a value (which may lie outside its range).
  void fix(std::string_view key, double value);
  /// Holds the time course, and with it the maturity and the shape; needs fixed cycles.
  void fix_course(const GrowthCourse& course);
  /// Narrows or moves a coordinate's range.
  void limit(std::string_view key, double lo, double hi);
  void set_internode_length(double metres) { base_.rho_m = metres; }
  bool fixed(Eigen::Index row) const { return fixed_[static_cast<std::size_t>(row)].has_value(); }

  double value(Eigen::Index row, double unit) const;
  /// The coordinate that has this value, within [0, 1].
  double unit(Eigen::Index row, double value) const;
  IgmParameters at(const Eigen::VectorXd& unit) const;

  /// The growth equation's own parameters first; `fixed` ones are left out.
  std::vector<ReportedRow> reported() const;
  /// Values of reported() at a point of the box.
  Eigen::VectorXd report(const Eigen::VectorXd& unit, const std::vector<ReportedRow>& rows) const;

 private:
  void set_course(IgmParameters& parameters, double size, double maturity, double cycles, double shape) const;
  IgmParameters base_;
  std::vector<SearchRow> rows_;
  std::vector<std::optional<double>> fixed_;
  std::optional<GrowthCourse> course_;
};

}  // namespace dendrofit
