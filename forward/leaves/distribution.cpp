// SPDX-License-Identifier: GPL-3.0-or-later
#include "forward/leaves/distribution.h"

#include "core/errors.h"
#include "core/parameters.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <string>

namespace dendrofit {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr int kCells = 4096;

constexpr std::array<std::string_view, 9> kInclinationWords = {"planophile",   "erectophile", "plagiophile",
                                                               "extremophile", "uniform",     "spherical",
                                                               "beta",         "ellipsoidal", "table"};

double beta_density(double x, double a, double b) {
  // Off the very ends, where it may be infinite.
  const double y = std::clamp(x, 1e-6, 1 - 1e-6);
  return std::pow(y, a - 1) * std::pow(1 - y, b - 1);
}

double table_density(const std::vector<double>& table, double x) {
  const auto last = static_cast<double>(table.size()) - 1;
  return table[static_cast<std::size_t>(std::clamp(std::floor(x * (last + 1)), 0.0, last))];
}

double mass(const std::vector<double>& table) {
  return std::accumulate(table.begin(), table.end(), 0.0);
}

void require_table(const std::vector<double>& table, const std::string& field) {
  require(!table.empty(), field + ".table entries", 0, "at least one");
  for (double value : table)
    require(std::isfinite(value) && value >= 0, field + ".table", value, "must be at least 0");
  require(mass(table) > 0, field + ".table sum", mass(table), "must be positive");
}

void require_positive(double value, const std::string& field) {
  require(std::isfinite(value) && value > 0, field, value, "must be positive");
}

/// P(K > x) of Kolmogorov's distribution.
double kolmogorov_tail(double x) {
  if (x < 0.2) return 1;
  double sum = 0;
  for (int k = 1; k <= 100; ++k) {
    const double term = std::exp(-2.0 * k * k * x * x);
    sum += k % 2 ? term : -term;
    if (term < 1e-12) break;
  }
  return std::clamp(2 * sum, 0.0, 1.0);
}

double p_value(double distance, double n) {
  if (!(n > 0)) return 1;
  const double root = std::sqrt(n);
  // Stephens (1970): makes the asymptotic law good for small samples too.
  return kolmogorov_tail(distance * (root + 0.12 + 0.11 / root));
}

}  // namespace

double UnitDistribution::density(double x) const {
  if (!(x >= 0) || x > 1) return 0;
  switch (kind) {
    case Kind::uniform:
      return 1;
    case Kind::beta:
      return beta_density(x, a, b);
    case Kind::weibull: {
      const double y = std::max(x, 1e-9) / a;
      return std::pow(y, b - 1) * std::exp(-std::pow(y, b));
    }
    case Kind::von_mises:
      return std::exp(b * (std::cos(2 * kPi * (x - a)) - 1));
    case Kind::table:
      return table_density(table, x);
    case Kind::mixture:
      break;
  }
  double sum = 0;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    // Each part is normalised before it is weighted.
    double total = 0;
    for (int k = 0; k < 512; ++k) total += parts[i].density((k + 0.5) / 512) / 512;
    if (total > 0) sum += table[i] * parts[i].density(x) / total;
  }
  return sum;
}

void UnitDistribution::validate(std::string_view field) const {
  const std::string name(field);
  switch (kind) {
    case Kind::uniform:
      break;
    case Kind::beta:
    case Kind::weibull:
      require_positive(a, name + ".a");
      require_positive(b, name + ".b");
      break;
    case Kind::von_mises:
      require(std::isfinite(a), name + ".a", a, "must be finite");
      require(std::isfinite(b) && b >= 0, name + ".b", b, "must be at least 0");
      break;
    case Kind::table:
      require_table(table, name);
      break;
    case Kind::mixture:
      require_table(table, name);
      require(parts.size() == table.size(), name + ".parts", static_cast<double>(parts.size()),
              "one weight a part is needed");
      for (const UnitDistribution& part : parts) {
        require(part.kind != Kind::mixture, name + ".parts", 0, "a mixture of mixtures is not offered");
        part.validate(name + ".parts");
      }
      break;
  }
}

double InclinationLaw::density(double theta) const {
  const double x = theta / (kPi / 2);
  if (!(x >= 0) || x > 1) return 0;
  switch (kind) {
    case Kind::planophile:
      return 1 + std::cos(2 * theta);
    case Kind::erectophile:
      return 1 - std::cos(2 * theta);
    case Kind::plagiophile:
      return 1 - std::cos(4 * theta);
    case Kind::extremophile:
      return 1 + std::cos(4 * theta);
    case Kind::uniform:
      return 1;
    case Kind::spherical:
      return std::sin(theta);
    case Kind::beta:
      return beta_density(x, a, b);
    case Kind::ellipsoidal: {
      const double c = std::cos(theta), s = std::sin(theta);
      const double q = c * c + a * a * s * s;
      return a * a * a * s / (q * q);
    }
    case Kind::table:
      break;
  }
  return table_density(table, x);
}

void InclinationLaw::validate(std::string_view field) const {
  const std::string name(field);
  if (kind == Kind::beta || kind == Kind::ellipsoidal) require_positive(a, name + ".a");
  if (kind == Kind::beta) require_positive(b, name + ".b");
  if (kind == Kind::table) require_table(table, name);
}

