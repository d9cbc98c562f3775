// SPDX-License-Identifier: GPL-3.0-or-later
#include "fit/growth_mixed.h"

#include "core/errors.h"
#include "tests/support/growth_data.h"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace dendrofit {
namespace {

std::vector<MeasurementSeries> stand(int trees, double spread, double rate_spread, double sigma) {
  std::vector<MeasurementSeries> all;
  Random random(7);
  for (int i = 0; i < trees; ++i)
    all.push_back(test::simulated("tree" + std::to_string(i + 1), "bertalanffy",
                                  {30 + spread * random.normal(), 0.04 + rate_spread * random.normal()},
                                  test::ages(10, 110, 10), sigma, 100 + i));
  return all;
}

TEST(GrowthMixed, FindsThePopulationAndItsSpread) {
  GrowthOptions options;
  options.mixed = GrowthMixedEffects::asymptote;
  const GrowthMixed mixed = fit_mixed_growth(stand(60, 4, 0, 0.5), "bertalanffy", options);
  ASSERT_EQ(mixed.status, GrowthStatus::ok) << mixed.reason;
  EXPECT_NEAR(mixed.fixed[0].value, 30, 3 * 4 / std::sqrt(60.0));
  EXPECT_NEAR(mixed.fixed[1].value, 0.04, 3 * mixed.fixed[1].se);
  EXPECT_NEAR(std::sqrt(mixed.random_covariance(0, 0)), 4, 1.2);
  EXPECT_NEAR(mixed.sigma, 0.5, 0.05);
  EXPECT_EQ(mixed.series.size(), 60u);
  EXPECT_EQ(mixed.population.size(), 61u);
  EXPECT_GT(mixed.population.back().prediction_hi - mixed.population.back().prediction_lo,
            mixed.population.back().confidence_hi - mixed.population.back().confidence_lo);
}

TEST(GrowthMixed, RateMayVaryToo) {
  GrowthOptions options;
  options.mixed = GrowthMixedEffects::asymptote_and_rate;
  const auto trees = stand(60, 4, 0.005, 0.3);
  const GrowthMixed both = fit_mixed_growth(trees, "bertalanffy", options);
  ASSERT_EQ(both.status, GrowthStatus::ok) << both.reason;
  EXPECT_NEAR(std::sqrt(both.random_covariance(1, 1)), 0.005, 0.0015);
  options.mixed = GrowthMixedEffects::asymptote;
  EXPECT_GT(both.log_likelihood, fit_mixed_growth(trees, "bertalanffy", options).log_likelihood + 10);
}

TEST(GrowthMixed, SaysWhyNot) {
  GrowthOptions options;
  EXPECT_THROW(fit_mixed_growth({}, "logistic", options), InputError);
  options.mixed = GrowthMixedEffects::asymptote;
  EXPECT_THAT(fit_mixed_growth({test::rat42()}, "logistic", options).reason,
              testing::AllOf(testing::HasSubstr("1 usable series"), testing::HasSubstr("two or more")));
}

}  // namespace
}  // namespace dendrofit
