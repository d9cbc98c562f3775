// SPDX-License-Identifier: GPL-3.0-or-later
// Each way in which measurements cannot answer, and that the message names series, cause and remedy without
// solver jargon.
#include "fit/growth_fit.h"
#include "fit/growth_report.h"
#include "tests/support/growth_data.h"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace dendrofit {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::HasSubstr;

void expect_plain(const std::string& message) {
  for (const char* jargon :
       {"singular", "gradient", "acobian", "essian", "iteration", "converge", "nan", "tolerance"})
    EXPECT_THAT(message, testing::Not(HasSubstr(jargon)));
}

std::vector<std::string> messages(const MeasurementSeries& series, GrowthOptions options) {
  const GrowthReport report = fit_growth({series}, options);
  std::vector<std::string> all = report.series[0].warnings;
  for (const GrowthFit& fit : report.series[0].fits) {
    all.insert(all.end(), fit.warnings.begin(), fit.warnings.end());
    if (!fit.reason.empty()) all.push_back(fit.reason);
  }
  for (const std::string& message : all) {
    expect_plain(message);
    EXPECT_THAT(message, HasSubstr("series '" + series.name + "'"));
  }
  return all;
}

GrowthOptions only(const std::string& equation) {
  GrowthOptions options;
  options.equations = {equation};
  return options;
}

MeasurementSeries young_stand() {
  return test::simulated("plot 7", "bertalanffy", {30, 0.03}, test::ages(5, 23, 2), 0.15, 4);
}

TEST(GrowthTraps, NoAsymptoteInYoungStands) {
  const MeasurementSeries series = young_stand();
  const GrowthFit fit = fit_growth_equation(series, "weibull");
  ASSERT_FALSE(fit.status == GrowthStatus::ok && fit.asymptote_bounded);
  if (fit.status == GrowthStatus::ok) {
    EXPECT_TRUE(std::isinf(fit.parameter("w1")->hi));
  }
  EXPECT_THAT(
      messages(series, only("weibull")),
      Contains(AllOf(HasSubstr("upper bound"), HasSubstr("add older trees"), HasSubstr("use Bertalanffy"))));
}

TEST(GrowthTraps, AsymptoteBoundedOnlyFromBelowNamesTheLowerLimit) {
  const MeasurementSeries series = test::rat42();  // its Weibull has a finite optimum and no upper limit
  const GrowthFit fit = fit_growth_equation(series, "weibull");
  ASSERT_EQ(fit.status, GrowthStatus::ok);
  EXPECT_TRUE(std::isinf(fit.parameter("w1")->hi));
  EXPECT_THAT(messages(series, only("weibull")),
              Contains(AllOf(HasSubstr("ages reach 79 years"), HasSubstr("only from below (>= 67.16 m)"))));
}

TEST(GrowthTraps, EndlessGrowthHasNoErrorsToPrint) {
  MeasurementSeries series{"exp", {}, {}};
  for (double t = 1; t <= 12; ++t) {
    series.time.push_back(t);
    series.value.push_back(0.2 * std::exp(0.25 * t));
  }
  const GrowthFit fit = fit_growth_equation(series, "logistic");
  ASSERT_EQ(fit.status, GrowthStatus::no_finite_optimum);
  for (const GrowthParameter& parameter : fit.parameters) EXPECT_TRUE(std::isnan(parameter.se));
  EXPECT_THAT(messages(series, only("logistic")),
              Contains(AllOf(HasSubstr("no levelling off"), HasSubstr("add older trees"))));
}

TEST(GrowthTraps, SizeAtAgeZeroIsAnExtrapolation) {
  const MeasurementSeries series =
      test::simulated("old", "logistic", {0.02, 30, 0.12}, test::ages(50, 110, 6), 0.8, 2);
  EXPECT_THAT(messages(series, only("logistic")),
              Contains(AllOf(HasSubstr("X0 is an extrapolation to age 0"), HasSubstr("inflection age"))));
}

