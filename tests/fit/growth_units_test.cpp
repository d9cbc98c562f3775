// SPDX-License-Identifier: GPL-3.0-or-later
#include "fit/growth_units.h"

#include "core/errors.h"
#include "fit/growth_fit.h"
#include "tests/support/growth_data.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace dendrofit {
namespace {

TEST(GrowthUnits, ConvertBetweenUnitsOfAKind) {
  EXPECT_DOUBLE_EQ(unit_factor("ft", "m"), 0.3048);
  EXPECT_DOUBLE_EQ(unit_factor("in", "cm"), 2.54);
  EXPECT_DOUBLE_EQ(unit_factor("months", "years"), 1.0 / 12);
  EXPECT_DOUBLE_EQ(unit_factor("years", "days"), 365.25);
  EXPECT_DOUBLE_EQ(unit_factor("dm3", "m3"), 1e-3);
}

TEST(GrowthUnits, UnknownOrForeignUnitsSaySo) {
  try {
    unit_factor("foot", "m");
    FAIL();
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("unknown unit 'foot'"));
  }
  EXPECT_THROW(unit_factor("ft", "years"), InputError);
}

void expect_same(double a, double b, const std::string& what) {
  if (std::isinf(a) || std::isnan(a))
    EXPECT_EQ(std::isnan(a), std::isnan(b)) << what;
  else
    EXPECT_NEAR(b, a, 1e-9 * std::abs(a)) << what;
}

TEST(GrowthUnits, FittingInOtherUnitsGivesTheSameCurve) {
  const double to_feet = 1 / 0.3048, to_days = 365.25;
  for (const MeasurementSeries& series : {test::rat42(), test::rat43()})
    for (const GrowthEquation& equation : growth_equations()) {
      if (equation.name == "richards" && series.name == "Rat42") continue;  // no finite optimum there
      GrowthOptions plain;
      plain.value_unit = "m";
      plain.band_times = {10, 30};
      GrowthOptions other = plain;
      other.value_unit = "ft";
      other.time_unit = "days";
      other.band_times = {10 * to_days, 30 * to_days};
      const std::string name(equation.name);
      const GrowthFit a = fit_growth_equation(series, name, plain);
      const GrowthFit b = fit_growth_equation(convert_units({series}, to_days, to_feet).front(), name, other);
      ASSERT_EQ(a.status, b.status) << name << " " << series.name << " " << a.reason << b.reason;
      if (a.status != GrowthStatus::ok) continue;
      const std::string what = series.name + " " + name;
      EXPECT_EQ(a.asymptote_bounded, b.asymptote_bounded);
      const GrowthParameter& u = a.parameters[equation.asymptote_row];
      const GrowthParameter& v = b.parameters[equation.asymptote_row];
      expect_same(u.value * to_feet, v.value, what);
      expect_same(u.se * to_feet, v.se, what + " se");
      expect_same(u.lo * to_feet, v.lo, what + " lo");
      expect_same(u.hi * to_feet, v.hi, what + " hi");
      expect_same(a.derived.inflection_age * to_days, b.derived.inflection_age, what + " inflection");
      expect_same(a.derived.max_increment * to_feet / to_days, b.derived.max_increment, what + " increment");
      expect_same(a.derived.mai_culmination_age * to_days, b.derived.mai_culmination_age,
                  what + " culmination");
      expect_same(a.derived.years_to_breast_height * to_days, b.derived.years_to_breast_height,
                  what + " 1.3 m");
      for (int i = 0; i < 2; ++i) {
        expect_same(a.bands[i].fit * to_feet, b.bands[i].fit, what + " band");
        expect_same(a.bands[i].se * to_feet, b.bands[i].se, what + " band error");
      }
    }
}

}  // namespace
}  // namespace dendrofit
