// SPDX-License-Identifier: GPL-3.0-or-later
#include "forward/leaves/distribution.h"

#include "core/errors.h"
#include "core/random.h"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

namespace dendrofit {
namespace {

constexpr double kPi = std::numbers::pi;

TEST(TabulatedLaw, HasTheKnownMeansOfInclinationLaws) {
  const auto mean = [](const char* word) { return TabulatedLaw(inclination_law(word)).mean(); };
  EXPECT_NEAR(mean("spherical"), 1, 1e-6);
  EXPECT_NEAR(mean("uniform"), kPi / 4, 1e-6);
  EXPECT_NEAR(mean("planophile"), kPi / 4 - 1 / kPi, 1e-6);
  EXPECT_NEAR(mean("erectophile"), kPi / 4 + 1 / kPi, 1e-6);
  EXPECT_NEAR(mean("plagiophile"), kPi / 4, 1e-6);
  EXPECT_NEAR(mean("extremophile"), kPi / 4, 1e-6);
}

TEST(TabulatedLaw, TheEllipsoidOfRatioOneIsTheSphere) {
  InclinationLaw law;
  law.kind = InclinationLaw::Kind::ellipsoidal;
  law.a = 1;
  const TabulatedLaw ellipsoid(law), sphere(inclination_law("spherical"));
  for (double theta = 0; theta < 1.6; theta += 0.1)
    EXPECT_NEAR(ellipsoid.cdf(theta), sphere.cdf(theta), 1e-9);
  law.a = 3;
  EXPECT_LT(TabulatedLaw(law).mean(), 0.7);  // flatter
}

TEST(TabulatedLaw, MatchesClosedForms) {
  const TabulatedLaw beta(UnitDistribution::beta(2, 1)), weibull(UnitDistribution::weibull(0.4, 1.7));
  const double cut = 1 - std::exp(-std::pow(1 / 0.4, 1.7));
  for (double x = 0.05; x < 1; x += 0.1) {
    EXPECT_NEAR(beta.cdf(x), x * x, 1e-6);
    EXPECT_NEAR(weibull.cdf(x), (1 - std::exp(-std::pow(x / 0.4, 1.7))) / cut, 1e-5);
  }
}

TEST(TabulatedLaw, QuantileUndoesCdf) {
  const TabulatedLaw mixed(UnitDistribution::mixture(
      {UnitDistribution::beta(8, 3), UnitDistribution::von_mises(0.2, 9)}, {0.3, 0.7}));
  for (double u = 0.01; u < 1; u += 0.07) EXPECT_NEAR(mixed.cdf(mixed.quantile(u)), u, 1e-9);
  const TabulatedLaw gap(UnitDistribution::histogram({1, 0, 0, 1}));
  EXPECT_LE(gap.quantile(0.4999), 0.2501);
  EXPECT_GE(gap.quantile(0.5001), 0.7499);
  EXPECT_DOUBLE_EQ(gap.quantile(0), 0);
  EXPECT_DOUBLE_EQ(gap.quantile(1), 1);
}

TEST(KolmogorovSmirnov, AcceptsItsOwnLawAndRefusesAnother) {
  const TabulatedLaw law(UnitDistribution::beta(2, 3)), other(UnitDistribution::beta(3, 2));
  Random draw(11);
  int refused = 0;
  for (int round = 0; round < 200; ++round) {
    std::vector<double> x;
    for (int i = 0; i < 200; ++i) x.push_back(law.quantile(draw.uniform()));
    refused += kolmogorov_smirnov(x, {}, [&](double v) { return law.cdf(v); }).p_value < 0.05 ? 1 : 0;
    EXPECT_LT(kolmogorov_smirnov(x, {}, [&](double v) { return other.cdf(v); }).p_value, 1e-6);
  }
  EXPECT_GT(refused, 1);  // 5 % of them, about
  EXPECT_LT(refused, 25);
}

TEST(KolmogorovSmirnov, KnowsAHandMadeDistance) {
  const auto cdf = [](double x) { return std::clamp(x, 0.0, 1.0); };
  EXPECT_NEAR(kolmogorov_smirnov({0.5}, {}, cdf).distance, 0.5, 1e-12);
  EXPECT_NEAR(kolmogorov_smirnov({0.1, 0.2, 0.9}, {1, 1, 2}, cdf).distance, 0.4, 1e-12);
  EXPECT_NEAR(kolmogorov_smirnov_binned({1, 1, 2}, {2, 1, 1}, 100).distance, 0.25, 1e-12);
  EXPECT_EQ(kolmogorov_smirnov({}, {}, cdf).samples, 0U);
}

TEST(Distributions, RefuseWhatCannotBe) {
  EXPECT_THROW(UnitDistribution::beta(0, 1).validate("x"), InputError);
  EXPECT_THROW(UnitDistribution::histogram({}).validate("x"), InputError);
  EXPECT_THROW(UnitDistribution::histogram({0, 0}).validate("x"), InputError);
  EXPECT_THROW(UnitDistribution::histogram({1, -1}).validate("x"), InputError);
  EXPECT_THROW(UnitDistribution::mixture({UnitDistribution::uniform()}, {1, 2}).validate("x"), InputError);
  EXPECT_THROW(inclination_law("planophil"), InputError);
  EXPECT_NO_THROW(UnitDistribution::von_mises(7, 0).validate("x"));
}

}  // namespace
}  // namespace dendrofit
