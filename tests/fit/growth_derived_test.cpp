// SPDX-License-Identifier: GPL-3.0-or-later
#include "fit/growth_derived.h"

#include "core/errors.h"
#include "fit/growth_fit.h"
#include "tests/support/growth_data.h"

#include <cmath>

#include <gtest/gtest.h>

namespace dendrofit {
namespace {

GrowthFit exact(const std::string& equation, const std::vector<double>& parameters,
                GrowthOptions options = {}) {
  return fit_growth_equation(test::simulated("tree", equation, parameters, test::ages(5, 120, 5), 0, 1),
                             equation, options);
}

TEST(GrowthDerived, CulminationsAreThoseOfTheClosedForms) {
  // Bertalanffy: the mean increment culminates at 1.9038.../b2, where 3 x = e^x - 1.
  const GrowthFit bertalanffy = exact("bertalanffy", {33, 0.036});
  const double x = bertalanffy.derived.mai_culmination_age * bertalanffy.parameter("b2")->value;
  EXPECT_NEAR(x, 1.9038, 1e-4);
  EXPECT_NEAR(std::expm1(x), 3 * x, 1e-10);
  EXPECT_NEAR(bertalanffy.derived.inflection_age, std::log(3.0) / 0.036, 1e-7);
  // Weibull: e^z = 1 + w3 z with z = w2 t^w3.
  const GrowthFit weibull = exact("weibull", {32, 0.001, 1.8});
  const double z = weibull.parameter("w2")->value *
                   std::pow(weibull.derived.mai_culmination_age, weibull.parameter("w3")->value);
  EXPECT_NEAR(std::exp(z), 1 + weibull.parameter("w3")->value * z, 1e-10);
  EXPECT_NEAR(weibull.derived.scale_age, std::pow(0.001, -1 / 1.8), 1e-6);
  // At the culmination the current and the mean increment are equal.
  const GrowthFit logistic = exact("logistic", {1, 30, 0.1});
  const FittedGrowth curve(logistic);
  const double age = logistic.derived.mai_culmination_age;
  EXPECT_GT(age, logistic.derived.inflection_age);
  EXPECT_NEAR(curve.increment(age), curve.mean_increment(age), 1e-10);
}

TEST(GrowthDerived, CurvesWithoutInflectionHaveNoCulmination) {
  const GrowthFit fit = exact("weibull", {32, 0.03, 0.9});
  EXPECT_TRUE(std::isnan(fit.derived.inflection_age));
  EXPECT_TRUE(std::isnan(fit.derived.mai_culmination_age));
}

TEST(GrowthDerived, SiteIndexAndItsInverse) {
  GrowthOptions options;
  options.base_age = 50;
  const GrowthFit fit = exact("chapman_richards", {35, 0.03, 1.6}, options);
  const FittedGrowth curve(fit, options);
  EXPECT_NEAR(fit.derived.site_index, 35 * std::pow(1 - std::exp(-1.5), 1.6), 1e-6);
  const double index = curve.site_index_of(30, 14, 50);
  EXPECT_NEAR(curve.size_of_site(index, 50, 30), 14, 1e-12);
  EXPECT_NEAR(curve.site_index_of(30, curve.value(30), 50), curve.value(50), 1e-12);
  EXPECT_THROW(curve.site_index_of(0, 14, 50), InputError);
}

TEST(GrowthDerived, AgeForHeightHasItsBand) {
  GrowthOptions options;
  const GrowthFit fit = fit_growth_equation(
      test::simulated("tree", "bertalanffy", {33, 0.036}, test::ages(10, 120, 10), 0.3, 3), "bertalanffy",
      options);
  const FittedGrowth curve(fit, options);
  const Interval age = curve.age_interval(20);
  EXPECT_NEAR(curve.value(age.value), 20, 1e-9);
  EXPECT_LT(age.lo, age.value);
  EXPECT_GT(age.hi, age.value);
  EXPECT_NEAR(curve.band(age.lo).confidence_hi, 20, 1e-6);
  EXPECT_NEAR(curve.band(age.hi).confidence_lo, 20, 1e-6);
  EXPECT_TRUE(std::isnan(curve.age_at(40)));
  EXPECT_NEAR(fit.derived.years_to_breast_height, curve.age_at(1.3), 1e-12);
}

TEST(GrowthDerived, ErrorsOfDerivedAgesMatchASimulation) {
  std::vector<double> found;
  double claimed = 0;
  for (std::uint64_t seed = 1; seed <= 300; ++seed) {
    GrowthOptions options;
    options.profile_intervals = false;
    const GrowthFit fit = fit_growth_equation(
        test::simulated("tree", "logistic", {1, 30, 0.1}, test::ages(5, 80, 5), 0.4, seed), "logistic",
        options);
    found.push_back(fit.derived.inflection_age);
    claimed += fit.derived.inflection_age_se / 300;
  }
  double mean = 0, square = 0;
  for (double age : found) mean += age / 300;
  for (double age : found) square += (age - mean) * (age - mean) / 299;
  EXPECT_NEAR(std::sqrt(square), claimed, 0.15 * claimed);
}

TEST(GrowthDerived, AFitWithoutParametersHasNoCurve) {
  EXPECT_THROW(FittedGrowth(fit_growth_equation({"a", {1}, {1}}, "logistic")), InputError);
}

}  // namespace
}  // namespace dendrofit
