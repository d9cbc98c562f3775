// SPDX-License-Identifier: GPL-3.0-or-later
#include "fit/growth_report.h"

#include "core/errors.h"
#include "tests/support/growth_data.h"

#include <atomic>
#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace dendrofit {
namespace {

std::vector<MeasurementSeries> some_series() {
  std::vector<MeasurementSeries> all;
  for (int i = 0; i < 6; ++i)
    all.push_back(test::simulated("tree" + std::to_string(i), "logistic", {1.0, 25.0 + i, 0.1},
                                  test::ages(5, 80, 5), 0.3, 10 + i));
  return all;
}

TEST(GrowthReport, OneBadSeriesNeverStopsTheRest) {
  auto all = some_series();
  all.insert(all.begin() + 2, MeasurementSeries{"stump", {10}, {1}});
  all.push_back({"broken", {1, 2, 3, 4}, {1, std::nan(""), 3, 4}});
  const GrowthReport report = fit_growth(all);
  ASSERT_EQ(report.series.size(), 8u);
  for (std::size_t i = 0; i < report.series.size(); ++i) {
    const bool bad = report.series[i].name == "stump" || report.series[i].name == "broken";
    EXPECT_EQ(report.series[i].best.empty(), bad) << report.series[i].name;
  }
  EXPECT_THAT(report.warnings, testing::Contains(testing::AllOf(testing::HasSubstr("series 'stump'"),
                                                                testing::HasSubstr("add at least"))));
  EXPECT_THAT(report.warnings, testing::Contains(testing::AllOf(testing::HasSubstr("series 'broken'"),
                                                                testing::HasSubstr("row 2"))));
  EXPECT_TRUE(report.any_ok());
  ASSERT_TRUE(report.pooled.has_value());
  EXPECT_EQ(report.pooled->time.size(), 6 * 16u + 1);
}

TEST(GrowthReport, BestIsTheEquationThatMadeTheData) {
  GrowthOptions options;
  options.equations = {"bertalanffy", "logistic", "weibull"};
  for (const GrowthSeries& one : fit_growth(some_series(), options).series)
    EXPECT_EQ(one.best, "logistic") << one.name;
}

TEST(GrowthReport, ThreadsChangeNothing) {
  GrowthOptions options;
  options.threads = 1;
  const GrowthReport one = fit_growth(some_series(), options);
  options.threads = 4;
  const GrowthReport four = fit_growth(some_series(), options);
  for (std::size_t i = 0; i < one.series.size(); ++i)
    for (std::size_t k = 0; k < one.series[i].fits.size(); ++k)
      for (std::size_t j = 0; j < one.series[i].fits[k].parameters.size(); ++j) {
        EXPECT_EQ(one.series[i].fits[k].parameters[j].value, four.series[i].fits[k].parameters[j].value);
        EXPECT_EQ(one.series[i].fits[k].parameters[j].hi, four.series[i].fits[k].parameters[j].hi);
      }
}

TEST(GrowthReport, NoSeriesIsAnErrorAndOneNeedsNoPool) {
  EXPECT_THROW(fit_growth({}), InputError);
  EXPECT_FALSE(fit_growth({test::rat42()}).pooled.has_value());
}

TEST(GrowthReport, StopsWhenAsked) {
  const std::atomic<bool> stop{true};
  Progress progress(&stop);
  EXPECT_THROW(fit_growth(some_series(), {}, progress), Cancelled);
}

}  // namespace
}  // namespace dendrofit
