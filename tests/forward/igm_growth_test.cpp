// SPDX-License-Identifier: GPL-3.0-or-later
// The numbers of the paper and of the authors' stored trees.
#include "core/errors.h"
#include "core/metrics.h"
#include "forward/growth_equations.h"
#include "forward/igm/grow.h"
#include "tests/forward/igm_seeds.h"

#include <array>
#include <atomic>
#include <cmath>
#include <thread>

#include <gtest/gtest.h>

namespace dendrofit {
namespace {

using test::at_cycle;
using test::grow_seeds;
using test::Sample;
using test::sample;

const std::vector<IgmGrowth>& standard_trees() {
  static const std::vector<IgmGrowth> grown = grow_seeds(igm_preset("standard").parameters, 12);
  return grown;
}

bool same(const Tree& a, const Tree& b) {
  return a.start == b.start && a.end == b.end && a.parent == b.parent && a.radius == b.radius &&
         a.axis == b.axis && a.order == b.order && a.birth_cycle == b.birth_cycle;
}

TEST(IgmGrowth, trunk_has_the_published_internodes_while_the_leader_lives) {
  const std::array<int, 8> expected{7, 10, 13, 16, 19, 23, 28, 34};
  int alive = 0;
  for (const IgmGrowth& growth : standard_trees()) {
    bool leads = true;
    for (int cycle = 1; cycle <= 8; ++cycle) {
      const int stem = at_cycle(growth, cycle).stem_internodes;
      EXPECT_LE(stem, expected[static_cast<std::size_t>(cycle - 1)]);
      leads = leads && stem == expected[static_cast<std::size_t>(cycle - 1)];
    }
    alive += leads;
  }
  EXPECT_GE(alive, 8);  // of 12 seeds
}

TEST(IgmGrowth, stops_by_itself_after_cycle_20_as_every_100_rho_row_of_table_2) {
  for (const char* row : {"table2-06", "table2-11"}) {
    IgmParameters p = igm_preset(row).parameters;
    p.max_markers = 4000;  // a thin crown: the last cycle is the equation's matter
    int twenty = 0;
    for (const IgmGrowth& growth : grow_seeds(p, 3, {}, true)) {
      EXPECT_LE(growth.last_cycle, 20);
      twenty += growth.last_cycle == 20;
      EXPECT_EQ(growth.stop_reason, "the growth equation allows no further internode");
    }
    EXPECT_GE(twenty, 2) << row;
  }
  const GrowthEquation& logistic = growth_equation("logistic");
  const std::vector<double> values{2, 100, 0.34};
  EXPECT_NEAR(logistic.value(values, 20), 94.8, 0.05);
  EXPECT_NEAR(logistic.rate(values, 11.45), 8.5, 0.005);
  EXPECT_NEAR(logistic.inflection_age(values), 11.45, 0.005);
}

// Published or independently simulated values against our seeds: within two seed standard deviations.
void expect_within_2_sd(const Sample& ours, double theirs, const char* what) {
  EXPECT_LE(std::abs(ours.mean() - theirs), 2 * ours.sd())
      << what << ": ours " << ours.mean() << " +- " << ours.sd() << ", theirs " << theirs;
}

Sample axes(int cycle) {
  return sample(standard_trees(),
                [&](const IgmGrowth& g) { return static_cast<double>(at_cycle(g, cycle).axes); });
}
Sample internodes(int cycle) {
  return sample(standard_trees(),
                [&](const IgmGrowth& g) { return static_cast<double>(at_cycle(g, cycle).internodes); });
}
Sample height(int cycle) {
  return sample(standard_trees(), [&](const IgmGrowth& g) { return at_cycle(g, cycle).height_m; });
}

TEST(IgmGrowth, standard_trees_match_the_authors_stored_output) {
  expect_within_2_sd(internodes(6), 257, "internodes at cycle 6");  // program run anew: 238-277
  expect_within_2_sd(axes(6), 41, "axes at cycle 6");               // 34-49
  expect_within_2_sd(internodes(8), 683, "internodes at cycle 8");  // 643-723
  expect_within_2_sd(internodes(10), 1542, "internodes at cycle 10");
  expect_within_2_sd(axes(10), 228, "axes at cycle 10");
  expect_within_2_sd(height(10), 4.61, "height at cycle 10");
  expect_within_2_sd(internodes(12), 3322, "internodes at cycle 12");
  expect_within_2_sd(axes(12), 535, "axes at cycle 12");
  expect_within_2_sd(height(12), 5.78, "height at cycle 12");
  expect_within_2_sd(internodes(20), 10189, "internodes at cycle 20");  // middle of 8,180-12,198
  expect_within_2_sd(height(20), 7.9, "height at cycle 20");            // 7.5-8.3
}

// The authors' stored tree has internodes of rho v / floor(v): median 1.03 rho, longest 1.98 rho. With v of
// the node's shoots together lengths, counts and the height at cycle 6 are theirs; with each shoot's share
// lengths are not.
TEST(IgmGrowth, stretched_by_the_nodes_resource_internodes_are_as_long_as_the_authors) {
  IgmParameters p = igm_preset("standard").parameters;
  p.cycles = 12;
  p.stretch_internodes = true;
  const auto median_length = [](const IgmGrowth& growth) {
    std::vector<double> length;
    for (std::size_t i = 0; i < growth.tree.size(); ++i) length.push_back(growth.tree.length(i) / 0.1);
    std::nth_element(length.begin(), length.begin() + static_cast<std::ptrdiff_t>(length.size() / 2),
                     length.end());
    return length[length.size() / 2];
  };
  EXPECT_GT(median_length(test::grow_seeds(p, 1)[0]), 1.05);
  p.stretch_by_node = true;
  const auto grown = test::grow_seeds(p, 8);
  EXPECT_NEAR(test::sample(grown, median_length).mean(), 1.03, 0.015);
  for (const IgmGrowth& growth : grown)
    for (std::size_t i = 0; i < growth.tree.size(); ++i) {
      ASSERT_LT(growth.tree.length(i), 0.2);
      ASSERT_GT(growth.tree.length(i), 0.1 - 1e-9);
    }
  const auto internodes = [&](int cycle) {
    return test::sample(grown, [cycle](const IgmGrowth& g) {
      return static_cast<double>(test::at_cycle(g, cycle).internodes);
    });
  };
  expect_within_2_sd(internodes(8), 683, "internodes at cycle 8");
  expect_within_2_sd(internodes(10), 1542, "internodes at cycle 10");
  expect_within_2_sd(internodes(12), 3322, "internodes at cycle 12");
  const test::Sample height =
      test::sample(grown, [](const IgmGrowth& g) { return test::at_cycle(g, 6).height_m; });
  EXPECT_GT(height.mean() + 2 * height.sd(), 2.32);
  EXPECT_LT(height.mean() - 2 * height.sd(), 2.34);
}

TEST(IgmGrowth, table_2_rows_reach_their_printed_heights) {
  for (const char* row : {"table2-06", "table2-11"}) {
    const IgmPreset& preset = igm_preset(row);
    const Sample heights =
        sample(grow_seeds(preset.parameters, 8), [](const IgmGrowth& g) { return g.series.back().height_m; });
    RecordProperty(std::string(row) + " height", std::to_string(heights.mean()));
    EXPECT_NEAR(heights.mean(), preset.printed_height_m, 0.7) << row << " sd " << heights.sd();
    EXPECT_LT(heights.sd(), 0.5);
  }
}

TEST(IgmGrowth, every_preset_and_equation_gives_a_valid_tree) {
  for (const IgmPreset& preset : igm_presets()) {
    IgmParameters p = preset.parameters;
    p.cycles = 9;
    const IgmGrowth growth = grow_igm(p);
    growth.tree.validate();
    EXPECT_GT(growth.tree.size(), 50u) << preset.name;
    EXPECT_EQ(growth.tree_of_axis.size(), static_cast<std::size_t>(growth.tree.axis_count()));
    EXPECT_EQ(growth.series.size(), 10u);
    EXPECT_EQ(growth.series.back().internodes, static_cast<std::int64_t>(growth.tree.size()));
    EXPECT_NEAR(growth.series.back().height_m, measure(growth.tree).height_m, 0.02);
  }
  for (const char* equation : {"bertalanffy", "weibull", "gompertz", "chapman_richards"}) {
    IgmParameters p = igm_preset("standard").parameters;
    p.set_equation(equation);
    p.cycles = 12;
    const IgmGrowth growth = grow_igm(p);
    growth.tree.validate();
    EXPECT_GT(growth.series.back().height_m, 2.5) << equation;
  }
}

TEST(IgmGrowth, the_same_seed_gives_the_same_tree_from_any_thread) {
  IgmParameters p = igm_preset("standard").parameters;
  p.cycles = 10;
  const IgmGrowth alone = grow_igm(p);
  std::array<IgmGrowth, 4> together;
  std::vector<std::thread> threads;
  for (IgmGrowth& growth : together) threads.emplace_back([&growth, &p] { growth = grow_igm(p); });
  for (std::thread& thread : threads) thread.join();
  for (const IgmGrowth& growth : together) EXPECT_TRUE(same(growth.tree, alone.tree));
  IgmOptions other;
  other.seed = 2;
  EXPECT_FALSE(same(grow_igm(p, {}, other).tree, alone.tree));
}

TEST(IgmGrowth, without_resource_allocation_the_equation_alone_gives_size_and_shape) {
  IgmParameters p = igm_preset("standard").parameters;
  p.cycles = 14;
  const Sample with = sample(grow_seeds(p, 3), [](const IgmGrowth& g) { return g.series.back().height_m; });
  p.resource_allocation = false;
  const auto without = grow_seeds(p, 3);
  for (const IgmGrowth& growth : without) growth.tree.validate();
  EXPECT_NEAR(
      sample(without, [](const IgmGrowth& g) { return g.series.back().height_m; }).mean() / with.mean(), 1,
      0.2);
}

TEST(IgmGrowth, radii_follow_the_pipe_model_and_never_shrink) {
  IgmParameters p = igm_preset("standard").parameters;
  p.cycles = 3;  // before any shedding
  const Tree tree = grow_igm(p).tree;
  std::vector<double> carried(tree.size(), 0);
  for (std::size_t i = tree.size(); i-- > 0;) {
    const double expected = carried[i] > 0 ? carried[i] : std::pow(p.tip_radius_m, p.pipe_exponent);
    EXPECT_NEAR(std::pow(tree.radius[i], p.pipe_exponent), expected, 1e-12);
    if (tree.parent[i] >= 0) carried[static_cast<std::size_t>(tree.parent[i])] += expected;
  }
  double thickest = 0;
  for (const GrowthRecord& record : standard_trees()[0].series) {
    if (!record.dbh_m) continue;
    EXPECT_GE(*record.dbh_m, thickest - 1e-12);
    thickest = *record.dbh_m;
  }
  EXPECT_GT(thickest, 0.05);
}

TEST(IgmGrowth, the_paper_switch_gives_the_authors_base_radii) {
  IgmParameters p = igm_preset("standard").parameters;
  p.paper = true;
  for (const auto& [cycle, radius] : {std::pair{10, 0.0460}, std::pair{12, 0.0629}}) {
    p.cycles = cycle;
    const Sample base = sample(grow_seeds(p, 6), [](const IgmGrowth& g) { return g.tree.radius[0]; });
    EXPECT_NEAR(base.mean() / radius, 1, 0.15) << "cycle " << cycle << " sd " << base.sd();
  }
}

TEST(IgmGrowth, restored_light_keeps_more_wood_alive) {
  IgmParameters p = igm_preset("standard").parameters;
  p.cycles = 12;
  const auto wood = [](const IgmGrowth& g) { return static_cast<double>(g.tree.size()); };
  const Sample kept = sample(grow_seeds(p, 4), wood);
  p.restore_light = true;
  EXPECT_GT(test::effect(kept, sample(grow_seeds(p, 4), wood)), 1);
}

TEST(IgmGrowth, goes_on_from_its_own_tree_where_it_stood) {
  IgmParameters p = igm_preset("standard").parameters;
  p.cycles = 9;
  IgmOptions options;
  const IgmGrowth young = grow_igm(p);
  options.start = young.tree;
  p.cycles = 12;
  const IgmGrowth older = grow_igm(p, {}, options);
  older.tree.validate();
  EXPECT_EQ(older.series.front().cycle, 9);
  EXPECT_EQ(older.series.front().internodes, static_cast<std::int64_t>(young.tree.size()));
  EXPECT_NEAR(older.series.front().height_m, young.series.back().height_m, 1e-9);
  EXPECT_NEAR(*older.series.front().dbh_m, *young.series.back().dbh_m, 1e-9);
  EXPECT_EQ(older.series.back().cycle, 12);
  EXPECT_GT(older.tree.size(), young.tree.size());
  EXPECT_GT(older.series.back().height_m, young.series.back().height_m + 0.5);
}

TEST(IgmGrowth, goes_on_from_a_scanned_tree_of_any_cylinder_lengths_far_from_the_origin) {
  Tree scanned;
  scanned.origin_shift = Vec3(432100, 5412300, 250);
  const auto add = [&](const Vec3& from, const Vec3& to, int parent, double radius, int axis, int order) {
    TreeNode node;
    node.start = from, node.end = to, node.parent = parent, node.radius = radius, node.axis = axis,
    node.order = order;
    return scanned.add(node);
  };
  const int a = add({3, 4, 1}, {3, 4, 1.83}, -1, 0.06, 0, 0);
  const int b = add({3, 4, 1.83}, {3.05, 4, 2.9}, a, 0.045, 0, 0);
  add({3.05, 4, 2.9}, {3.1, 4.1, 3.3}, b, 0.03, 0, 0);
  add({3.06, 4, 2.1}, {3.9, 4.2, 2.6}, b, 0.02, 1, 1);
  add({2.97, 4, 2.0}, {2.96, 4, 2.02}, b, 0.01, 2, 1);  // shorter than the bearer is thick
  IgmParameters p = igm_preset("standard").parameters;
  IgmOptions options;
  options.start = scanned;
  IgmSite site;
  site.origin_shift = Vec3(432000, 5412000, 200);
  p.cycles = 12;
  const IgmGrowth grown = grow_igm(p, site, options);
  grown.tree.validate();
  const int start = grown.series.front().cycle;
  EXPECT_NEAR(start, growth_equation("logistic").age_at(p.equation_values, 24), 1.5);
  EXPECT_NEAR(grown.series.front().height_m, 2.3, 1e-6);
  EXPECT_NEAR(grown.series.front().length_m, 0.83 + 1.07 + 0.42 + 0.98 + 0.1, 0.25);
  EXPECT_NEAR(2 * 0.045, *grown.series.front().dbh_m, 0.01);
  EXPECT_GT(grown.series.back().height_m, 3.0);
  const Vec3 foot = grown.tree.start[0] + grown.tree.origin_shift;
  EXPECT_NEAR((foot - Vec3(432103, 5412304, 251)).norm(), 0, 1e-6);
}

TEST(IgmGrowth, refuses_what_cannot_be_grown) {
  IgmParameters p;
  p.set("x0", 100);
  EXPECT_THROW(grow_igm(p), InputError);
  p = IgmParameters();
  p.b_min = 1;
  EXPECT_THROW(grow_igm(p), InputError);
  IgmSite site;
  site.trees.push_back({{Vec3(1, 1, 0)}, std::nullopt});
  site.solids.boxes.push_back({{0, 0, -1}, {2, 2, 3}});
  EXPECT_THROW(grow_igm(IgmParameters(), site), InputError);
  // Thinner than the seedling is tall, and across it.
  site.solids.boxes[0] = {{0, 0, 0.1}, {2, 2, 0.2}};
  EXPECT_THROW(grow_igm(IgmParameters(), site), InputError);
  site.solids.boxes[0] = {{0, 0, -1}, {2, 2, 0}};  // ground to stand on
  IgmParameters young;
  young.cycles = 2;
  EXPECT_NO_THROW(grow_igm(young, site));
  site.solids.boxes.clear();
  site.trees[0].roots.clear();
  EXPECT_THROW(grow_igm(IgmParameters(), site), InputError);
  IgmOptions options;
  options.start = Tree();
  EXPECT_THROW(grow_igm(IgmParameters(), {}, options), InputError);
  std::atomic<bool> cancel{true};
  Progress progress(&cancel);
  EXPECT_THROW(grow_igm(IgmParameters(), {}, {}, progress), Cancelled);
}

TEST(IgmGrowth, frames_are_the_trees_of_shorter_runs) {
  IgmParameters p = igm_preset("standard").parameters;
  p.cycles = 6;
  IgmOptions options;
  std::vector<int> cycles;
  Tree third;
  options.on_cycle = [&](int cycle, const Tree& tree) {
    cycles.push_back(cycle);
    if (cycle == 3) third = tree;
  };
  grow_igm(p, {}, options);
  EXPECT_EQ(cycles, (std::vector<int>{1, 2, 3, 4, 5, 6}));
  p.cycles = 3;
  EXPECT_TRUE(same(third, grow_igm(p).tree));
}

}  // namespace
}  // namespace dendrofit
