// SPDX-License-Identifier: GPL-3.0-or-later
#include "fit/growth_statistics.h"

#include <cmath>
#include <numbers>
#include <numeric>

namespace dendrofit {
namespace {

// P(|T| <= t), Abramowitz & Stegun 26.7.3 (odd) and 26.7.4 (even).
double two_sided_probability(double t, int degrees) {
  const double angle = std::atan2(t, std::sqrt(static_cast<double>(degrees)));
  const double cosine = std::cos(angle), square = cosine * cosine;
  double term = degrees % 2 ? cosine : 1, sum = 0;
  for (int k = degrees % 2 ? 3 : 2; k <= degrees; k += 2) {
    sum += term;
    term *= square * (k - 1) / k;
  }
  const double series = std::sin(angle) * sum;
  return degrees % 2 ? 2 / std::numbers::pi * (angle + series) : series;
}

}  // namespace

double student_t_two_sided(double confidence, int degrees) {
  double lo = 0, hi = 1;
  while (two_sided_probability(hi, degrees) < confidence && hi < 1e12) hi *= 2;
  for (int i = 0; i < 200 && hi - lo > 1e-15 * hi; ++i) {
    const double middle = 0.5 * (lo + hi);
    (two_sided_probability(middle, degrees) < confidence ? lo : hi) = middle;
  }
  return 0.5 * (lo + hi);
}

double normal_cdf(double z) {
  return 0.5 * std::erfc(-z / std::numbers::sqrt2);
}

double lag1_correlation(const std::vector<double>& values) {
  if (values.size() < 3) return 0;
  const double mean = std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
  double products = 0, squares = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    squares += (values[i] - mean) * (values[i] - mean);
    if (i > 0) products += (values[i] - mean) * (values[i - 1] - mean);
  }
  return squares > 0 ? products / squares : 0;
}

double runs_z(const std::vector<double>& values) {
  double up = 0, down = 0, runs = 0;
  int last = 0;
  for (double value : values) {
    const int sign = value > 0 ? 1 : -1;
    (sign > 0 ? up : down) += 1;
    if (sign != last) runs += 1;
    last = sign;
  }
  const double n = up + down;
  if (up < 2 || down < 2) return 0;
  const double mean = 1 + 2 * up * down / n;
  const double variance = (mean - 1) * (mean - 2) / (n - 1);
  return variance > 0 ? (runs - mean) / std::sqrt(variance) : 0;
}

}  // namespace dendrofit
