// SPDX-License-Identifier: GPL-3.0-or-later
// NIST StRD nonlinear regression: certified values, from both certified starts and from automatic ones.
#include "fit/growth_allometry.h"
#include "fit/growth_fit.h"
#include "tests/support/growth_data.h"

#include <cmath>

#include <gtest/gtest.h>

namespace dendrofit {
namespace {

/// Digits in which two numbers agree (log relative error).
double digits(double value, double certified) {
  return -std::log10(std::abs(value / certified - 1) + 1e-16);
}

struct Certified {
  std::string name;
  double value, se;
};

void expect_certified(const GrowthFit& fit, const std::vector<Certified>& certified, double rss,
                      const std::string& start) {
  ASSERT_EQ(fit.status, GrowthStatus::ok) << start << ": " << fit.reason;
  for (const Certified& row : certified) {
    const GrowthParameter* parameter = fit.parameter(row.name);
    ASSERT_NE(parameter, nullptr) << row.name;
    EXPECT_GE(digits(parameter->value, row.value), 8) << row.name << " from " << start;
    EXPECT_GE(digits(parameter->se, row.se), 8) << row.name << " from " << start;
  }
  EXPECT_GE(digits(fit.rss, rss), 8) << start;
}

void check(const MeasurementSeries& series, const std::string& equation, GrowthOptions options,
           const std::vector<std::map<std::string, double>>& starts, const std::vector<Certified>& certified,
           double rss) {
  expect_certified(fit_growth_equation(series, equation, options), certified, rss, "automatic starts");
  for (std::size_t i = 0; i < starts.size(); ++i) {
    options.start = starts[i];
    options.automatic_starts = false;
    expect_certified(fit_growth_equation(series, equation, options), certified, rss,
                     "start " + std::to_string(i + 1));
  }
}

GrowthOptions for_equation(const std::string& name) {
  GrowthOptions options;
  options.equations = {name};
  return options;
}

TEST(GrowthNist, Rat42) {
  const auto start = [](double b1, double b2, double b3) {
    return std::map<std::string, double>{{"Xm", b1}, {"r", b3}, {"X0", b1 / (1 + std::exp(b2))}};
  };
  // X0 = b1 / (1 + e^b2) and its error by the delta method on the certified values.
  check(test::rat42(), "logistic", for_equation("logistic"), {start(100, 1, 0.1), start(75, 2.5, 0.07)},
        {{"Xm", 72.462237576, 1.7340283401},
         {"r", 0.067359200066, 0.0034465663377},
         {"X0", 4.92627624122, 0.470940299063}},
        8.0565229338);
}

TEST(GrowthNist, Rat43) {
  const auto start = [](double a, double b, double c, double d) {
    return std::map<std::string, double>{{"a", a}, {"b", b}, {"c", c}, {"d", d}};
  };
  check(test::rat43(), "richards", for_equation("richards"), {start(100, 10, 1, 1), start(700, 5, 0.75, 1.3)},
        {{"a", 699.64151270, 16.302297817},
         {"b", 5.2771253025, 2.0828735829},
         {"c", 0.75962938329, 0.19566123451},
         {"d", 1.2792483859, 0.68761936385}},
        8786.4049080);
}

TEST(GrowthNist, BoxBodAsAWeibullOfShapeOne) {
  GrowthOptions options = for_equation("weibull");
  options.fixed = {{"w3", 1}};
  check(test::box_bod(), "weibull", options, {{{"w1", 1}, {"w2", 1}}, {{"w1", 100}, {"w2", 0.75}}},
        {{"w1", 213.80940889, 12.354515176}, {"w2", 0.54723748542, 0.10455993237}}, 1168.0088766);
}

TEST(GrowthNist, Misra1aAsAWeibullOfShapeOne) {
  GrowthOptions options = for_equation("weibull");
  options.fixed = {{"w3", 1}};
  check(test::misra1a(), "weibull", options, {{{"w1", 500}, {"w2", 1e-4}}, {{"w1", 250}, {"w2", 5e-4}}},
        {{"w1", 238.94212918, 2.7070075241}, {"w2", 0.00055015643181, 7.2668688436e-06}}, 0.12455138894);
}

TEST(GrowthNist, DanWoodAsAPowerLaw) {
  const MeasurementSeries series = test::dan_wood();
  for (const std::vector<double>& start : {std::vector<double>{}, {1, 5}, {0.7, 4}}) {
    const PowerLawFit fit = fit_power_law(series.time, series.value, 0, start);
    ASSERT_EQ(fit.status, GrowthStatus::ok);
    EXPECT_GE(digits(fit.a.value, 0.76886226176), 8);
    EXPECT_GE(digits(fit.b.value, 3.8604055871), 8);
    EXPECT_GE(digits(fit.a.se, 0.018281973860), 8);
    EXPECT_GE(digits(fit.b.se, 0.051726610913), 8);
    EXPECT_GE(digits(fit.rss, 0.0043173084083), 8);
  }
}

}  // namespace
}  // namespace dendrofit
