// SPDX-License-Identifier: GPL-3.0-or-later
#include "fit/growth_allometry.h"

#include "core/errors.h"
#include "forward/growth_equations.h"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace dendrofit {
namespace {

TEST(GrowthAllometry, PowerLawOfExactDataIsExact) {
  const std::vector<double> d{8, 12, 20, 31, 45};
  std::vector<double> h;
  for (double x : d) h.push_back(1.3 + 2.1 * std::pow(x, 0.6));
  const PowerLawFit fit = fit_power_law(d, h, 1.3);
  ASSERT_EQ(fit.status, GrowthStatus::ok);
  EXPECT_NEAR(fit.a.value, 2.1, 1e-10);
  EXPECT_NEAR(fit.b.value, 0.6, 1e-11);
  EXPECT_NEAR(fit.value(20), h[2], 1e-10);
}

TEST(GrowthAllometry, RefusalsNameCauseAndRemedy) {
  EXPECT_EQ(fit_power_law({}, {}).status, GrowthStatus::too_few_points);
  EXPECT_THAT(fit_power_law({10, 20}, {8, 12}).reason, testing::HasSubstr("measure at least 3 trees"));
  EXPECT_THAT(fit_power_law({10, 10, 10}, {8, 12, 11}).reason, testing::HasSubstr("1 diameters"));
  EXPECT_THAT(fit_power_law({10, -2, 10}, {8, 12, 11}).reason, testing::HasSubstr("row 2"));
  EXPECT_THROW(fit_power_law({1, 2}, {1}), InputError);
}

TEST(GrowthAllometry, HeightCurveStartsAtBreastHeight) {
  std::vector<double> d, h;
  const auto& weibull = growth_equation("weibull");
  for (double x = 5; x <= 60; x += 5) {
    d.push_back(x);
    h.push_back(1.3 + weibull.value(std::vector{28.0, 0.03, 1.1}, x));
  }
  const GrowthFit fit = fit_height_diameter(d, h, "weibull");
  ASSERT_EQ(fit.status, GrowthStatus::ok) << fit.reason;
  EXPECT_NEAR(fit.parameter("w1")->value, 28, 1e-6);
  EXPECT_NEAR(fit.derived.asymptote, 29.3, 1e-6);
  EXPECT_THROW(fit_height_diameter(d, h, "logistic"), InputError);
}

}  // namespace
}  // namespace dendrofit
