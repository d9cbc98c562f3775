// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/errors.h"
#include "forward/igm/parameters.h"

#include <cmath>
#include <functional>
#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace dendrofit {
namespace {

using ::testing::HasSubstr;

std::string message_of(const std::function<void()>& action) {
  try {
    action();
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(IgmParameters, every_row_of_the_table_can_be_read_set_and_stays_within_its_bounds) {
  for (const char* equation : {"logistic", "bertalanffy", "weibull", "gompertz"}) {
    IgmParameters p;
    p.set_equation(equation);
    std::set<std::string_view> keys;
    for (const ParameterSpec& row : igm_parameter_table(equation)) {
      EXPECT_TRUE(keys.insert(row.key).second) << row.key;
      EXPECT_DOUBLE_EQ(p.get(row.key), row.default_value) << row.key;
      EXPECT_LE(row.lo, row.default_value) << row.key;
      EXPECT_GE(row.hi, row.default_value) << row.key;
      p.set(row.key, row.default_value);
      EXPECT_THROW(p.set(row.key, row.hi * 2 + 1), InputError) << row.key;
      EXPECT_THROW(p.set(row.key, std::nan("")), InputError) << row.key;
    }
    p.validate();
  }
  for (const char* key :
       {"x0", "xm", "r", "rho_m", "lambda", "k", "tau", "alpha", "sigma", "mu", "gamma", "b_min", "b_max",
        "shed_ratio", "branch_angle_deg", "pipe_exponent", "tip_radius_m", "cycles", "resource_allocation"})
    EXPECT_NO_THROW(IgmParameters().get(key)) << key;
}

TEST(IgmParameters, refusals_name_field_value_and_limit) {
  IgmParameters p;
  EXPECT_THAT(message_of([&] { p.set("lamda", 0.5, "a.toml:3"); }),
              HasSubstr("a.toml:3: unknown parameter 'lamda'; did you mean 'lambda'"));
  EXPECT_THAT(message_of([&] { p.set("xm", -4); }), HasSubstr("xm = -4"));
  EXPECT_THAT(message_of([&] { p.set("b_min", 1.0); }), HasSubstr("b_min = 1"));
  EXPECT_THAT(message_of([&] { p.set("cycles", 2.5); }), HasSubstr("whole number"));
  EXPECT_THAT(message_of([&] { p.set_equation("logistik"); }), HasSubstr("did you mean 'logistic'"));
  p.set("x0", 120);
  EXPECT_THAT(message_of([&] { p.validate(); }), HasSubstr("x0 = 120"));
  IgmParameters q;
  q.b_min = 2.5;
  EXPECT_THROW(q.validate(), InputError);
  q = IgmParameters();
  q.mu = std::nan("");
  EXPECT_THROW(q.validate(), InputError);
}

TEST(IgmParameters, cap_has_the_values_of_the_specification) {
  IgmParameters p;  // x0 = 2, xm = 100, r = 0.34
  double peak = 0, when = 0;
  EXPECT_DOUBLE_EQ(p.cap(1), 4);
  EXPECT_DOUBLE_EQ(p.cap(4), 4);
  for (int t = 5; t <= 25; ++t)
    if (p.cap(t) > peak) peak = p.cap(t), when = t;
  EXPECT_NEAR(peak, 8.5, 0.06);  // 8.5 at 11.45
  EXPECT_TRUE(when == 11 || when == 12);
  EXPECT_NEAR(p.cap(20), 1.668, 0.001);
  EXPECT_NEAR(p.cap(21), 1.224, 0.001);
}

TEST(IgmParameters, shading_base_rises_from_tau_to_the_end_of_the_schedule) {
  IgmParameters p;
  p.tau = 4, p.b_min = 1.8, p.b_max = 2.2, p.schedule_cycles = 20;
  EXPECT_DOUBLE_EQ(p.shading_base(1), 1.8);
  EXPECT_DOUBLE_EQ(p.shading_base(4), 1.8);
  EXPECT_NEAR(p.shading_base(12), 2.0, 1e-12);
  EXPECT_DOUBLE_EQ(p.shading_base(20), 2.2);
  EXPECT_DOUBLE_EQ(p.shading_base(35), 2.2);
}

TEST(IgmPresets, are_the_standard_and_the_eleven_rows_of_table_2) {
  EXPECT_EQ(igm_presets().size(), 12u);
  for (const IgmPreset& preset : igm_presets()) {
    preset.parameters.validate();
    EXPECT_FALSE(preset.summary.empty());
  }
  EXPECT_DOUBLE_EQ(igm_preset("standard").parameters.get("x0"), 3);
  const IgmParameters& shrub =
      igm_preset("table2-09").parameters;  // 5.3: Xm = 50 rho, lambda .46, k .5, mu .6
  EXPECT_DOUBLE_EQ(shrub.get("xm"), 50);
  EXPECT_DOUBLE_EQ(shrub.lambda, 0.46);
  EXPECT_DOUBLE_EQ(shrub.mu, 0.6);
  EXPECT_THAT(message_of([] { igm_preset("table2-7"); }), HasSubstr("table2-"));
}

}  // namespace
}  // namespace dendrofit