InclinationLaw inclination_law(std::string_view word) {
  const auto* found = std::find(kInclinationWords.begin(), kInclinationWords.end(), word);
  if (found == kInclinationWords.end()) {
    const std::vector<std::string> known(kInclinationWords.begin(), kInclinationWords.end());
    throw InputError("leaf inclination '" + std::string(word) + "' is unknown; did you mean '" +
                     nearest_word(word, known) + "'?");
  }
  InclinationLaw law;
  law.kind = static_cast<InclinationLaw::Kind>(found - kInclinationWords.begin());
  return law;
}

std::string_view to_string(InclinationLaw::Kind kind) {
  return kInclinationWords[static_cast<std::size_t>(kind)];
}

TabulatedLaw::TabulatedLaw(double lo, double hi, const std::function<double(double)>& density)
    : lo_(lo), hi_(hi), cumulative_(kCells + 1, 0.0) {
  const double step = (hi - lo) / kCells;
  for (int k = 0; k < kCells; ++k)
    cumulative_[static_cast<std::size_t>(k) + 1] =
        cumulative_[static_cast<std::size_t>(k)] + density(lo + (k + 0.5) * step);
  const double total = cumulative_.back();
  for (std::size_t k = 0; k < cumulative_.size(); ++k)
    cumulative_[k] = total > 0 ? cumulative_[k] / total : static_cast<double>(k) / kCells;
}

TabulatedLaw::TabulatedLaw(const UnitDistribution& distribution)
    : TabulatedLaw(0, 1, [&](double x) { return distribution.density(x); }) {}

TabulatedLaw::TabulatedLaw(const InclinationLaw& law)
    : TabulatedLaw(0, kPi / 2, [&](double theta) { return law.density(theta); }) {}

double TabulatedLaw::cdf(double x) const {
  if (!(x > lo_)) return 0;
  if (x >= hi_) return 1;
  const double at = (x - lo_) / (hi_ - lo_) * kCells;
  const auto k = std::min(static_cast<std::size_t>(at), static_cast<std::size_t>(kCells - 1));
  return cumulative_[k] + (at - static_cast<double>(k)) * (cumulative_[k + 1] - cumulative_[k]);
}

double TabulatedLaw::quantile(double u) const {
  const auto above = std::upper_bound(cumulative_.begin(), cumulative_.end(), u);
  if (above == cumulative_.begin()) return lo_;
  if (above == cumulative_.end()) {
    // u = 1: the end of the last cell that holds anything.
    const auto first_full = std::lower_bound(cumulative_.begin(), cumulative_.end(), 1.0);
    return lo_ + (hi_ - lo_) * static_cast<double>(first_full - cumulative_.begin()) / kCells;
  }
  const auto k = static_cast<std::size_t>(above - cumulative_.begin()) - 1;
  const double within = (u - cumulative_[k]) / (cumulative_[k + 1] - cumulative_[k]);
  return lo_ + (hi_ - lo_) * (static_cast<double>(k) + within) / kCells;
}

double TabulatedLaw::mean() const {
  double sum = 0;
  for (int k = 0; k < kCells; ++k)
    sum += (cumulative_[static_cast<std::size_t>(k) + 1] - cumulative_[static_cast<std::size_t>(k)]) *
           (lo_ + (hi_ - lo_) * (k + 0.5) / kCells);
  return sum;
}

KsResult kolmogorov_smirnov(std::vector<double> samples, std::vector<double> weights,
                            const std::function<double(double)>& cdf) {
  KsResult result;
  result.samples = samples.size();
  if (samples.empty()) return result;
  if (weights.empty()) weights.assign(samples.size(), 1.0);
  std::vector<std::size_t> order(samples.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(),
            [&](std::size_t i, std::size_t j) { return samples[i] < samples[j]; });
  double total = 0, squares = 0;
  for (double w : weights) {
    total += w;
    squares += w * w;
  }
  double below = 0;
  for (std::size_t k = 0; k < order.size();) {
    const double x = samples[order[k]];
    const double f = cdf(x);
    // A law may jump at x (a constant length); its value just below counts against the samples below.
    const double f_below = cdf(std::nextafter(x, -std::numeric_limits<double>::infinity()));
    result.distance = std::max(result.distance, std::abs(f_below - below / total));
    for (; k < order.size() && samples[order[k]] == x; ++k) below += weights[order[k]];
    result.distance = std::max(result.distance, std::abs(f - below / total));
  }
  result.p_value = p_value(result.distance, total * total / squares);
  return result;
}

KsResult kolmogorov_smirnov_binned(const std::vector<double>& requested, const std::vector<double>& achieved,
                                   double effective) {
  KsResult result;
  result.samples = static_cast<std::size_t>(effective);
  double a = 0, b = 0;
  const double sum_a = mass(requested), sum_b = mass(achieved);
  if (!(sum_a > 0) || !(sum_b > 0)) return result;
  for (std::size_t k = 0; k < requested.size(); ++k) {
    a += requested[k] / sum_a;
    b += achieved[k] / sum_b;
    result.distance = std::max(result.distance, std::abs(a - b));
  }
  result.p_value = p_value(result.distance, effective);
  return result;
}

}  // namespace dendrofit
