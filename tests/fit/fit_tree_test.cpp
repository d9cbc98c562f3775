// SPDX-License-Identifier: GPL-3.0-or-later
#include "fit/fit_tree.h"

#include "core/errors.h"
#include "core/metrics.h"
#include "fit/search_space.h"
#include "fit/tree_simulator.h"
#include "forward/igm/grow.h"
#include "tests/support/tiny_trees.h"

#include <cmath>

#include <gtest/gtest.h>

namespace dendrofit {
namespace {

/// A small tree of known parameters (few cycles, so that simulations are cheap).
Tree known_tree() {
  IgmParameters p = igm_preset("standard").parameters;
  p.set("xm", 70);
  p.set("r", 0.45);
  p.set("branch_angle_deg", 60);
  p.cycles = 10;
  return grow_igm(p, {}, {.seed = 77}).tree;
}

FitOptions small_budget() {
  FitOptions options;
  options.evaluations = 120;
  options.age_years = 10;
  options.internode_length_m = 0.1;
  return options;
}

bool same(const TreeFit& a, const TreeFit& b) {
  if (a.cost_history != b.cost_history || a.best_seed != b.best_seed || a.cost_after != b.cost_after)
    return false;
  for (std::size_t i = 0; i < a.parameters.size(); ++i)
    if (a.parameters[i].value != b.parameters[i].value || a.parameters[i].lo != b.parameters[i].lo)
      return false;
  return true;
}

TEST(FitTree, a_fit_of_a_grown_tree_beats_the_middle_of_the_prior_on_fresh_seeds) {
  const TreeFit fit = fit_tree(known_tree(), small_budget());
  EXPECT_LT(fit.cost_after, 0.6 * fit.cost_before);
  EXPECT_LT(fit.cost_after, 2.5);  // 1: another seed of the same tree
  EXPECT_LT(fit.seed_floor, 1.5);
  EXPECT_LE(fit.evaluations, 120);
  EXPECT_EQ(fit.cost_history.size(), static_cast<std::size_t>(fit.evaluations));
  for (std::size_t i = 1; i < fit.cost_history.size(); ++i)
    EXPECT_LE(fit.cost_history[i], fit.cost_history[i - 1]);
  for (const FittedParameter& p : fit.parameters) {
    EXPECT_LE(p.lo, p.value);
    EXPECT_GE(p.hi, p.value);
    EXPECT_GE(p.lo, p.prior_lo - 1e-9);
    EXPECT_LE(p.hi, p.prior_hi + 1e-9);
  }
  EXPECT_FALSE(fit.stop_reason.empty());
}

TEST(FitTree, threads_change_nothing) {
  const Tree tree = known_tree();
  FitOptions options = small_budget();
  options.evaluations = 60;
  options.threads = 1;
  const TreeFit one = fit_tree(tree, options);
  options.threads = 3;
  EXPECT_TRUE(same(one, fit_tree(tree, options)));
  options.seed = 2;
  EXPECT_FALSE(same(one, fit_tree(tree, options)));
}

TEST(FitTree, starved_and_poor_input_end_politely) {
  FitOptions options = small_budget();
  options.evaluations = 1;
  options.age_years = 6;
  options.internode_length_m.reset();
  const TreeFit starved = fit_tree(test::small_tree(), options);
  EXPECT_EQ(starved.evaluations, 1);
  ASSERT_FALSE(starved.warnings.empty());
  for (const FittedParameter& p : starved.parameters) EXPECT_FALSE(p.identifiable) << p.key;

  options.evaluations = 40;
  const TreeFit bare = fit_tree(test::pole(3, 0.03), options);
  for (const FittedParameter& p : bare.parameters) {
    if (p.key == "branch_angle_deg") {
      EXPECT_FALSE(p.identifiable);
    }
  }
}

TEST(FitTree, refuses_nonsense) {
  EXPECT_THROW(fit_tree(Tree{}), InputError);
  EXPECT_THROW(fit_tree(test::pole(2), {.evaluations = 0}), InputError);
  EXPECT_THROW(fit_tree(test::pole(2), {.age_years = -4}), InputError);
  EXPECT_THROW(fit_tree(test::pole(2), {.equation = "korf"}), InputError);
}

TEST(TreeSimulator, radii_are_scaled_to_the_observed_diameter) {
  DirectEstimates observed = estimate_directly(known_tree());
  observed.dbh_m = 0.1;
  IgmParameters p = igm_preset("standard").parameters;
  p.cycles = 10;
  const Regrown grown = regrow(p, observed, 5, no_progress());
  EXPECT_NEAR(*measure(grown.tree).dbh_m, 0.1, 1e-9);
  // and the growth model, given that tip radius, grows the same tree
  p.tip_radius_m = grown.tip_radius_m;
  const Tree again = grow_igm(p, {}, {.seed = 5}).tree;
  ASSERT_EQ(again.size(), grown.tree.size());
  EXPECT_NEAR(again.radius[0], grown.tree.radius[0], 1e-9);
}

}  // namespace
}  // namespace dendrofit