TEST(GrowthTraps, TotalHeightAgainstBreastHeightAge) {
  MeasurementSeries series =
      test::simulated("fir", "bertalanffy", {35, 0.03}, test::ages(0, 100, 10), 0.1, 3);
  for (double& x : series.value) x += 1.37;
  EXPECT_THAT(messages(series, only("bertalanffy")),
              Contains(AllOf(HasSubstr("breast-height age"), HasSubstr("H-1.3"), HasSubstr("--fit-offset"))));
  GrowthOptions feet = only("bertalanffy");
  feet.value_unit = "ft";
  for (double& x : series.value) x /= 0.3048;
  EXPECT_THAT(messages(series, feet), Contains(HasSubstr("breast-height age")));
  feet.fit_offset = true;
  EXPECT_THAT(messages(series, feet), testing::Not(Contains(HasSubstr("breast-height age"))));
}

TEST(GrowthTraps, UnmeasuredTrunkBase) {
  GrowthOptions options = only("bertalanffy");
  options.trunk_base_unmeasured = true;
  const MeasurementSeries series =
      test::simulated("pine", "bertalanffy", {35, 0.03}, test::ages(5, 100, 5), 0.1, 3);
  EXPECT_THAT(messages(series, options), Contains(AllOf(HasSubstr("trunk base"), HasSubstr("time shift"))));
  options.fit_time_shift = true;
  EXPECT_THAT(messages(series, options), testing::Not(Contains(HasSubstr("trunk base"))));
}

TEST(GrowthTraps, WeibullRateIsGivenAsAnAgeToo) {
  const GrowthFit fit = fit_growth_equation(test::rat42(), "weibull");
  EXPECT_NEAR(fit.derived.scale_age, std::pow(fit.parameter("w2")->value, -1 / fit.parameter("w3")->value),
              1e-9);
  EXPECT_EQ(fit.parameter("w2")->unit, "1/years^w3");
}

TEST(GrowthTraps, TooFewAgesSaysHowManyAreMissing) {
  EXPECT_THAT(messages({"p1", {10, 20}, {3, 8}}, only("logistic")),
              Contains(AllOf(HasSubstr("2 measurements at 2 ages"), HasSubstr("add at least 2 more ages"))));
  EXPECT_THAT(messages({"p2", {10, 10, 20, 20, 20}, {3, 4, 8, 9, 8}}, only("logistic")),
              Contains(AllOf(HasSubstr("at 2 ages"), HasSubstr("add at least 1 more age"))));
}

TEST(GrowthTraps, StepBetweenTwoAges) {
  MeasurementSeries series{"step", {}, {}};
  Random random(3);
  for (double t : {5., 10., 15., 20., 60., 65., 70., 75.})
    for (int k = 0; k < 2; ++k) {
      series.time.push_back(t);
      series.value.push_back((t > 40 ? 20 : 1e-9) + (t > 40 ? 0.3 * random.normal() : 0));
    }
  const GrowthFit fit = fit_growth_equation(series, "logistic");
  EXPECT_EQ(fit.status, GrowthStatus::ill_conditioned);
  for (const GrowthParameter& parameter : fit.parameters) EXPECT_TRUE(std::isnan(parameter.se));
  EXPECT_THAT(messages(series, only("logistic")),
              Contains(AllOf(HasSubstr("step between two ages"), HasSubstr("add ages"))));
}

TEST(GrowthTraps, CumulatedIncrementsHaveCorrelatedErrors) {
  MeasurementSeries series = test::simulated("core", "bertalanffy", {30, 0.04}, test::ages(4, 120, 4), 0, 1);
  Random random(9);
  double walk = 0;
  for (double& x : series.value) x += walk += 0.15 * random.normal();
  EXPECT_THAT(messages(series, only("bertalanffy")),
              Contains(AllOf(HasSubstr("errors are too small"), HasSubstr("mixed model"))));
  const MeasurementSeries white =
      test::simulated("free", "bertalanffy", {30, 0.04}, test::ages(4, 120, 4), 0.3, 1);
  EXPECT_THAT(messages(white, only("bertalanffy")),
              testing::Not(Contains(HasSubstr("errors are too small"))));
}

TEST(GrowthTraps, CalendarYearsAreNotAges) {
  MeasurementSeries series = test::simulated("oak", "bertalanffy", {30, 0.04}, test::ages(5, 100, 5), 0.1, 1);
  for (double& t : series.time) t += 1900;
  EXPECT_THAT(messages(series, only("bertalanffy")),
              Contains(AllOf(HasSubstr("calendar years"), HasSubstr("--origin"))));
  GrowthOptions options = only("bertalanffy");
  options.origin_time = 1900;
  const GrowthFit fit = fit_growth_equation(series, "bertalanffy", options);
  ASSERT_EQ(fit.status, GrowthStatus::ok);
  EXPECT_NEAR(fit.parameter("b2")->value, 0.04, 0.001);
}

