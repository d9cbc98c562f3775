// SPDX-License-Identifier: GPL-3.0-or-later
#include "fit/growth_fit.h"

#include "core/errors.h"
#include "fit/growth_derived.h"
#include "tests/support/growth_data.h"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace dendrofit {
namespace {

const std::map<std::string, std::vector<double>> kTruth{
    {"logistic", {1, 30, 0.1}},  {"bertalanffy", {30, 0.04}},         {"weibull", {30, 0.002, 1.7}},
    {"gompertz", {30, 4, 0.05}}, {"chapman_richards", {30, 0.04, 2}}, {"korf", {45, 20, 0.9}},
    {"hossfeld4", {40, 6, 1.8}}, {"monomolecular", {30, 1.1, 0.03}},  {"richards", {30, 3, 0.08, 0.7}}};

TEST(GrowthFit, EveryEquationIsFoundAgainFromItsOwnCurve) {
  for (const auto& [name, truth] : kTruth) {
    const GrowthFit fit =
        fit_growth_equation(test::simulated("tree", name, truth, test::ages(4, 120, 4), 0, 1), name);
    ASSERT_EQ(fit.status, GrowthStatus::ok) << name << " " << fit.reason;
    for (std::size_t i = 0; i < truth.size(); ++i)
      EXPECT_NEAR(fit.parameters[i].value, truth[i], 1e-6 * truth[i])
          << name << " " << fit.parameters[i].name;
    EXPECT_LT(fit.rss, 1e-12) << name;
  }
}

TEST(GrowthFit, EveryEquationIsFoundWithScatterAndItsLimitsHoldTheTruth) {
  int held = 0, all = 0;
  for (const auto& [name, truth] : kTruth)
    for (std::uint64_t seed = 1; seed <= 10; ++seed) {
      const GrowthFit fit =
          fit_growth_equation(test::simulated("tree", name, truth, test::ages(4, 160, 4), 0.3, seed), name);
      ASSERT_EQ(fit.status, GrowthStatus::ok) << name << " " << fit.reason;
      for (std::size_t i = 0; i < truth.size(); ++i, ++all)
        held += fit.parameters[i].lo <= truth[i] && truth[i] <= fit.parameters[i].hi;
    }
  EXPECT_GE(held, 0.90 * all);
}

TEST(GrowthFit, ProfileIntervalsCoverAtTheirNominalRate) {
  const std::vector<double> truth{1, 30, 0.12};
  int held[3] = {0, 0, 0};
  for (std::uint64_t seed = 1; seed <= 2000; ++seed) {
    const GrowthFit fit = fit_growth_equation(
        test::simulated("tree", "logistic", truth, test::ages(5, 65, 5), 0.6, seed), "logistic");
    ASSERT_EQ(fit.status, GrowthStatus::ok) << fit.reason;
    for (int i = 0; i < 3; ++i)
      held[i] += fit.parameters[i].lo <= truth[i] && truth[i] <= fit.parameters[i].hi;
  }
  for (int i = 0; i < 3; ++i) {
    RecordProperty("covered_" + std::to_string(i), held[i]);
    EXPECT_GE(held[i], 1860) << i;
    EXPECT_LE(held[i], 1940) << i;
  }
}

TEST(GrowthFit, LimitsLieWhereTheLikelihoodSays) {
  const MeasurementSeries series = test::rat42();
  const GrowthFit fit = fit_growth_equation(series, "logistic");
  GrowthOptions held;
  held.profile_intervals = false;
  const double quantile = 2.4469118511449692;  // Student, 6 degrees of freedom
  for (const GrowthParameter& parameter : fit.parameters)
    for (double limit : {parameter.lo, parameter.hi}) {
      held.fixed = {{parameter.name, limit}};
      const GrowthFit inner = fit_growth_equation(series, "logistic", held);
      EXPECT_NEAR(inner.rss, fit.rss * (1 + quantile * quantile / 6), 1e-7 * fit.rss) << parameter.name;
    }
}

TEST(GrowthFit, FixedParametersStayAndHaveNoError) {
  GrowthOptions options;
  options.fixed = {{"weibull.w3", 1}};
  const GrowthFit fit = fit_growth_equation(test::box_bod(), "weibull", options);
  EXPECT_EQ(fit.parameter("w3")->value, 1);
  EXPECT_TRUE(fit.parameter("w3")->fixed);
  EXPECT_TRUE(std::isnan(fit.parameter("w3")->se));
  EXPECT_TRUE(std::isfinite(fit.parameter("w1")->hi));
}

TEST(GrowthFit, BoundsAreKeptAndSaid) {
  GrowthOptions options;
  options.bounds = {{"asymptote", {std::nullopt, 70.0}}};
  const GrowthFit fit = fit_growth_equation(test::rat42(), "weibull", options);
  ASSERT_EQ(fit.status, GrowthStatus::ok) << fit.reason;
  EXPECT_NEAR(fit.parameter("w1")->value, 70, 1e-9);
  EXPECT_TRUE(fit.parameter("w1")->at_bound);
  EXPECT_TRUE(fit.asymptote_bounded);
  EXPECT_THAT(fit.warnings, testing::Contains(testing::HasSubstr("stopped at the given bound 70")));
  EXPECT_LE(fit.parameter("w1")->hi, 70 * (1 + 1e-9));
}

TEST(GrowthFit, ABoundMakesAnEndlessAsymptoteFinite) {
  // Exponential growth: no final size in the data.
  MeasurementSeries series{"young", {}, {}};
  for (double t = 1; t <= 12; ++t) {
    series.time.push_back(t);
    series.value.push_back(0.2 * std::exp(0.25 * t));
  }
  EXPECT_EQ(fit_growth_equation(series, "logistic").status, GrowthStatus::no_finite_optimum);
  GrowthOptions options;
  options.bounds = {{"Xm", {std::nullopt, 40.0}}};
  const GrowthFit fit = fit_growth_equation(series, "logistic", options);
  ASSERT_EQ(fit.status, GrowthStatus::ok) << fit.reason;
  EXPECT_NEAR(fit.parameter("Xm")->value, 40, 1e-6);
}

TEST(GrowthFit, OffsetAndTimeShiftAreFound) {
  MeasurementSeries series{"tree", test::ages(5, 120, 5), {}};
  const auto& bertalanffy = growth_equation("bertalanffy");
  for (double t : series.time) series.value.push_back(1.3 + bertalanffy.value(std::vector{28.0, 0.04}, t));
  GrowthOptions options;
  options.fit_offset = true;
  const GrowthFit offset = fit_growth_equation(series, "bertalanffy", options);
  ASSERT_EQ(offset.status, GrowthStatus::ok) << offset.reason;
  EXPECT_NEAR(offset.parameter("offset")->value, 1.3, 1e-7);
  EXPECT_NEAR(offset.derived.asymptote, 29.3, 1e-6);

  series.value.clear();
  for (double t : series.time) series.value.push_back(bertalanffy.value(std::vector{28.0, 0.04}, t + 7));
  options.fit_offset = false;
  options.fit_time_shift = true;
  const GrowthFit shift = fit_growth_equation(series, "bertalanffy", options);
  ASSERT_EQ(shift.status, GrowthStatus::ok) << shift.reason;
  EXPECT_NEAR(shift.parameter("time_shift")->value, 7, 1e-6);
  EXPECT_EQ(fit_growth_equation(series, "logistic", options).parameter("time_shift"), nullptr);

  GrowthOptions known;
  known.offset = 1.3;
  series.value.clear();
  for (double t : series.time) series.value.push_back(1.3 + bertalanffy.value(std::vector{28.0, 0.04}, t));
  const GrowthFit base = fit_growth_equation(series, "bertalanffy", known);
  EXPECT_NEAR(base.parameter("b1")->value, 28, 1e-6);
  EXPECT_NEAR(base.bands.front().fit, 1.3, 1e-9);
}

TEST(GrowthFit, WeightsLessenAMeasurement) {
  MeasurementSeries series =
      test::simulated("tree", "bertalanffy", {30, 0.04}, test::ages(10, 120, 10), 0, 1);
  series.value[7] += 8;
  std::vector<double> weights(series.time.size(), 1);
  weights[7] = 1e-12;
  EXPECT_NEAR(fit_growth_equation(series, "bertalanffy", {}, weights).parameter("b1")->value, 30, 1e-6);
  EXPECT_GT(fit_growth_equation(series, "bertalanffy").parameter("b1")->value, 30.5);
  weights[7] = 0;
  EXPECT_THROW(fit_growth_equation(series, "bertalanffy", {}, weights), InputError);
}

TEST(GrowthFit, RobustLossesIgnoreAnOutlier) {
  MeasurementSeries series = test::simulated("tree", "logistic", {1, 30, 0.1}, test::ages(5, 90, 5), 0.1, 2);
  series.value[9] += 9;
  const double squares = std::abs(fit_growth_equation(series, "logistic").parameter("Xm")->value - 30);
  for (const char* loss : {"huber", "soft_l1", "cauchy", "arctan", "tukey"}) {
    GrowthOptions options;
    options.loss = growth_loss(loss);
    options.loss_scale = 0.3;
    const GrowthFit fit = fit_growth_equation(series, "logistic", options);
    ASSERT_EQ(fit.status, GrowthStatus::ok) << loss << fit.reason;
    EXPECT_NEAR(fit.parameter("Xm")->value, 30, 0.3) << loss;
    EXPECT_LT(std::abs(fit.parameter("Xm")->value - 30), squares) << loss;
    EXPECT_FALSE(fit.profiled);
    EXPECT_GT(fit.parameter("Xm")->se, 0);
  }
}

TEST(GrowthFit, ResidualsAndCriteriaAreThoseOfTheCurve) {
  const MeasurementSeries series = test::rat42();
  const GrowthFit fit = fit_growth_equation(series, "logistic");
  const FittedGrowth curve(fit);
  double rss = 0;
  for (std::size_t i = 0; i < series.time.size(); ++i) {
    EXPECT_NEAR(fit.residuals[i], series.value[i] - curve.value(series.time[i]), 1e-12);
    rss += fit.residuals[i] * fit.residuals[i];
  }
  EXPECT_NEAR(rss, fit.rss, 1e-12 * rss);
  const double n = 9, deviance = n * (std::log(2 * M_PI * rss / n) + 1);
  EXPECT_NEAR(fit.aic, deviance + 8, 1e-10);
  EXPECT_NEAR(fit.aicc, fit.aic + 2 * 4 * 5 / 4.0, 1e-10);
  EXPECT_NEAR(fit.bic, deviance + 4 * std::log(9), 1e-10);
}

TEST(GrowthFit, RefusesOptionsThatCannotBeRight) {
  const auto refuses = [](GrowthOptions options) {
    EXPECT_THROW(fit_growth_equation(test::rat42(), "logistic", options), InputError);
  };
  GrowthOptions options;
  options.fixed = {{"w9", 1}};
  refuses(options);
  options = {};
  options.fixed = {{"Xm", -1}};
  refuses(options);
  options = {};
  options.bounds = {{"r", {2.0, 1.0}}};
  refuses(options);
  options = {};
  options.confidence = 1;
  refuses(options);
  options = {};
  options.loss_scale = 0;
  refuses(options);
  EXPECT_THROW(growth_loss("hubr"), InputError);
}

TEST(GrowthFit, EmptyAndOnePointSeriesAreResults) {
  EXPECT_EQ(fit_growth_equation({"none", {}, {}}, "logistic").status, GrowthStatus::failed);
  EXPECT_EQ(fit_growth_equation({"one", {3}, {2}}, "logistic").status, GrowthStatus::too_few_points);
  EXPECT_EQ(fit_growth_equation({"flat", {1, 2, 3, 4, 5, 6}, {5, 5, 5, 5, 5, 5}}, "bertalanffy").status,
            GrowthStatus::ill_conditioned);
}

}  // namespace
}  // namespace dendrofit
