// SPDX-License-Identifier: GPL-3.0-or-later
// Against reference fits made with R (nls, nlme) and checked with 50-digit arithmetic; they lie beside the
// checkout.
#include "fit/growth_fit.h"
#include "fit/growth_mixed.h"
#include "fit/growth_statistics.h"
#include "tests/support/csv.h"
#include "tests/support/shared_data.h"

#include <algorithm>
#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace dendrofit {
namespace {

using test::number;

class GrowthReference : public testing::Test {
 protected:
  const MeasurementSeries& series(const std::string& set, const std::string& name) {
    if (!sets_.contains(set)) sets_[set] = test::read_series(test::shared_data("growth/" + set + ".csv"));
    return sets_[set].at(name);
  }
  const MeasurementSeries& series(const test::CsvRow& row) { return series(row.at("set"), row.at("series")); }
  static GrowthOptions quick() {
    GrowthOptions options;
    options.time_unit = "steps";
    options.profile_intervals = false;
    return options;
  }
  static double relative(double value, double reference) {
    if (std::isinf(reference) || reference == 0) return value == reference ? 0 : 1e9;
    return std::abs(value / reference - 1);
  }

 private:
  std::map<std::string, std::map<std::string, MeasurementSeries>> sets_;
};

TEST_F(GrowthReference, EveryFit) {
  const auto path = test::shared_data("growth/reference_fits.csv");
  DENDROFIT_NEED(path);
  int strict = 0, ok = 0, endless = 0, same_flag = 0;
  for (const auto& row : test::read_csv(path)) {
    const std::string id = row.at("set") + " " + row.at("series") + " " + row.at("equation");
    const GrowthFit fit = fit_growth_equation(series(row), row.at("equation"), quick());
    EXPECT_EQ(growth_status_name(fit.status), row.at("status")) << id << ": " << fit.reason;
    if (fit.status != GrowthStatus::ok) {
      EXPECT_THAT(fit.reason, testing::HasSubstr("series '" + row.at("series") + "'"));
      for (const GrowthParameter& parameter : fit.parameters) EXPECT_TRUE(std::isnan(parameter.se)) << id;
      endless += fit.status == GrowthStatus::no_finite_optimum;
      continue;
    }
    ++ok;
    same_flag += fit.asymptote_bounded == (row.at("asym_bounded95") == "TRUE");
    EXPECT_LT(relative(fit.rss, number(row, "rss")), 1e-6) << id;
    if (!(row.at("asym_bounded95") == "TRUE" && number(row, "scaled_cond") < 1e4 &&
          number(row, "gn_step_rel") < 1e-9))
      continue;
    ++strict;
    EXPECT_LT(relative(fit.rss, number(row, "rss")), 1e-9) << id;
    for (const std::string p : {"p1", "p2", "p3"}) {
      if (row.at(p + "_name").empty()) continue;
      const GrowthParameter* parameter = fit.parameter(row.at(p + "_name"));
      EXPECT_LT(relative(parameter->value, number(row, p)), 1e-6) << id << " " << parameter->name;
      EXPECT_LT(relative(parameter->se, number(row, p + "_se")), 1e-6) << id << " " << parameter->name;
    }
    EXPECT_LT(relative(fit.derived.asymptote, number(row, "p1")), 1e-8) << id;
    for (const auto& [column, value] :
         {std::pair<std::string, double>{"t_inflection", fit.derived.inflection_age},
          std::pair<std::string, double>{"y_inflection", fit.derived.inflection_value},
          std::pair<std::string, double>{"max_rate", fit.derived.max_increment},
          std::pair<std::string, double>{"t_mai_max", fit.derived.mai_culmination_age}}) {
      const double reference = number(row, column);
      if (std::isfinite(reference) && std::isfinite(value)) {
        EXPECT_NEAR(value, reference, 1e-8 * std::abs(reference) + 1e-9) << id << " " << column;
      }
    }
    EXPECT_NEAR(fit.aic, number(row, "aic"), 1e-8 * std::abs(number(row, "aic")) + 1e-8) << id;
    EXPECT_NEAR(fit.bic, number(row, "bic"), 1e-8 * std::abs(number(row, "bic")) + 1e-8) << id;
  }
  EXPECT_GT(strict, 1000);
  EXPECT_GT(endless, 100);
  EXPECT_GE(same_flag, 0.99 * ok);
}

// Residual sum of squares with one natural parameter held and all others free.
double profile_rss(const MeasurementSeries& series, const std::string& equation, const std::string& parameter,
                   double value, GrowthOptions options) {
  options.equations = {equation};
  options.fixed = {{parameter, value}};
  const GrowthFit fit = fit_growth_equation(series, equation, options);
  return fit.rss;
}

TEST_F(GrowthReference, ProfileLimits) {
  const auto path = test::shared_data("growth/reference_ci.csv");
  DENDROFIT_NEED(path);
  int checked = 0, reference_off = 0;
  std::map<std::string, GrowthFit> fits;
  for (const auto& row : test::read_csv(path)) {
    const std::string id = row.at("set") + " " + row.at("series") + " " + row.at("equation");
    GrowthOptions options = quick();
    options.profile_intervals = true;
    if (!fits.contains(id)) fits[id] = fit_growth_equation(series(row), row.at("equation"), options);
    const GrowthFit& fit = fits[id];
    const GrowthParameter* parameter = fit.parameter(row.at("param"));
    const int degrees = fit.n - static_cast<int>(fit.parameters.size());
    const double quantile = student_t_two_sided(0.95, degrees);
    const double level = fit.rss * (1 + quantile * quantile / degrees);
    for (const auto& [limit, column] :
         {std::pair{parameter->lo, "profile_lo"}, std::pair{parameter->hi, "profile_hi"}}) {
      ++checked;
      if (relative(limit, number(row, column)) < 1e-4) continue;
      // A few printed limits, all where the other parameters run to an endless asymptote, miss the level
      // themselves: ours then has to meet it where the printed one does not.
      ++reference_off;
      ASSERT_TRUE(std::isfinite(limit) && limit > 0) << id;
      EXPECT_FALSE(fit.asymptote_bounded) << id;
      const std::string what = id + " " + parameter->name + " " + std::string(column);
      const double at_ours = profile_rss(series(row), row.at("equation"), parameter->name, limit, quick());
      const double at_printed =
          profile_rss(series(row), row.at("equation"), parameter->name, number(row, column), quick());
      EXPECT_NEAR(at_ours, level, 1e-5 * level) << what;
      EXPECT_GT(std::abs(at_printed - level), 1e-3 * level) << what;
      // The evidence, for bench/RESULTS.md (--gtest_output=xml shows it).
      RecordProperty("limit_" + std::to_string(reference_off),
                     what + ": ours " + testing::PrintToString(limit) + " at " +
                         testing::PrintToString(at_ours / level) + " of the level, printed " +
                         testing::PrintToString(number(row, column)) + " at " +
                         testing::PrintToString(at_printed / level));
    }
  }
  EXPECT_GT(checked, 120);
  EXPECT_LE(reference_off, 5);
}

TEST_F(GrowthReference, Bands) {
  const auto path = test::shared_data("growth/reference_bands.csv");
  DENDROFIT_NEED(path);
  for (const auto& row : test::read_csv(path)) {
    GrowthOptions options = quick();
    options.band_times = {number(row, "time")};
    const GrowthFit fit = fit_growth_equation(series(row), row.at("equation"), options);
    ASSERT_EQ(fit.bands.size(), 1u);
    const GrowthBandPoint& band = fit.bands[0];
    // One reference fit (condition 4e5) is itself only good to 6e-8 in its parameters and 4e-6 in its bands.
    const double tolerance = fit.scaled_condition > 1e5 ? 1e-5 : 1e-6;
    for (const auto& [value, column] :
         {std::pair{band.fit, "fit"}, std::pair{band.se, "se_fit"}, std::pair{band.confidence_lo, "ci_lo"},
          std::pair{band.confidence_hi, "ci_hi"}, std::pair{band.prediction_lo, "pi_lo"},
          std::pair{band.prediction_hi, "pi_hi"}})
      EXPECT_LT(relative(value, number(row, column)), tolerance)
          << row.at("set") << " " << row.at("series") << " " << row.at("equation") << " " << column;
  }
}

TEST_F(GrowthReference, Weighted) {
  const auto path = test::shared_data("growth/reference_weighted.csv");
  DENDROFIT_NEED(path);
  for (const auto& row : test::read_csv(path)) {
    GrowthOptions options = quick();
    options.weights = GrowthWeights::inverse_value;
    const GrowthFit fit = fit_growth_equation(series(row), row.at("equation"), options);
    const GrowthParameter* parameter = fit.parameter(row.at("param"));
    EXPECT_LT(relative(parameter->value, number(row, "estimate")), 1e-6);
    EXPECT_LT(relative(parameter->se, number(row, "se")), 1e-6);
    EXPECT_LT(relative(fit.rss, number(row, "weighted_rss")), 1e-6);
  }
}

TEST_F(GrowthReference, RobustCosts) {
  const auto path = test::shared_data("growth/reference_robust.csv");
  DENDROFIT_NEED(path);
  const std::map<std::string, std::string> names{{"Huber", "huber"},
                                                 {"SoftLOne", "soft_l1"},
                                                 {"Cauchy", "cauchy"},
                                                 {"Arctan", "arctan"},
                                                 {"Tukey", "tukey"}};
  for (const auto& row : test::read_csv(path)) {
    MeasurementSeries data = series("loblolly_height", "__pooled__");
    if (row.at("data").starts_with("gutten")) {
      data = series("gutten_height", "s1l1t1");
      for (std::size_t i = 0; i < data.time.size(); ++i)
        if (data.time[i] == 80) data.value[i] += 8;
    }
    GrowthOptions options = quick();
    options.loss = growth_loss(names.at(row.at("loss")));
    options.loss_scale = number(row, "a");
    const GrowthFit fit = fit_growth_equation(data, row.at("equation"), options);
    EXPECT_LE(fit.robust_cost, number(row, "cost") * (1 + 1e-6))
        << row.at("loss") << " " << row.at("equation");
  }
}

TEST_F(GrowthReference, MixedModels) {
  const auto path = test::shared_data("growth/reference_mixed.csv");
  DENDROFIT_NEED(path);
  using Effects = GrowthMixedEffects;
  using Form = GrowthMixedForm;
  struct Case {
    const char *set, *model, *equation;
    Effects effects;
    Form form;
    std::vector<std::pair<std::string, std::string>> same;  // our name, theirs
  };
  const std::vector<Case> cases{{"loblolly_height",
                                 "nlme SSasymp(Asym R0 lrc) random Asym|Seed",
                                 "monomolecular",
                                 Effects::asymptote,
                                 Form::start,
                                 {{"a", "Asym"}, {"X0", "R0"}}},
                                {"loblolly_height",
                                 "nlme SSlogis(Asym xmid scal) random Asym|Seed",
                                 "logistic",
                                 Effects::asymptote,
                                 Form::shape,
                                 {{"Xm", "Asym"}, {"inflection_age", "xmid"}}},
                                {"orange_circumference",
                                 "nlme SSlogis(Asym xmid scal) random Asym|Tree",
                                 "logistic",
                                 Effects::asymptote,
                                 Form::shape,
                                 {{"Xm", "Asym"}, {"inflection_age", "xmid"}}},
                                {"orange_circumference",
                                 "nlme logistic(Xm r X0) random Xm|Tree",
                                 "logistic",
                                 Effects::asymptote,
                                 Form::start,
                                 {{"Xm", "Xm"}, {"r", "r"}, {"X0", "X0"}}},
                                {"gutten_height",
                                 "nlme bertalanffy(b1 b2) random b1|tree",
                                 "bertalanffy",
                                 Effects::asymptote,
                                 Form::shape,
                                 {{"b1", "b1"}, {"b2", "b2"}}},
                                {"gutten_height",
                                 "nlme bertalanffy(b1 b2) random b1 b2 correlated|tree",
                                 "bertalanffy",
                                 Effects::asymptote_and_rate,
                                 Form::shape,
                                 {{"b1", "b1"}, {"b2", "b2"}}},
                                {"gutten_height",
                                 "nlme logistic(Asym xmid scal) random Asym|tree",
                                 "logistic",
                                 Effects::asymptote,
                                 Form::shape,
                                 {{"Xm", "Asym"}, {"inflection_age", "xmid"}}},
                                {"gutten_height",
                                 "nlme weibull(w1 logL w3; w2=exp(-logL*w3)) random w1|tree",
                                 "weibull",
                                 Effects::asymptote,
                                 Form::shape,
                                 {{"w1", "w1"}, {"ln_scale_age", "lL"}, {"w3", "w3"}}}};
  std::map<std::string, std::map<std::string, test::CsvRow>> reference;
  for (const auto& row : test::read_csv(path))
    reference[row.at("set") + row.at("model")][row.at("item")] = row;
  for (const Case& one : cases) {
    std::vector<MeasurementSeries> all;
    for (const auto& [name, data] :
         test::read_series(test::shared_data("growth/" + std::string(one.set) + ".csv")))
      if (name != "__pooled__") all.push_back(data);
    GrowthOptions options = quick();
    options.mixed = one.effects;
    options.mixed_form = one.form;
    const GrowthMixed mixed = fit_mixed_growth(all, one.equation, options);
    ASSERT_EQ(mixed.status, GrowthStatus::ok) << one.model << mixed.reason;
    auto& rows = reference.at(std::string(one.set) + one.model);
    EXPECT_NEAR(mixed.log_likelihood, number(rows.at("logLik"), "estimate"), 1e-3) << one.model;
    EXPECT_NEAR(mixed.aic, number(rows.at("AIC"), "estimate"), 2e-3) << one.model;
    EXPECT_NEAR(mixed.bic, number(rows.at("BIC"), "estimate"), 2e-3) << one.model;
    EXPECT_LT(relative(mixed.sigma, number(rows.at("sd(Residual)"), "estimate")), 1e-3) << one.model;
    for (const auto& [ours, theirs] : one.same) {
      const auto at =
          std::find_if(mixed.fixed.begin(), mixed.fixed.end(), [&](const auto& p) { return p.name == ours; });
      ASSERT_NE(at, mixed.fixed.end()) << ours;
      EXPECT_LT(relative(at->value, number(rows.at(theirs), "estimate")), 1e-3) << one.model << " " << ours;
      EXPECT_LT(relative(at->se, number(rows.at(theirs), "se")), 1e-2) << one.model << " " << ours;
    }
  }
}

}  // namespace
}  // namespace dendrofit
