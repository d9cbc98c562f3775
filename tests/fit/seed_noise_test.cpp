// SPDX-License-Identifier: GPL-3.0-or-later
#include "fit/seed_noise.h"

#include "core/random.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

namespace dendrofit {
namespace {

/// Trees of one parameter set: four descriptors about `mean` with standard deviations of `noise` times 1 to
/// 4, the first two correlated by 0.8.
Eigen::MatrixXd group(Random& random, double mean, double noise, int trees) {
  Eigen::MatrixXd rows(trees, 4);
  for (int k = 0; k < trees; ++k) {
    const double first = random.normal();
    rows(k, 0) = mean + noise * first;
    rows(k, 1) = mean + 2 * noise * (0.8 * first + 0.6 * random.normal());
    rows(k, 2) = mean + 3 * noise * random.normal();
    rows(k, 3) = mean + 4 * noise * random.normal();
  }
  return rows;
}

TEST(SeedNoise, is_what_trees_of_one_parameter_set_differ_by_whatever_the_sets) {
  Random random(3);
  std::vector<Eigen::MatrixXd> groups;
  for (int g = 0; g < 200; ++g) groups.push_back(group(random, 100 * random.uniform(), 1, 8));
  const SeedNoise noise = noise_within(groups);
  for (Eigen::Index j = 0; j < 4; ++j) EXPECT_NEAR(noise.deviation(j), double(j + 1), 0.1 * double(j + 1));
  // shrunk by a tenth
  EXPECT_NEAR(noise.covariance(0, 1) / (noise.deviation(0) * noise.deviation(1)), 0.72, 0.05);
  EXPECT_NEAR(noise.covariance(2, 3) / (noise.deviation(2) * noise.deviation(3)), 0, 0.1);
}

TEST(SeedNoise, a_few_sets_whose_trees_die_early_do_not_speak_for_the_others) {
  Random random(5);
  std::vector<Eigen::MatrixXd> groups;
  for (int g = 0; g < 100; ++g) groups.push_back(group(random, 10, g % 10 == 0 ? 100 : 1, 8));
  const SeedNoise noise = noise_within(groups);
  for (Eigen::Index j = 0; j < 4; ++j) EXPECT_NEAR(noise.deviation(j), double(j + 1), 0.2 * double(j + 1));
}

TEST(SeedNoise, of_a_descriptor_never_seen_is_unknown) {
  Random random(7);
  std::vector<Eigen::MatrixXd> groups;
  for (int g = 0; g < 40; ++g) {
    groups.push_back(group(random, 0, 1, 8));
    groups.back().col(2).setConstant(std::numeric_limits<double>::quiet_NaN());
  }
  const SeedNoise noise = noise_within(groups);
  EXPECT_TRUE(std::isnan(noise.deviation(2)));
  EXPECT_TRUE(std::isfinite(noise.deviation(3)));
}

TEST(SeedNoise, about_a_trend_is_what_a_quadratic_leaves) {
  Random random(9);
  Eigen::MatrixXd parameters(600, 2), descriptors(600, 2);
  for (Eigen::Index i = 0; i < 600; ++i) {
    const double a = random.uniform(), b = random.uniform();
    parameters.row(i) << a, b;
    descriptors.row(i) << 30 * a * a - 10 * b + random.normal(), 20 * b + 2 * random.normal();
  }
  const SeedNoise noise = noise_about_trend(parameters, descriptors);
  EXPECT_NEAR(noise.deviation(0), 1, 0.15);
  EXPECT_NEAR(noise.deviation(1), 2, 0.3);
}

}  // namespace
}  // namespace dendrofit
