// SPDX-License-Identifier: GPL-3.0-or-later
// What a growth-curve fit may be told; the defaults need nothing but the measurements.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace dendrofit {

/// Robust losses, as Ceres defines them: of the squared residual, with a scale in the values' unit beyond
/// which a measurement loses influence.
enum class GrowthLoss { none, huber, soft_l1, cauchy, arctan, tukey };
/// The loss of that name (none, huber, soft_l1, cauchy, arctan, tukey); throws InputError naming the nearest.
GrowthLoss growth_loss(const std::string& name);
std::string growth_loss_name(GrowthLoss loss);

/// How much each measurement counts: equally, or with a variance in proportion to its value or its square.
enum class GrowthWeights { equal, inverse_value, inverse_square };
/// The scheme of that name (equal, inverse_value, inverse_square); throws InputError naming the nearest.
GrowthWeights growth_weights(const std::string& name);
std::string growth_weights_name(GrowthWeights weights);

/// What varies from series to series in the mixed model.
enum class GrowthMixedEffects { none, asymptote, asymptote_and_rate };

/// What all series share in the mixed model besides the equation: the curve's shape in time (inflection or
/// scale age), or the size at age 0 (logistic, Gompertz, monomolecular; the others start from nothing either
/// way).
enum class GrowthMixedForm { shape, start };

/// Limits on a natural parameter, in the measurements' units.
struct GrowthBounds {
  std::optional<double> lo;
  std::optional<double> hi;
};

struct GrowthOptions {
  /// Names as in forward/growth_equations.h.
  std::vector<std::string> equations{"logistic", "bertalanffy", "weibull"};
  /// By growth.json name ("Xm", "w3", "offset", "time_shift") or by "equation.name" for one equation alone; a
  /// name that no chosen equation has is an error. "asymptote" means each equation's own.
  std::map<std::string, double> fixed;
  std::map<std::string, GrowthBounds> bounds;
  /// Starting values, tried before the automatic ones.
  std::map<std::string, double> start;
  bool automatic_starts = true;       ///< false: from `start` alone, which then names every parameter
  bool fit_offset = false;            ///< X = offset + f(t)
  bool fit_time_shift = false;        ///< X = f(t + time_shift); only for equations that start from nothing
  double offset = 0;                  ///< a known size at the origin (e.g. 1.3 m), added to every curve
  std::optional<double> origin_time;  ///< subtracted from every time: the year of germination or planting

  GrowthWeights weights = GrowthWeights::equal;
  GrowthLoss loss = GrowthLoss::none;
  double loss_scale = 1;  ///< in the values' unit (times the root of the weight)

  double confidence = 0.95;
  bool profile_intervals = true;
  std::vector<double> band_times;  ///< ages of the bands; empty: 60 from 0 to the last age
  std::optional<double> base_age;  ///< for the site index

  bool pooled = true;  ///< also all series as one, where there are several
  GrowthMixedEffects mixed = GrowthMixedEffects::none;
  GrowthMixedForm mixed_form = GrowthMixedForm::shape;
  bool trunk_base_unmeasured = false;  ///< the user says that the first years are missing

  std::string abscissa = "age";     ///< what "time" is, in messages: "diameter" for height over diameter
  std::string time_unit = "years";  ///< label, and what "breast height" and "calendar year" mean
  std::string value_unit = "m";
  int threads = 0;  ///< 0: all cores

  /// Throws InputError naming field, value and limit.
  void validate() const;
};

}  // namespace dendrofit