TEST(GrowthTraps, FallingSizesAreListed) {
  MeasurementSeries series =
      test::simulated("ash", "bertalanffy", {30, 0.04}, test::ages(10, 120, 10), 0.05, 1);
  series.value[8] -= 8;
  EXPECT_THAT(messages(series, only("bertalanffy")),
              Contains(AllOf(HasSubstr("the size falls"), HasSubstr("row 9 (age 90"),
                             HasSubstr("check these rows"))));
}

TEST(GrowthTraps, MixedUnitsAreListed) {
  MeasurementSeries series =
      test::simulated("elm", "bertalanffy", {30, 0.04}, test::ages(10, 120, 10), 0.05, 1);
  series.value[5] /= 0.3048;
  EXPECT_THAT(
      messages(series, only("bertalanffy")),
      Contains(AllOf(HasSubstr("units look mixed"), HasSubstr("row 6 (age 60"), HasSubstr("one unit"))));
}

TEST(GrowthTraps, RivalMinimaAreBothReported) {
  const MeasurementSeries series{"two", {1, 2, 3, 4, 5, 6, 7}, {1.3, 2.7, 1.1, 6.4, 7.1, 8.3, 5.6}};
  const GrowthFit fit = fit_growth_equation(series, "logistic");
  ASSERT_TRUE(fit.second_best.has_value());
  EXPECT_GT(fit.second_best->rss, fit.rss);
  // The second one is a minimum of its own: from there the fit stays.
  GrowthOptions there = only("logistic");
  there.automatic_starts = false;
  there.profile_intervals = false;
  for (int i = 0; i < 3; ++i) there.start[fit.parameters[i].name] = fit.second_best->parameters[i];
  EXPECT_NEAR(fit_growth_equation(series, "logistic", there).rss, fit.second_best->rss, 1e-9 * fit.rss);
  EXPECT_THAT(messages(series, only("logistic")),
              Contains(AllOf(HasSubstr("two different curves"), HasSubstr("both are reported"))));
}

TEST(GrowthTraps, NoGrowthAtAllIsCalledThat) {
  EXPECT_THAT(
      messages({"flat", {5, 10, 15, 20, 25}, {3, 3, 3, 3, 3}}, only("logistic")),
      Contains(AllOf(HasSubstr("every size is 3"), HasSubstr("no growth to fit"), HasSubstr("check"))));
  EXPECT_THAT(messages({"dying", {5, 10, 15, 20, 25, 30}, {20, 15, 9, 6, 3, 1}}, only("logistic")),
              Contains(AllOf(HasSubstr("the sizes fall with age"), HasSubstr("check the columns"))));
}

TEST(GrowthTraps, TimeShiftThatTheRateCanReplace) {
  MeasurementSeries series =
      test::simulated("late", "bertalanffy", {35, 0.03}, test::ages(60, 100, 4), 0.05, 3);
  GrowthOptions options = only("bertalanffy");
  options.fit_time_shift = true;
  EXPECT_THAT(
      messages(series, options),
      Contains(AllOf(HasSubstr("time shift can hardly be told from the rate"), HasSubstr("young ages"))));
}

TEST(GrowthTraps, RepeatedTreesInOnePoolAreNotIndependent) {
  const GrowthReport report =
      fit_growth({test::simulated("a", "bertalanffy", {30, 0.04}, test::ages(10, 90, 10), 0.2, 1),
                  test::simulated("b", "bertalanffy", {20, 0.04}, test::ages(10, 90, 10), 0.2, 2)},
                 only("bertalanffy"));
  EXPECT_THAT(report.pooled->warnings,
              Contains(AllOf(HasSubstr("errors are too small"), HasSubstr("--mixed"))));
}

TEST(GrowthTraps, NoSizeAboveZero) {
  EXPECT_THAT(messages({"dead", {1, 2, 3, 4, 5}, {0, 0, 0, 0, 0}}, only("logistic")),
              Contains(AllOf(HasSubstr("no size is above 0"), HasSubstr("check the value column"))));
}

}  // namespace
}  // namespace dendrofit
