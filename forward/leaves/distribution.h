// SPDX-License-Identifier: GPL-3.0-or-later
// One-dimensional distributions that leaf options speak of: where along something in [0, 1], and how steep.
#pragma once

#include <functional>
#include <string_view>
#include <vector>

namespace dendrofit {

/// A distribution on [0, 1], named and with its parameters, as options give it.
struct UnitDistribution {
  enum class Kind {
    uniform,
    beta,       ///< a, b > 0
    weibull,    ///< scale a > 0, shape b > 0, cut at 1
    von_mises,  ///< periodic: mean a (in [0, 1], a full turn), concentration b >= 0
    table,      ///< masses of equal bins; need not sum to 1
    mixture     ///< of `parts`, weighted by `table`
  };
  Kind kind = Kind::uniform;
  double a = 1;
  double b = 1;
  std::vector<double> table;
  std::vector<UnitDistribution> parts;

  static UnitDistribution uniform() { return {}; }
  static UnitDistribution beta(double a, double b) { return {Kind::beta, a, b, {}, {}}; }
  static UnitDistribution weibull(double scale, double shape) {
    return {Kind::weibull, scale, shape, {}, {}};
  }
  static UnitDistribution von_mises(double mean, double kappa) {
    return {Kind::von_mises, mean, kappa, {}, {}};
  }
  static UnitDistribution histogram(std::vector<double> masses) {
    return {Kind::table, 1, 1, std::move(masses), {}};
  }
  static UnitDistribution mixture(std::vector<UnitDistribution> parts, std::vector<double> weights) {
    return {Kind::mixture, 1, 1, std::move(weights), std::move(parts)};
  }

  /// Relative density at x in [0, 1] (not normalised).
  double density(double x) const;
  /// Throws InputError naming `field` for parameters out of range or a table without mass.
  void validate(std::string_view field) const;
};

/// How steep leaves stand: the inclination of the normal from the zenith, in [0, pi/2].
struct InclinationLaw {
  enum class Kind {
    planophile,    ///< de Wit (1965): mostly horizontal
    erectophile,   ///< de Wit: mostly vertical
    plagiophile,   ///< de Wit: mostly about 45 degrees
    extremophile,  ///< de Wit: horizontal or vertical
    uniform,       ///< every inclination as often
    spherical,     ///< as the surface elements of a sphere
    beta,          ///< Goel & Strebel (1984): inclination / 90 degrees ~ beta(a, b)
    ellipsoidal,   ///< Campbell (1990): ratio a = horizontal over vertical semi-axis
    table          ///< a histogram over equal bins of [0, 90] degrees: masses or densities, normalised here
  };
  Kind kind = Kind::planophile;
  double a = 1;
  double b = 1;
  std::vector<double> table;

  /// Relative density at `theta` radians (not normalised).
  double density(double theta) const;
  void validate(std::string_view field) const;
};

/// "planophile", ... ; throws InputError for another word.
InclinationLaw inclination_law(std::string_view word);
std::string_view to_string(InclinationLaw::Kind kind);

/// Any of these as numbers to draw from: integrated once, on an even grid over [lo, hi].
class TabulatedLaw {
 public:
  TabulatedLaw(double lo, double hi, const std::function<double(double)>& density);
  explicit TabulatedLaw(const UnitDistribution& distribution);
  explicit TabulatedLaw(const InclinationLaw& law);

  double cdf(double x) const;
  /// The x with cdf(x) = u.
  double quantile(double u) const;
  double mean() const;

 private:
  double lo_;
  double hi_;
  std::vector<double> cumulative_;
};

/// Kolmogorov-Smirnov distance between weighted samples and a law, and its asymptotic p-value.
struct KsResult {
  double distance = 0;
  double p_value = 1;
  std::size_t samples = 0;
};

/// `weights` empty: equal. The p-value uses the effective number of samples (sum w)^2 / sum w^2.
KsResult kolmogorov_smirnov(std::vector<double> samples, std::vector<double> weights,
                            const std::function<double(double)>& cdf);
/// Of two distributions given by masses of the same bins, `effective` samples in the second.
KsResult kolmogorov_smirnov_binned(const std::vector<double>& requested, const std::vector<double>& achieved,
                                   double effective);

}  // namespace dendrofit
