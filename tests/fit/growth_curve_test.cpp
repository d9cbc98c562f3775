// SPDX-License-Identifier: GPL-3.0-or-later
#include "fit/growth_curve.h"

#include <gtest/gtest.h>

namespace dendrofit {
namespace {

GrowthVector defaults(const GrowthCurve& curve) {
  GrowthVector natural(curve.size());
  for (int i = 0; i < curve.own_size(); ++i) natural[i] = curve.equation().parameters[i].default_value;
  if (curve.has_offset()) natural[curve.own_size()] = 1.3;
  if (curve.has_time_shift()) natural[curve.size() - 1] = 2;
  return natural;
}

TEST(GrowthCurve, ChartsAndNaturalParametersInvertEachOther) {
  for (const GrowthEquation& equation : growth_equations())
    for (GrowthChart chart : {GrowthChart::shape, GrowthChart::natural}) {
      const GrowthCurve curve(equation, true, equation.starts_at_zero);
      const GrowthVector natural = defaults(curve);
      const GrowthVector back = curve.to_natural(chart, curve.to_chart(chart, natural));
      EXPECT_LT(((back - natural).array() / natural.array()).abs().maxCoeff(), 1e-12) << equation.name;
    }
}

TEST(GrowthCurve, ChartJacobianIsTheDerivative) {
  for (const GrowthEquation& equation : growth_equations())
    for (GrowthChart chart : {GrowthChart::shape, GrowthChart::natural}) {
      const GrowthCurve curve(equation, true, false);
      const GrowthVector c = curve.to_chart(chart, defaults(curve));
      GrowthMatrix jacobian;
      curve.to_natural(chart, c, &jacobian);
      for (int k = 0; k < curve.size(); ++k) {
        const double h = 1e-6 * std::max(1.0, std::abs(c[k]));
        GrowthVector up = c, down = c;
        up[k] += h;
        down[k] -= h;
        const GrowthVector slope = (curve.to_natural(chart, up) - curve.to_natural(chart, down)) / (2 * h);
        for (int i = 0; i < curve.size(); ++i)
          EXPECT_NEAR(jacobian(i, k), slope[i], 1e-7 * (1 + std::abs(slope[i]))) << equation.name << i << k;
      }
    }
}

TEST(GrowthCurve, OffsetBaseAndShiftMoveTheCurve) {
  const GrowthCurve curve(growth_equation("bertalanffy"), true, true, 0.5);
  GrowthVector natural(4);
  natural << 30, 0.05, 1.3, 4;
  EXPECT_DOUBLE_EQ(curve.value(natural, 10),
                   0.5 + 1.3 + growth_equation("bertalanffy").value(std::vector{30.0, 0.05}, 14));
  EXPECT_NEAR(curve.age_at(natural, curve.value(natural, 10)), 10, 1e-12);
  EXPECT_DOUBLE_EQ(curve.asymptote(natural), 31.8);
  EXPECT_EQ(curve.name(2), "offset");
  EXPECT_EQ(curve.name(3), "time_shift");
  EXPECT_EQ(curve.row("beta2"), 1);
  EXPECT_EQ(curve.row("b2"), 1);
  EXPECT_EQ(curve.row("w3"), -1);
}

}  // namespace
}  // namespace dendrofit
