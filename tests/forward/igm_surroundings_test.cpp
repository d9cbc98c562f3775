// SPDX-License-Identifier: GPL-3.0-or-later
// What section 5 of the paper shows, with numbers: effects against seed noise.
#include "forward/igm/grow.h"
#include "tests/forward/igm_seeds.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

namespace dendrofit {
namespace {

using test::at_cycle;
using test::crown_centroid;
using test::effect;
using test::grow_seeds;
using test::Sample;
using test::sample;

IgmParameters standard(int cycles) {
  IgmParameters p = igm_preset("standard").parameters;
  p.cycles = cycles;
  return p;
}

bool touches(const Tree& tree, const SolidBox& box) {
  for (std::size_t i = 0; i < tree.size(); ++i)
    for (int s = 0; s <= 20; ++s) {
      const Vec3 at = tree.start[i] + s / 20.0 * (tree.end[i] - tree.start[i]);
      if ((at.array() > box.min.array()).all() && (at.array() < box.max.array()).all()) return true;
    }
  return false;
}

TEST(IgmSurroundings, beside_a_wall_no_wood_crosses_it_and_the_crown_moves_away) {
  IgmSite site;
  site.solids.boxes.push_back({{0.5, -8, -1}, {0.6, 8, 12}});
  const auto beside = grow_seeds(standard(12), 6, site);
  for (const IgmGrowth& growth : beside) {
    EXPECT_FALSE(touches(growth.tree, site.solids.boxes[0]));
    for (const Vec3& end : growth.tree.end) EXPECT_LT(end.x(), 0.5);
  }
  const auto x = [](const IgmGrowth& g) { return crown_centroid(g.tree).x(); };
  const double d = effect(sample(grow_seeds(standard(12), 6), x), sample(beside, x));
  RecordProperty("effect", std::to_string(d));
  EXPECT_LT(d, -2);
}

TEST(IgmSurroundings, under_a_board_branches_go_round) {
  IgmSite site;
  site.solids.boxes.push_back({{0.15, -1.5, 2.5}, {3, 1.5, 2.55}});
  // Wood below the board's height on its side of the stem, over that on both sides.
  const auto on_its_side = [](const IgmGrowth& g) {
    double here = 0, there = 0;
    for (const Vec3& end : g.tree.end) {
      here += end.z() < 2.5 && end.x() > 0.15;
      there += end.z() < 2.5 && end.x() < -0.15;
    }
    return here / (here + there + 1);
  };
  const auto under = grow_seeds(standard(12), 6, site);
  for (const IgmGrowth& growth : under) {
    EXPECT_FALSE(touches(growth.tree, site.solids.boxes[0]));
    EXPECT_GT(growth.series.back().height_m, 3.5);  // past the board
    EXPECT_TRUE(std::any_of(growth.tree.end.begin(), growth.tree.end.end(),
                            [](const Vec3& end) { return end.z() > 2.6 && end.x() > 0.5; }));  // and over it
  }
  const double d = effect(sample(grow_seeds(standard(12), 6), on_its_side), sample(under, on_its_side));
  RecordProperty("effect", std::to_string(d));
  EXPECT_LT(d, -2);
}

TEST(IgmSurroundings, a_wall_as_mesh_half_space_or_box_keeps_all_wood_on_its_side) {
  IgmSite site;
  site.solids.half_spaces.push_back({{0.5, 0, 0}, {-1, 0, 0.2}});
  for (const IgmGrowth& growth : grow_seeds(standard(9), 2, site))
    for (const Vec3& end : growth.tree.end)
      EXPECT_GT((end - site.solids.half_spaces[0].point).dot(site.solids.half_spaces[0].normal), 0);
}

TEST(IgmSurroundings, of_five_trees_the_centre_one_stays_smaller) {
  IgmSite site;
  for (const Vec3& root :
       {Vec3(0, 0, 0), Vec3(1.2, 0, 0), Vec3(-1.2, 0, 0), Vec3(0, 1.2, 0), Vec3(0, -1.2, 0)})
    site.trees.push_back({{root}, std::nullopt});
  const auto stands = grow_seeds(standard(13), 5, site);
  Sample centre, outer;
  for (const IgmGrowth& stand : stands) {
    stand.tree.validate();
    centre.values.push_back(at_cycle(stand, 13, 0).volume_m3);
    double sum = 0;
    for (int tree = 1; tree < 5; ++tree) sum += at_cycle(stand, 13, tree).volume_m3;
    outer.values.push_back(sum / 4);
  }
  RecordProperty("effect", std::to_string(effect(outer, centre)));
  EXPECT_LT(effect(outer, centre), -1);
  EXPECT_EQ(tree_of(stands[0], 0).size(), static_cast<std::size_t>(at_cycle(stands[0], 13, 0).internodes));
}

TEST(IgmSurroundings, the_tree_with_the_smaller_limit_falls_behind_and_stops_early) {
  IgmSite site;
  site.trees.push_back({{Vec3(0, 0, 0)}, igm_preset("table2-05").parameters});
  site.trees.push_back({{Vec3(1.2, 0, 0)}, igm_preset("table2-06").parameters});
  IgmSite alone;
  alone.trees.push_back(site.trees[0]);
  const auto last_growth = [](const IgmGrowth& g) {
    int last = 0;
    for (std::size_t i = 0; i < g.series.size(); ++i) {
      if (g.series[i].tree != 0 || g.series[i].cycle == 0) continue;
      const GrowthRecord& before = at_cycle(g, g.series[i].cycle - 1);
      if (g.series[i].height_m > before.height_m + 0.005) last = g.series[i].cycle;
    }
    return last;
  };
  Sample pair, single, stop;
  for (const IgmGrowth& g : grow_seeds(IgmParameters(), 4, site)) {
    EXPECT_LT(at_cycle(g, 20, 0).height_m, at_cycle(g, 20, 1).height_m);
    pair.values.push_back(static_cast<double>(at_cycle(g, 20, 0).volume_m3));
    stop.values.push_back(last_growth(g));
  }
  for (const IgmGrowth& g : grow_seeds(IgmParameters(), 4, alone))
    single.values.push_back(static_cast<double>(at_cycle(g, 20, 0).volume_m3));
  RecordProperty("effect", std::to_string(effect(single, pair)));
  RecordProperty("last height growth", std::to_string(stop.mean()));
  EXPECT_LT(effect(single, pair), -2);
  EXPECT_LT(stop.mean(), 19);
}

TEST(IgmSurroundings, a_shrub_of_ten_roots_is_one_tree_with_ten_stems) {
  const IgmPreset& preset = igm_preset("table2-09");
  IgmSite site;
  site.trees.resize(1);
  for (int i = 0; i < preset.roots; ++i)
    site.trees[0].roots.emplace_back(0.08 * std::cos(0.628 * i), 0.08 * std::sin(0.628 * i), 0);
  const IgmGrowth growth = grow_igm(preset.parameters, site);
  growth.tree.validate();
  EXPECT_EQ(std::count(growth.tree.parent.begin(), growth.tree.parent.end(), -1), 10);
  EXPECT_NEAR(growth.series.back().height_m, preset.printed_height_m, 0.3);
}

}  // namespace
}  // namespace dendrofit
