// SPDX-License-Identifier: GPL-3.0-or-later
// What each parameter does (Yi et al. 2018, Figs 2, 3, 17 and sections 4.1, 4.2, 5.6): effects against seed
// noise.
#include "core/metrics.h"
#include "forward/igm/grow.h"
#include "tests/forward/igm_seeds.h"

#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace dendrofit {
namespace {

using test::at_cycle;
using test::effect;
using test::grow_seeds;
using test::sample;

constexpr int kSeeds = 8;

// Trees of one preset at one age under values of one parameter, and how many seed standard deviations a
// measure moves from each value to the next.
class Trees {
 public:
  Trees(const char* preset, int cycles, const char* key, const std::vector<double>& values) {
    for (const double value : values) {
      IgmParameters p = igm_preset(preset).parameters;
      p.cycles = cycles;
      p.set(key, value);
      grown_.push_back(grow_seeds(p, kSeeds));
    }
  }
  std::vector<double> effects(const char* name,
                              const std::function<double(const IgmGrowth&)>& measure) const {
    std::vector<double> effects;
    for (std::size_t i = 1; i < grown_.size(); ++i)
      effects.push_back(effect(sample(grown_[i - 1], measure), sample(grown_[i], measure)));
    std::string text;
    for (const double d : effects) text += std::to_string(d) + " ";
    testing::Test::RecordProperty(name, text);
    return effects;
  }

 private:
  std::vector<std::vector<IgmGrowth>> grown_;
};

double wood(const IgmGrowth& growth) {
  return static_cast<double>(growth.tree.size());
}
double laterals(const IgmGrowth& growth) {
  return static_cast<double>(growth.series.back().axes - 1);
}
double stem_internodes(const IgmGrowth& growth) {
  return growth.series.back().stem_internodes;
}
double internodes_of_a_lateral(const IgmGrowth& growth) {
  return (wood(growth) - stem_internodes(growth)) / laterals(growth);
}
double laterals_per_stem_internode(const IgmGrowth& growth) {
  return laterals(growth) / stem_internodes(growth);
}
double branch_over_stem_volume(const IgmGrowth& growth) {
  const TreeMetrics metrics = measure(growth.tree);
  return metrics.branch_volume_m3 / metrics.stem_volume_m3;
}
double internodes_per_crown_volume(const IgmGrowth& growth) {
  return wood(growth) / measure(growth.tree).crown_volume_m3;
}
double base_radius(const IgmGrowth& growth) {
  return growth.tree.radius[0];
}
// Share of the branches that sprang from wood of three cycles and older.
double branches_from_old_wood(const IgmGrowth& growth) {
  const Tree& tree = growth.tree;
  double old = 0, all = 0;
  for (std::size_t i = 0; i < tree.size(); ++i) {
    if (tree.parent[i] < 0) continue;
    const auto bearer = static_cast<std::size_t>(tree.parent[i]);
    if (tree.axis[bearer] == tree.axis[i]) continue;
    all += 1;
    old += tree.birth_cycle[i] - tree.birth_cycle[bearer] >= 3;
  }
  return old / all;
}
// Internodes within 0.8 m of the stem's line, between 2 and 4 m up.
double interior_wood(const IgmGrowth& growth) {
  double inside = 0;
  for (const Vec3& end : growth.tree.end)
    inside += end.z() > 2 && end.z() < 4 && std::hypot(end.x(), end.y()) < 0.8;
  return inside;
}

// 4.2: above one half the axis is favoured. (Table 3 says the reverse.)
TEST(IgmEffects, higher_lambda_gives_fewer_and_weaker_laterals) {
  const Trees trees("standard", 12, "lambda", {0.45, 0.55});
  EXPECT_LT(trees.effects("laterals per stem internode", laterals_per_stem_internode)[0], -1.5);
  EXPECT_LT(trees.effects("internodes of a lateral", internodes_of_a_lateral)[0], -1.5);
  EXPECT_LT(trees.effects("branch over stem volume", branch_over_stem_volume)[0], -1.5);
}

// Fig. 3c, d. Density, not size: beyond k = 0.5 the same resource goes to more and shorter shoots, and the
// tree stays smaller.
TEST(IgmEffects, higher_k_is_denser) {
  for (const char* preset : {"standard", "table2-06"}) {
    const Trees trees(preset, 12, "k", {0.35, 0.5, 0.8});
    for (const double d : trees.effects(preset, internodes_per_crown_volume)) EXPECT_GT(d, 0.7) << preset;
  }
}

// A threshold of light below which branches are shed. (Table 3 says the reverse.)
TEST(IgmEffects, a_higher_shedding_ratio_is_sparser) {
  const Trees trees("standard", 12, "shed_ratio", {0.2, 0.35, 0.5});
  for (const double d : trees.effects("internodes", wood)) EXPECT_LT(d, -1);
  for (const double d : trees.effects("density", internodes_per_crown_volume)) EXPECT_LT(d, -0.5);
}

// Fig. 2a.
TEST(IgmEffects, a_higher_light_conversion_rate_gives_more_and_thicker_wood) {
  const Trees trees("table2-06", 12, "alpha", {5, 10});
  EXPECT_GT(trees.effects("internodes", wood)[0], 2);
  EXPECT_GT(trees.effects("base radius", base_radius)[0], 2);
}

// Fig. 2b and 4.1: younger nodes are the more likely to sprout.
TEST(IgmEffects, ageing_of_light_sensitivity_moves_sprouting_to_young_wood) {
  const Trees trees("table2-11", 15, "sigma", {0, 1});
  EXPECT_LT(trees.effects("branches from old wood", branches_from_old_wood)[0], -1.5);
}

// Fig. 17: against shade held at its lightest and light sensitivity that does not age.
TEST(IgmEffects, ageing_and_lightening_shade_bare_the_interior) {
  for (const char* preset : {"standard", "table2-11"}) {
    IgmParameters changing = igm_preset(preset).parameters;
    changing.cycles = 15;
    IgmParameters constant = changing;
    constant.sigma = 0;
    constant.b_min = constant.b_max;
    const double d = effect(sample(grow_seeds(constant, kSeeds / 2), interior_wood),
                            sample(grow_seeds(changing, kSeeds / 2), interior_wood));
    RecordProperty(preset, std::to_string(d));
    EXPECT_LT(d, -2) << preset;
  }
}

TEST(IgmEffects, the_equation_holds_the_height_though_cycles_go_on) {
  IgmParameters p = igm_preset("standard").parameters;
  p.cycles = 60;
  for (const IgmGrowth& growth : grow_seeds(p, 4)) {
    EXPECT_LE(growth.last_cycle, 20);
    EXPECT_LT(growth.series.back().cycle, 25);
    EXPECT_NEAR(growth.series.back().height_m, at_cycle(growth, 19).height_m, 0.05);
    EXPECT_LT(growth.series.back().height_m, 100 * p.rho_m);
  }
}

}  // namespace
}  // namespace dendrofit
