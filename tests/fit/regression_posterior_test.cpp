// SPDX-License-Identifier: GPL-3.0-or-later
#include "fit/regression_posterior.h"

#include "core/errors.h"
#include "core/random.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

namespace dendrofit {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

/// Parameter 0 shows in descriptors 0 (squared) and 1 (unit noise), parameter 1 in none; 6 descriptors are
/// pure noise.
PriorSimulations toy_bank(int n, std::uint64_t seed) {
  Random random(seed);
  PriorSimulations bank{Eigen::MatrixXd(n, 2), Eigen::MatrixXd(n, 8), Eigen::MatrixXd(n, 0), {}};
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < 2; ++j) bank.unit(i, j) = random.uniform();
    for (int j = 0; j < 8; ++j) bank.descriptors(i, j) = random.normal();
    bank.descriptors(i, 0) += 20 * bank.unit(i, 0) * bank.unit(i, 0);
    bank.descriptors(i, 1) += 6 * bank.unit(i, 0);
  }
  return bank;
}

Observation observe(const Eigen::VectorXd& descriptors, double error = 0) {
  return {descriptors, Eigen::VectorXd::Constant(descriptors.size(), error), Eigen::VectorXd(0)};
}

Eigen::VectorXd seen(double parameter) {
  Eigen::VectorXd observed = Eigen::VectorXd::Zero(8);
  observed[0] = 20 * parameter * parameter;
  observed[1] = 6 * parameter;
  return observed;
}

double width(const PosteriorSample& sample, Eigen::Index column) {
  return weighted_quantile(sample.unit.col(column), sample.weights, 0.95) -
         weighted_quantile(sample.unit.col(column), sample.weights, 0.05);
}

TEST(RegressionPosterior, tells_what_shows_from_what_does_not) {
  const auto posterior = regression_posterior(toy_bank(600, 1), observe(seen(0.7)));
  EXPECT_FALSE(posterior.is_prior);
  EXPECT_NEAR(posterior.weights.sum(), 1, 1e-9);
  EXPECT_NEAR(weighted_quantile(posterior.unit.col(0), posterior.weights, 0.5), 0.7, 0.05);
  EXPECT_LT(width(posterior, 0), 0.25);
  EXPECT_GT(width(posterior, 1), 0.75);
  EXPECT_TRUE(posterior.outlying.empty());
}

TEST(RegressionPosterior, ninety_percent_intervals_cover_about_ninety_percent) {
  const PriorSimulations bank = toy_bank(600, 2);
  int covered = 0;
  constexpr int kTruths = 200;
  for (int t = 0; t < kTruths; ++t) {
    const PriorSimulations truth = toy_bank(1, 100 + static_cast<std::uint64_t>(t));
    const auto p = regression_posterior(bank, observe(truth.descriptors.row(0).transpose()));
    const double value = truth.unit(0, 0);
    covered += weighted_quantile(p.unit.col(0), p.weights, 0.05) <= value &&
               value <= weighted_quantile(p.unit.col(0), p.weights, 0.95);
  }
  EXPECT_GE(covered, 0.83 * kTruths);
  EXPECT_LE(covered, 0.97 * kTruths);
}

TEST(RegressionPosterior, errors_of_the_observation_widen_intervals) {
  const PriorSimulations bank = toy_bank(600, 1);
  EXPECT_GT(width(regression_posterior(bank, observe(seen(0.5), 3)), 0),
            1.3 * width(regression_posterior(bank, observe(seen(0.5))), 0));
}

TEST(RegressionPosterior, what_is_known_beforehand_sharpens_what_hangs_on_it) {
  // descriptor 0 shows the sum of both parameters
  PriorSimulations bank = toy_bank(600, 5);
  bank.descriptors.col(1).setZero();
  bank.descriptors.col(0) = 10 * (bank.unit.col(0) + bank.unit.col(1));
  Eigen::VectorXd point = Eigen::VectorXd::Zero(8);
  point[0] = 10;
  const auto without = regression_posterior(bank, observe(point));
  bank.known = bank.unit.col(1);
  Observation observed = observe(point);
  observed.known = Eigen::VectorXd::Constant(1, 0.3);
  const auto with = regression_posterior(bank, observed);
  EXPECT_NEAR(weighted_quantile(with.unit.col(0), with.weights, 0.5), 0.7, 0.05);
  EXPECT_LT(width(with, 0), 0.5 * width(without, 0));
}

TEST(RegressionPosterior, descriptors_left_out_or_missing_play_no_part) {
  const PriorSimulations bank = toy_bank(400, 1);
  Eigen::VectorXd point = seen(0.7);
  point[0] = point[1] = kNone;
  const auto posterior = regression_posterior(bank, observe(point));
  EXPECT_GT(width(posterior, 0), 0.75);
}

TEST(RegressionPosterior, says_what_no_simulation_has) {
  Eigen::VectorXd point = seen(0.7);
  point[5] = 40;
  const auto posterior = regression_posterior(toy_bank(400, 1), observe(point));
  ASSERT_EQ(posterior.outlying.size(), 1u);
  EXPECT_EQ(posterior.outlying[0], 5);
}

TEST(RegressionPosterior, too_few_simulations_give_the_prior) {
  const PriorSimulations bank = toy_bank(12, 3);
  const auto posterior = regression_posterior(bank, observe(seen(0.7)));
  EXPECT_TRUE(posterior.is_prior);
  EXPECT_EQ(posterior.unit.rows(), 12);
}

TEST(RegressionPosterior, refuses_sizes_that_disagree) {
  EXPECT_THROW(regression_posterior(toy_bank(50, 3), observe(Eigen::VectorXd::Zero(3))), InputError);
}

}  // namespace
}  // namespace dendrofit
