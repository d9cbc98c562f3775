// SPDX-License-Identifier: GPL-3.0-or-later
#include "fit/growth_fit.h"
#include "tests/support/csv.h"
#include "tests/support/shared_data.h"

#include <cmath>
#include <cstdio>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace dendrofit {
using test::number;
TEST(Ref, All) {
  const auto path = test::shared_data("growth/reference_fits.csv");
  DENDROFIT_NEED(path);
  std::map<std::string, std::map<std::string, MeasurementSeries>> sets;
  int bad_status = 0, bad_bound = 0, n_bound = 0, strict = 0, bad_par = 0, bad_se = 0, bad_rss = 0, worse = 0;
  double worst_par = 0, worst_se = 0, worst_rss = 0;
  for (const auto& row : test::read_csv(path)) {
    const std::string set = row.at("set");
    if (!sets.contains(set)) sets[set] = test::read_series(test::shared_data("growth/" + set + ".csv"));
    GrowthOptions o;
    o.time_unit = "steps";
    o.profile_intervals = std::getenv("PROFILE") != nullptr;
    const auto fit = fit_growth_equation(sets[set].at(row.at("series")), row.at("equation"), o);
    const std::string id = set + " " + row.at("series") + " " + row.at("equation");
    if (growth_status_name(fit.status) != row.at("status")) {
      ++bad_status;
      printf("STATUS %s: %s expected %s rss %.12g ref %.12g limit %.12g ref %s off %.2g cond %.2g\n",
             id.c_str(), growth_status_name(fit.status).c_str(), row.at("status").c_str(), fit.rss,
             number(row, "rss"), fit.rss_limit, row.at("rss_limit").c_str(), fit.relative_offset,
             fit.scaled_condition);
      continue;
    }
    if (row.at("status") != "ok") continue;
    ++n_bound;
    if (fit.asymptote_bounded != (row.at("asym_bounded95") == "TRUE")) {
      ++bad_bound;
      printf("BOUND %s\n", id.c_str());
    }
    const double dr = std::abs(fit.rss / number(row, "rss") - 1);
    if (fit.rss > number(row, "rss") * (1 + 1e-6)) {
      ++worse;
      printf("WORSE %s %.12g %.12g\n", id.c_str(), fit.rss, number(row, "rss"));
    }
    if (dr > 1e-6) {
      ++bad_rss;
      printf("RSS %s %.12g %.12g\n", id.c_str(), fit.rss, number(row, "rss"));
    }
    if (row.at("asym_bounded95") == "TRUE" && number(row, "scaled_cond") < 1e4 &&
        number(row, "gn_step_rel") < 1e-9) {
      ++strict;
      worst_rss = std::max(worst_rss, dr);
      for (const char* k : {"p1", "p2", "p3"}) {
        if (row.at(std::string(k) + "_name").empty()) continue;
        const auto* p = fit.parameter(row.at(std::string(k) + "_name"));
        const double dp = std::abs(p->value / number(row, k) - 1),
                     ds = std::abs(p->se / number(row, std::string(k) + "_se") - 1);
        worst_par = std::max(worst_par, dp);
        worst_se = std::max(worst_se, ds);
        if (!(dp < 1e-6)) {
          ++bad_par;
          printf("PAR %s %s %g off %g\n", id.c_str(), k, dp, fit.relative_offset);
        }
        if (!(ds < 1e-6)) {
          ++bad_se;
          printf("SE %s %s %g\n", id.c_str(), k, ds);
        }
      }
    }
  }
  printf("status %d bound %d/%d strict %d worst par %g se %g rss %g bad %d %d %d worse %d\n", bad_status,
         bad_bound, n_bound, strict, worst_par, worst_se, worst_rss, bad_par, bad_se, bad_rss, worse);
}
}  // namespace dendrofit
