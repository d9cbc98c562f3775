// SPDX-License-Identifier: GPL-3.0-or-later
#include "fit/regression_posterior.h"

#include "core/errors.h"
#include "core/random.h"

#include <gtest/gtest.h>

namespace dendrofit {
namespace {

struct Bank {
  Eigen::MatrixXd parameters;
  Eigen::MatrixXd descriptors;
};

/// Parameter 0 shows in descriptors 0 and 1 (unit noise), parameter 1 in none; 6 descriptors are pure noise.
Bank toy_bank(int n, std::uint64_t seed) {
  Random random(seed);
  Bank bank{Eigen::MatrixXd(n, 2), Eigen::MatrixXd(n, 8)};
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < 2; ++j) bank.parameters(i, j) = random.uniform();
    for (int j = 0; j < 8; ++j) bank.descriptors(i, j) = random.normal();
    bank.descriptors(i, 0) += 10 * bank.parameters(i, 0);
    bank.descriptors(i, 1) += 6 * bank.parameters(i, 0);
  }
  return bank;
}

TEST(RegressionPosterior, tells_what_shows_from_what_does_not) {
  const Bank bank = toy_bank(200, 1);
  Eigen::VectorXd observed = Eigen::VectorXd::Zero(8);
  observed[0] = 10 * 0.7;
  observed[1] = 6 * 0.7;
  const auto posterior = regression_posterior(bank.parameters, bank.descriptors, observed);
  EXPECT_NEAR(posterior[0].median, 0.7, 0.06);
  EXPECT_GT(posterior[0].shrinkage, 0.6);
  EXPECT_LT(posterior[0].hi - posterior[0].lo, 0.4);
  EXPECT_LT(posterior[1].shrinkage, 0.15);
  EXPECT_LT(posterior[1].lo, 0.2);
  EXPECT_GT(posterior[1].hi, 0.8);
}

TEST(RegressionPosterior, ninety_percent_intervals_cover_about_ninety_percent) {
  const Bank bank = toy_bank(200, 2);
  int covered = 0;
  constexpr int kTruths = 200;
  for (int t = 0; t < kTruths; ++t) {
    const Bank truth = toy_bank(1, 100 + static_cast<std::uint64_t>(t));
    const auto p =
        regression_posterior(bank.parameters, bank.descriptors, truth.descriptors.row(0).transpose())[0];
    covered += p.lo <= truth.parameters(0, 0) && truth.parameters(0, 0) <= p.hi;
  }
  EXPECT_GE(covered, 0.83 * kTruths);
  EXPECT_LE(covered, 0.97 * kTruths);
}

TEST(RegressionPosterior, too_few_simulations_give_the_prior) {
  const Bank bank = toy_bank(12, 3);
  const auto posterior = regression_posterior(bank.parameters, bank.descriptors, Eigen::VectorXd::Zero(8));
  EXPECT_EQ(posterior[0].shrinkage, 0);
  EXPECT_EQ(posterior[0].median, 0.5);
}

TEST(RegressionPosterior, refuses_sizes_that_disagree) {
  const Bank bank = toy_bank(50, 3);
  EXPECT_THROW(regression_posterior(bank.parameters, bank.descriptors, Eigen::VectorXd::Zero(3)), InputError);
}

}  // namespace
}  // namespace dendrofit
