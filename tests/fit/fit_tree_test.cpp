// SPDX-License-Identifier: GPL-3.0-or-later
#include "fit/fit_tree.h"

#include "core/errors.h"
#include "core/metrics.h"
#include "forward/igm/grow.h"
#include "tests/support/tiny_trees.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>

#include <gtest/gtest.h>

namespace dendrofit {
namespace {

/// A small tree of known parameters (few cycles, so that simulations are cheap).
Tree known_tree() {
  IgmParameters p = igm_preset("table2-06").parameters;
  p.set("xm", 80);
  p.set("r", 0.5);
  p.set("branch_angle_deg", 60);
  p.cycles = 9;
  return grow_igm(p, {}, {.seed = 77}).tree;
}

std::shared_ptr<const PriorBank> repository_bank() {
  std::ifstream in(std::filesystem::path(DENDROFIT_SOURCE_DIR) / "fit" / "data" / "igm.bank",
                   std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(in), {}};
  return std::make_shared<const PriorBank>(decode_bank(bytes, "igm.bank"));
}

FitOptions small_budget() {
  FitOptions options;
  options.evaluations = 40;
  options.age_years = 9;
  options.internode_length_m = 0.1;
  options.observed_from = ObservedFrom::exact;
  return options;
}

const FittedParameter& parameter(const TreeFit& fit, const std::string& key) {
  const auto found = std::find_if(fit.parameters.begin(), fit.parameters.end(),
                                  [&](const FittedParameter& p) { return p.key == key; });
  if (found == fit.parameters.end()) throw InputError("not fitted: " + key);
  return *found;
}

bool same(const TreeFit& a, const TreeFit& b) {
  if (a.cost_history != b.cost_history || a.best_seed != b.best_seed || a.cost_after != b.cost_after)
    return false;
  for (std::size_t i = 0; i < a.parameters.size(); ++i)
    if (a.parameters[i].value != b.parameters[i].value || a.parameters[i].lo != b.parameters[i].lo ||
        a.parameters[i].median != b.parameters[i].median)
      return false;
  return true;
}

TEST(FitTree, a_fit_of_a_grown_tree_beats_the_middle_of_the_prior_on_fresh_seeds) {
  FitOptions options = small_budget();
  options.bank = repository_bank();
  const TreeFit fit = fit_tree(known_tree(), options);
  EXPECT_TRUE(fit.used_bank);
  EXPECT_LT(fit.cost_after, 0.6 * fit.cost_before);
  EXPECT_LT(fit.cost_after, 2.5);  // 1: another seed of the same tree
  EXPECT_LT(fit.seed_floor, 1.5);
  EXPECT_LE(fit.evaluations, 40);
  EXPECT_EQ(fit.cost_history.size(), static_cast<std::size_t>(fit.evaluations));
  for (std::size_t i = 1; i < fit.cost_history.size(); ++i)
    EXPECT_LE(fit.cost_history[i], fit.cost_history[i - 1]);
  for (const FittedParameter& p : fit.parameters) {
    EXPECT_LE(p.lo, p.value) << p.key;
    EXPECT_GE(p.hi, p.value) << p.key;
    EXPECT_LE(p.lo50, p.hi50) << p.key;
    EXPECT_GE(p.lo, p.prior_lo - 1e-9) << p.key;
    EXPECT_LE(p.hi, p.prior_hi + 1e-9) << p.key;
  }
  EXPECT_NEAR(parameter(fit, "branch_angle_deg").median, 60, 15);
  EXPECT_TRUE(parameter(fit, "branch_angle_deg").identifiable);
  // what one tree cannot tell is not told
  for (const char* key : {"tau", "sigma", "b_min"}) EXPECT_FALSE(parameter(fit, key).identifiable) << key;
  ASSERT_EQ(fit.evidence.size(), 3u);
  double sum = 0;
  for (const EquationEvidence& e : fit.evidence) sum += e.probability;
  EXPECT_NEAR(sum, 1, 1e-9);
  EXPECT_EQ(fit.posterior_trees.size(), 5u);
  EXPECT_FALSE(fit.stop_reason.empty());
}

TEST(FitTree, threads_change_nothing_and_neither_does_an_interruption) {
  const Tree tree = known_tree();
  FitOptions options = small_budget();
  std::vector<std::string> checkpoints;
  options.evaluations = 24;
  options.threads = 1;
  options.on_checkpoint = [&](std::string_view bytes) { checkpoints.emplace_back(bytes); };
  const TreeFit one = fit_tree(tree, options);
  ASSERT_FALSE(checkpoints.empty());
  EXPECT_FALSE(one.used_bank);

  options.threads = 3;
  options.on_checkpoint = nullptr;
  options.resume_from = checkpoints.front();
  EXPECT_TRUE(same(one, fit_tree(tree, options)));
  options.seed = 2;
  EXPECT_THROW(fit_tree(tree, options), InputError);  // another fit's checkpoint
  options.resume_from.clear();
  EXPECT_FALSE(same(one, fit_tree(tree, options)));
}

TEST(FitTree, a_bank_of_another_model_is_refused_and_done_without) {
  PriorBank bank = *repository_bank();
  bank.stamp.back() += 1;
  FitOptions options = small_budget();
  options.evaluations = 2;
  options.bank = std::make_shared<const PriorBank>(bank);
  const TreeFit fit = fit_tree(known_tree(), options);
  EXPECT_FALSE(fit.used_bank);
  ASSERT_FALSE(fit.warnings.empty());
  EXPECT_NE(fit.warnings.front().find("grows other trees"), std::string::npos);
}

TEST(FitTree, dated_heights_fix_the_time_course) {
  MeasurementSeries heights{"a", {1, 2, 3, 4, 5, 6, 7, 8, 9}, {}};
  for (const double t : heights.time) heights.value.push_back(8 / (1 + 39 * std::exp(-0.5 * t)));
  FitOptions options = small_budget();
  options.age_years.reset();
  options.heights = heights;
  options.evaluations = 1;
  const TreeFit fit = fit_tree(known_tree(), options);
  EXPECT_TRUE(fit.age_known && fit.course_known);
  EXPECT_EQ(fit.best.cycles, 9);
  EXPECT_NEAR(fit.best.get("r"), 0.5, 1e-6);
  EXPECT_NEAR(fit.best.get("x0") / fit.best.get("xm"), 1.0 / 40, 1e-6);
  EXPECT_THROW(parameter(fit, "r"), InputError);
  options.heights->value.assign(9, 5.0);
  EXPECT_THROW(fit_tree(known_tree(), options), SolverError);
}

TEST(FitTree, a_single_view_tells_less) {
  FitOptions options = small_budget();
  options.evaluations = 1;
  options.observed_from = ObservedFrom::one_view;
  const TreeFit fit = fit_tree(known_tree(), options);
  for (const DescriptorFit& d : fit.descriptors)
    EXPECT_TRUE(descriptor_table()[descriptor_row(d.name)].one_view) << d.name;
}

TEST(FitTree, trees_are_compared_as_the_observer_sees_them) {
  FitOptions options = small_budget();
  options.evaluations = 1;
  int seen = 0;
  options.threads = 1;
  options.observe = [&](const Tree& tree, std::uint64_t) {
    if (++seen % 5 == 0) throw SolverError("no tree to be seen");
    return tree;
  };
  EXPECT_NO_THROW(fit_tree(known_tree(), options));
  EXPECT_GT(seen, 20);
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

  options.bank = repository_bank();
  const TreeFit bare = fit_tree(test::pole(3, 0.03), options);
  for (const FittedParameter& p : bare.parameters) EXPECT_FALSE(p.identifiable) << p.key;
  EXPECT_FALSE(bare.warnings.empty());
}

TEST(FitTree, the_shown_tree_has_the_measures_of_the_observed_one) {
  const Tree tree = known_tree();
  FitOptions options = small_budget();
  options.evaluations = 16;
  options.internode_length_m.reset();
  options.bank = repository_bank();
  options.dbh_m = 1.1 * *measure(tree).dbh_m;  // as measured on a scan beside its model
  const TreeFit fit = fit_tree(tree, options);
  const TreeMetrics wanted = measure(tree),
                    shown = measure(grow_igm(fit.best, {}, {.seed = fit.best_seed}).tree);
  EXPECT_NEAR(shown.height_m, wanted.height_m, 0.02 * wanted.height_m);
  EXPECT_NEAR(shown.total_volume_m3, wanted.total_volume_m3, 0.15 * wanted.total_volume_m3);
  EXPECT_NEAR(shown.crown_diameter_m, wanted.crown_diameter_m, 0.25 * wanted.crown_diameter_m);
  EXPECT_NEAR(*fit.direct.dbh_m, *options.dbh_m, 1e-12);
  Tree regrown = regrow(fit.best, fit.direct, fit.best_seed, no_progress()).tree;
  EXPECT_NEAR(*measure(regrown).dbh_m, *options.dbh_m, 0.02 * *options.dbh_m);
}

TEST(FitTree, a_tree_that_was_cut_is_compared_with_trees_cut_alike) {
  constexpr double kThinnest = 0.004;
  const Tree whole = known_tree(), cut = without_thin_wood(whole, kThinnest);
  const double height = measure(whole).height_m;
  ASSERT_LT(measure(cut).height_m, 0.97 * height);
  FitOptions options = small_budget();
  options.evaluations = 16;
  options.bank = repository_bank();
  const auto mean_height = [&](const TreeFit& fit) {
    double sum = 0;
    for (std::uint64_t seed = 1; seed <= 4; ++seed)
      sum += measure(grow_igm(fit.best, {}, {.seed = seed}).tree).height_m / 4;
    return sum;
  };
  const double taken_for_whole = mean_height(fit_tree(cut, options));
  options.thinnest_wood_m = kThinnest;
  const double known_as_cut = mean_height(fit_tree(cut, options));
  EXPECT_GT(known_as_cut, taken_for_whole);
  EXPECT_NEAR(known_as_cut, height, 0.06 * height);
  options.thinnest_wood_m = -1;
  EXPECT_THROW(fit_tree(cut, options), InputError);
}

TEST(FitTree, refuses_nonsense) {
  EXPECT_THROW(fit_tree(Tree{}), InputError);
  EXPECT_THROW(fit_tree(test::pole(2), {.evaluations = 0}), InputError);
  EXPECT_THROW(fit_tree(test::pole(2), {.age_years = -4}), InputError);
  EXPECT_THROW(fit_tree(test::pole(2), {.equation = "korf"}), InputError);
  FitOptions options;
  options.resume_from = "what is this";
  EXPECT_THROW(fit_tree(known_tree(), options), IoError);
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
