// SPDX-License-Identifier: GPL-3.0-or-later
#include "fit/fit_report.h"

#include "fit/descriptors.h"
#include "tests/support/tiny_trees.h"

#include <algorithm>

#include <gtest/gtest.h>

namespace dendrofit {
namespace {

/// Whether a fit that came from `before` to `after` is warned of in these words.
bool warned(double before, double after, const std::string& words) {
  const FitOptions options;
  FitProblem problem = pose(test::small_tree(), options);
  problem.observed = Eigen::VectorXd::Ones(static_cast<Eigen::Index>(descriptor_table().size()));
  TreeFit fit;
  fit.prior_simulations = 20000;
  fit.seed_floor = 1;
  fit.cost_before = before;
  fit.cost_after = after;
  warn(problem, {}, fit);
  return std::any_of(fit.warnings.begin(), fit.warnings.end(),
                     [&](const std::string& w) { return w.find(words) != std::string::npos; });
}

TEST(FitReport, says_when_the_fit_came_no_nearer_or_cannot_follow) {
  const char* no_nearer = "came no nearer to this tree";
  EXPECT_TRUE(warned(2.8, 3.0, no_nearer));
  EXPECT_FALSE(warned(2.8, 2.7, no_nearer));
  EXPECT_FALSE(warned(0.6, 0.7, no_nearer));  // as near as another seed of the same tree
  const char* cannot = "the growth model cannot follow this tree";
  EXPECT_TRUE(warned(3.8, 4.5, cannot));
  EXPECT_FALSE(warned(3.8, 4.5, no_nearer));  // said once, and by the graver word
  EXPECT_FALSE(warned(2.8, 3.0, cannot));
}

}  // namespace
}  // namespace dendrofit
