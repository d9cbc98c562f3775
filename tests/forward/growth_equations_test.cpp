// SPDX-License-Identifier: GPL-3.0-or-later
#include "forward/growth_equations.h"

#include "core/errors.h"

#include <cmath>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace dendrofit {
namespace {

class EveryGrowthEquation : public testing::TestWithParam<std::string> {
 protected:
  const GrowthEquation& equation = growth_equation(GetParam());
  std::vector<double> defaults() const {
    std::vector<double> p;
    for (const ParameterSpec& spec : equation.parameters) p.push_back(spec.default_value);
    return p;
  }
  /// The defaults, and each parameter 30 % up and down: shapes on both sides.
  std::vector<std::vector<double>> shapes() const {
    std::vector<std::vector<double>> all{defaults()};
    for (std::size_t i = 0; i < equation.parameters.size(); ++i)
      for (double factor : {0.7, 1.3}) {
        all.push_back(defaults());
        all.back()[i] *= factor;
      }
    return all;
  }
  /// Fourth-order central difference.
  template <class F>
  static double slope(const F& f, double x, double h) {
    return (8 * (f(x + h) - f(x - h)) - (f(x + 2 * h) - f(x - 2 * h))) / (12 * h);
  }
};

TEST_P(EveryGrowthEquation, RateIsTheDerivativeOfValue) {
  for (const auto& p : shapes())
    for (double t : {0.5, 3.0, 9.0, 25.0}) {
      const double expected = slope([&](double s) { return equation.value(p, s); }, t, 1e-3 * t);
      EXPECT_NEAR(equation.rate(p, t), expected, 1e-8 * std::abs(expected) + 1e-11) << t;
    }
}

TEST_P(EveryGrowthEquation, GradientIsTheDerivativeByEachParameter) {
  for (const auto& p : shapes())
    for (double t : {0.5, 3.0, 9.0, 25.0}) {
      std::vector<double> g(p.size());
      equation.gradient(p, t, g);
      for (std::size_t i = 0; i < p.size(); ++i) {
        const auto f = [&](double x) {
          auto q = p;
          q[i] = x;
          return equation.value(q, t);
        };
        const double expected = slope(f, p[i], 1e-3 * p[i]);
        const double rounding = 1e-12 * equation.asymptote(p) / p[i];
        EXPECT_NEAR(g[i], expected, 1e-8 * std::abs(expected) + rounding)
            << equation.parameters[i].key << " " << t;
      }
    }
}

TEST_P(EveryGrowthEquation, AgeAtInvertsValue) {
  for (const auto& p : shapes())
    for (double t : {1.0, 5.0, 20.0}) EXPECT_NEAR(equation.age_at(p, equation.value(p, t)), t, 1e-9 * t);
  EXPECT_TRUE(std::isnan(equation.age_at(defaults(), 1.01 * equation.asymptote(defaults()))));
}

TEST_P(EveryGrowthEquation, RateIsLargestAtTheInflection) {
  for (const auto& p : shapes()) {
    const double t = equation.inflection_age(p);
    if (std::isnan(t)) continue;
    EXPECT_GT(equation.rate(p, t), equation.rate(p, 0.9 * t));
    EXPECT_GT(equation.rate(p, t), equation.rate(p, 1.1 * t));
    EXPECT_NEAR(slope([&](double s) { return equation.rate(p, s); }, t, 1e-3 * t), 0,
                1e-8 * equation.rate(p, t));
  }
}

TEST_P(EveryGrowthEquation, NearsItsAsymptoteAndStaysFiniteAtExtremeAges) {
  const auto p = defaults();
  EXPECT_NEAR(equation.value(p, 1e6), equation.asymptote(p), 1e-3 * equation.asymptote(p));
  for (double t : {-1e4, -1.0, 0.0, 1e-300, 1e4, 1e9}) {
    std::vector<double> g(p.size());
    equation.gradient(p, t, g);
    if (t >= 0 || equation.name != "monomolecular") {
      EXPECT_TRUE(std::isfinite(equation.value(p, t))) << t;
      EXPECT_TRUE(std::isfinite(equation.rate(p, t))) << t;
      for (double x : g) EXPECT_TRUE(std::isfinite(x)) << t;
    }
    if (equation.starts_at_zero && t <= 0) {
      EXPECT_EQ(equation.value(p, t), 0);
    }
  }
}

TEST_P(EveryGrowthEquation, TableRowIsComplete) {
  for (const ParameterSpec& spec : equation.parameters) {
    EXPECT_LT(spec.lo, spec.default_value);
    EXPECT_LT(spec.default_value, spec.hi);
    EXPECT_FALSE(spec.meaning.empty());
    EXPECT_NE(equation.formula.find(spec.symbol), std::string_view::npos) << spec.symbol;
  }
}

INSTANTIATE_TEST_SUITE_P(All, EveryGrowthEquation,
                         testing::Values("logistic", "bertalanffy", "weibull", "gompertz", "chapman_richards",
                                         "korf", "hossfeld4", "monomolecular", "richards"),
                         [](const auto& param_info) { return param_info.param; });

TEST(GrowthEquations, LogisticHasThePapersValues) {
  // Yi 2018 with X0 = 2, Xm = 100, r = 0.34: largest rate Xm r / 4 at age 11.45, X(20) = 94.8.
  const auto& logistic = growth_equation("logistic");
  const std::vector<double> p{2, 100, 0.34};
  EXPECT_DOUBLE_EQ(logistic.value(p, 0), 2);
  EXPECT_NEAR(logistic.inflection_age(p), 11.45, 0.005);
  EXPECT_NEAR(logistic.rate(p, logistic.inflection_age(p)), 8.5, 1e-12);
  EXPECT_NEAR(logistic.value(p, 20), 94.8, 0.05);
}

TEST(GrowthEquations, InflectionSizesAreThoseOfTheLiterature) {
  const auto size_share = [](const char* name, std::vector<double> p) {
    const auto& equation = growth_equation(name);
    return equation.value(p, equation.inflection_age(p)) / equation.asymptote(p);
  };
  EXPECT_NEAR(size_share("logistic", {2, 100, 0.3}), 0.5, 1e-12);
  EXPECT_NEAR(size_share("bertalanffy", {50, 0.1}), 8.0 / 27, 1e-12);
  EXPECT_NEAR(size_share("weibull", {50, 0.01, 2}), 1 - std::exp(1.0 / 2 - 1), 1e-12);
  EXPECT_NEAR(size_share("gompertz", {50, 4, 0.1}), std::exp(-1.0), 1e-12);
  EXPECT_NEAR(size_share("chapman_richards", {50, 0.1, 4}), std::pow(1 - 1.0 / 4, 4), 1e-12);
  EXPECT_NEAR(size_share("korf", {50, 10, 0.8}), std::exp(-1 - 1 / 0.8), 1e-12);
  EXPECT_NEAR(size_share("hossfeld4", {50, 3, 2.5}), 1.5 / 5, 1e-12);
}

TEST(GrowthEquations, ShapesWithoutInflectionSaySo) {
  EXPECT_TRUE(std::isnan(growth_equation("weibull").inflection_age(std::vector<double>{50, 0.1, 0.9})));
  EXPECT_TRUE(
      std::isnan(growth_equation("chapman_richards").inflection_age(std::vector<double>{50, 0.1, 1})));
  EXPECT_TRUE(std::isnan(growth_equation("monomolecular").inflection_age(std::vector<double>{50, 0.1, 1})));
}

TEST(GrowthEquations, UnknownNameSuggestsTheNearest) {
  try {
    growth_equation("weibul");
    FAIL();
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("did you mean 'weibull'"));
  }
}

}  // namespace
}  // namespace dendrofit
