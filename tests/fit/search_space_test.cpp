// SPDX-License-Identifier: GPL-3.0-or-later
#include "fit/search_space.h"

#include "core/errors.h"
#include "forward/growth_equations.h"

#include <cmath>

#include <gtest/gtest.h>

namespace dendrofit {
namespace {

double size_at(const IgmParameters& p, double age) {
  return growth_equation(p.equation).value(p.equation_values, age);
}

TEST(SearchSpace, every_corner_is_a_valid_parameter_set) {
  for (const std::string& equation : SearchSpace::equations()) {
    const SearchSpace space(equation);
    for (int corner = 0; corner < (1 << 12); corner += 37) {
      Eigen::VectorXd unit(space.size());
      for (Eigen::Index i = 0; i < unit.size(); ++i) unit[i] = (corner >> (i % 12)) & 1;
      EXPECT_NO_THROW(space.at(unit).validate()) << equation << corner;
    }
  }
  EXPECT_THROW(SearchSpace("korf"), InputError);
}

TEST(SearchSpace, size_and_maturity_mean_the_same_for_every_equation) {
  for (const std::string& equation : SearchSpace::equations()) {
    SearchSpace space(equation);
    space.fix("size", 80);
    space.fix("maturity", 0.8);
    space.fix("cycles", 15);
    const IgmParameters p = space.at(Eigen::VectorXd::Constant(space.size(), 0.4));
    EXPECT_NEAR(size_at(p, 15), 80, 1e-9) << equation;
    EXPECT_NEAR(size_at(p, 1e4), 100, 1e-9) << equation;
    EXPECT_EQ(p.cycles, 15);
  }
}

TEST(SearchSpace, a_known_time_course_is_kept_whatever_the_size) {
  SearchSpace space("logistic");
  EXPECT_THROW(space.fix_course({{0.03, 1, 0.3}}), InputError);  // the age is missing
  space.fix("cycles", 12);
  space.fix_course({{0.03, 1, 0.3}});
  for (const double u : {0.0, 0.5, 1.0}) {
    const IgmParameters p = space.at(Eigen::VectorXd::Constant(space.size(), u));
    const double most = p.get("xm");
    EXPECT_NEAR(p.get("x0"), 0.03 * most, 1e-9);
    EXPECT_DOUBLE_EQ(p.get("r"), 0.3);
    EXPECT_NEAR(size_at(p, 12), space.value(space.row("size"), u), 1e-9);
  }
  for (const ReportedRow& row : space.reported()) EXPECT_NE(row.key, "xm");
}

TEST(SearchSpace, values_and_coordinates_are_inverse) {
  const SearchSpace space("weibull");
  for (Eigen::Index i = 0; i < space.size(); ++i)
    for (const double u : {0.02, 0.4, 0.97})
      EXPECT_NEAR(space.value(i, space.unit(i, space.value(i, u))), space.value(i, u), 1e-9);
}

TEST(SearchSpace, reported_values_lie_in_their_ranges) {
  for (const std::string& equation : SearchSpace::equations()) {
    const SearchSpace space(equation);
    const auto rows = space.reported();
    for (const double u : {0.0, 0.3, 1.0}) {
      const Eigen::VectorXd values = space.report(Eigen::VectorXd::Constant(space.size(), u), rows);
      for (std::size_t i = 0; i < rows.size(); ++i) {
        EXPECT_GE(values[static_cast<Eigen::Index>(i)], rows[i].lo - 1e-9) << rows[i].key;
        EXPECT_LE(values[static_cast<Eigen::Index>(i)], rows[i].hi + 1e-9) << rows[i].key;
      }
    }
  }
}

}  // namespace
}  // namespace dendrofit
