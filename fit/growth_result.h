// SPDX-License-Identifier: GPL-3.0-or-later
// What a growth-curve fit gives: numbers with their uncertainty, and in words what the data cannot say.
#pragma once

#include <limits>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

namespace dendrofit {

constexpr double kGrowthNaN = std::numeric_limits<double>::quiet_NaN();

enum class GrowthStatus { ok, no_finite_optimum, too_few_points, ill_conditioned, failed };
/// As in growth.json.
std::string growth_status_name(GrowthStatus status);

/// One natural parameter. Limits are those of the profile likelihood; an unbounded side is infinite, or the
/// end of the parameter's range (0). NaN where there is no number to give.
struct GrowthParameter {
  std::string name;  ///< as in growth.json
  std::string unit;  ///< in the data's units, e.g. "m", "1/years"
  double value = kGrowthNaN;
  double se = kGrowthNaN;
  double lo = kGrowthNaN;
  double hi = kGrowthNaN;
  bool fixed = false;
  bool at_bound = false;  ///< stopped by the user's bound: no standard error
};

/// What foresters read off a curve. Ages on the data's time axis; NaN where the curve has no such point.
struct GrowthDerived {
  double asymptote = kGrowthNaN;
  double asymptote_se = kGrowthNaN;
  double inflection_age = kGrowthNaN;
  double inflection_age_se = kGrowthNaN;
  double inflection_value = kGrowthNaN;
  double max_increment = kGrowthNaN;  ///< largest current annual increment (CAI), at the inflection
  double max_increment_se = kGrowthNaN;
  double mai_culmination_age = kGrowthNaN;  ///< where the mean annual increment X/t is largest (CAI = MAI)
  double mai_culmination_age_se = kGrowthNaN;
  double max_mai = kGrowthNaN;
  double scale_age = kGrowthNaN;               ///< Weibull: w2^(-1/w3), the age of 63 % of the final size
  double years_to_breast_height = kGrowthNaN;  ///< age at 1.3 m, for lengths in known units
  double site_index = kGrowthNaN;              ///< size at the base age
  double site_index_se = kGrowthNaN;
};

/// The curve and its pointwise bands (delta method, t quantile).
struct GrowthBandPoint {
  double time = 0;
  double fit = 0;
  double se = 0;
  double confidence_lo = 0, confidence_hi = 0;
  double prediction_lo = 0, prediction_hi = 0;
  double cai = 0;  ///< dX/dt
  double mai = 0;  ///< X/t; NaN at 0
};

/// Another minimum of the same sum of squares, worse than the one reported.
struct GrowthAlternative {
  std::vector<double> parameters;  ///< natural, in the fit's order
  double rss = kGrowthNaN;
};

struct GrowthFit {
  std::string equation;
  GrowthStatus status = GrowthStatus::failed;
  std::string reason;  ///< unless ok: series, cause and remedy in the field's words
  std::vector<std::string> warnings;
  int n = 0;
  std::vector<GrowthParameter> parameters;
  Eigen::MatrixXd covariance;       ///< of the natural parameters; empty where there is none
  double rss = kGrowthNaN;          ///< weighted
  double robust_cost = kGrowthNaN;  ///< half the sum of losses, with a robust loss
  double sigma = kGrowthNaN;
  double aic = kGrowthNaN, aicc = kGrowthNaN, bic = kGrowthNaN;  ///< parameters counted with the variance
  double rss_limit = kGrowthNaN;  ///< of the limit curve for an endless asymptote
  bool asymptote_bounded = false;
  double largest_correlation = kGrowthNaN;
  double scaled_condition = kGrowthNaN;  ///< of the column-scaled Jacobian
  double relative_offset = kGrowthNaN;
  int iterations = 0;
  bool profiled = false;  ///< limits are profile-likelihood ones, else Wald's
  GrowthDerived derived;
  std::vector<GrowthBandPoint> bands;
  std::vector<double> residuals;  ///< measured minus fitted, in file order
  double residual_lag1 = kGrowthNaN;
  std::optional<GrowthAlternative> second_best;

  const GrowthParameter* parameter(const std::string& name) const;
};

/// All equations on one series.
struct GrowthSeries {
  std::string name;
  std::vector<double> time;  ///< as fitted: origin subtracted
  std::vector<double> value;
  std::string best;  ///< lowest AICc among the ok fits; empty without any
  std::vector<std::string> warnings;
  std::vector<GrowthFit> fits;

  const GrowthFit* fit(const std::string& equation) const;
};

/// One series' own curve in a mixed model.
struct GrowthMixedSeries {
  std::string name;
  std::vector<double> parameters;  ///< fixed plus random effects, in the order of the fixed ones
};

/// Maximum likelihood as Lindstrom & Bates (1990): a population curve and what varies about it.
struct GrowthMixed {
  std::string equation;
  GrowthStatus status = GrowthStatus::failed;
  std::string reason;
  std::vector<GrowthParameter> fixed;  ///< population values; limits are Wald's (not profiled)
  std::vector<std::string> random;     ///< names of those that vary
  Eigen::MatrixXd random_covariance;
  double sigma = kGrowthNaN;
  double log_likelihood = kGrowthNaN, aic = kGrowthNaN, bic = kGrowthNaN;
  int n = 0, iterations = 0;
  std::vector<GrowthMixedSeries> series;
  std::vector<GrowthBandPoint> population;  ///< bands of the mean curve; prediction: a new series
};

struct GrowthReport {
  std::string abscissa = "age", ordinate = "size";
  std::string time_unit, value_unit;
  double confidence = 0.95;
  std::vector<GrowthSeries> series;
  std::optional<GrowthSeries> pooled;
  std::vector<GrowthMixed> mixed;
  std::vector<std::string> warnings;

  /// Whether any fit anywhere has an answer (else exit code 4).
  bool any_ok() const;
};

}  // namespace dendrofit
