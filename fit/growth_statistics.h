// SPDX-License-Identifier: GPL-3.0-or-later
// The few distributions that growth-curve fitting needs, without a library.
#pragma once

#include <vector>

namespace dendrofit {

/// Upper quantile t with P(|T| <= t) = confidence for Student's t with `degrees` >= 1 degrees of freedom;
/// confidence in (0, 1). Exact finite sums (Abramowitz & Stegun 26.7.3-4), good to 1e-12.
double student_t_two_sided(double confidence, int degrees);

/// P(Z <= z) for the standard normal.
double normal_cdf(double z);

/// Correlation of each value with the next one; 0 for fewer than three values or without variation.
double lag1_correlation(const std::vector<double>& values);

/// Wald-Wolfowitz z score of the number of runs of equal sign; negative where signs cluster, 0 where it has
/// no meaning.
double runs_z(const std::vector<double>& values);

}  // namespace dendrofit
