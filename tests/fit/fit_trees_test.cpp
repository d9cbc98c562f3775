// SPDX-License-Identifier: GPL-3.0-or-later
#include "fit/fit_trees.h"

#include "core/errors.h"
#include "forward/igm/grow.h"
#include "tests/support/tiny_trees.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>

#include <gtest/gtest.h>

namespace dendrofit {
namespace {

Tree one_of_a_kind(std::uint64_t seed) {
  IgmParameters p = igm_preset("table2-06").parameters;
  p.set("xm", 80);
  p.set("r", 0.5);
  p.set("branch_angle_deg", 60);
  p.cycles = 9;
  return grow_igm(p, {}, {.seed = seed}).tree;
}

FitOptions options_with_bank() {
  std::ifstream in(std::filesystem::path(DENDROFIT_SOURCE_DIR) / "fit" / "data" / "igm.bank",
                   std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(in), {}};
  FitOptions options;
  options.bank = std::make_shared<const PriorBank>(decode_bank(bytes, "igm.bank"));
  options.evaluations = 1;
  options.age_years = 9;
  options.internode_length_m = 0.1;
  options.observed_from = ObservedFrom::exact;
  return options;
}

const FittedParameter& parameter(const std::vector<FittedParameter>& list, const std::string& key) {
  return *std::find_if(list.begin(), list.end(), [&](const FittedParameter& p) { return p.key == key; });
}

TEST(FitTrees, share_what_belongs_to_their_kind_and_know_it_better_together) {
  const TreesFit fit = fit_trees({one_of_a_kind(77), one_of_a_kind(78)}, options_with_bank());
  ASSERT_EQ(fit.trees.size(), 2u);
  for (const char* key : {"k", "lambda", "gamma", "branch_angle_deg", "pipe_exponent"}) {
    EXPECT_DOUBLE_EQ(fit.trees[0].best.get(key), fit.trees[1].best.get(key)) << key;
    EXPECT_DOUBLE_EQ(fit.trees[0].best.get(key), parameter(fit.shared, key).value) << key;
  }
  EXPECT_NEAR(parameter(fit.shared, "branch_angle_deg").value, 60, 12);
  const TreeFit alone = fit_tree(one_of_a_kind(77), options_with_bank());
  const auto width = [](const FittedParameter& p) { return p.hi - p.lo; };
  EXPECT_LT(width(parameter(fit.shared, "branch_angle_deg")),
            0.95 * width(parameter(alone.parameters, "branch_angle_deg")));
  for (const FittedParameter& p : fit.shared) EXPECT_NE(p.key, "xm");
}

TEST(FitTrees, refuse_what_makes_no_sense_for_several) {
  const Tree pole = test::pole(3);
  EXPECT_THROW(fit_trees({pole}, options_with_bank()), InputError);
  EXPECT_THROW(fit_trees({pole, pole}, {}), InputError);  // no bank
  FitOptions dated = options_with_bank();
  dated.heights = MeasurementSeries{"a", {1, 2}, {1, 2}};
  EXPECT_THROW(fit_trees({pole, pole}, dated), InputError);
}

}  // namespace
}  // namespace dendrofit
