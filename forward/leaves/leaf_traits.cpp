// SPDX-License-Identifier: GPL-3.0-or-later
#include "forward/leaves/leaf_traits.h"

#include "core/errors.h"
#include "core/parameters.h"
#include "forward/leaves/leaf_shapes.h"

#include <algorithm>
#include <cmath>
#include <functional>

namespace dendrofit {
namespace {

// Blade and petiole sizes are the usual ranges of European and North American floras (Stace 2019, New Flora
// of the British Isles; Flora of North America). Inclinations of broadleaves: Pisek et al. 2013 (Agric. For.
// Meteorol. 169: 186-194), who find planophile and plagiophile crowns and no spherical ones. Leaf area index:
// the order of Asner et al. 2003 (Global Ecol. Biogeogr. 12: 191-205) for temperate forests.
constexpr const char* kFloras = "sizes: Stace 2019; inclination: Pisek et al. 2013; LAI: Asner et al. 2003";

LengthLaw cut_normal(double mean, double sd) {
  return {LengthLaw::Kind::normal, mean, sd, std::max(0.4 * mean, mean - 2 * sd), mean + 2 * sd};
}

LeafTraits broadleaf() {
  LeafTraits t;
  t.name = "broadleaf";
  t.source = kFloras;
  t.shapes = {{simple_leaf(0.62, 0.4), 1}};
  t.length = cut_normal(0.08, 0.015);
  return t;
}

LeafTraits beech() {
  LeafTraits t = broadleaf();
  t.shapes = {{simple_leaf(0.64, 0.45, {12, 0}), 1}};
  t.length = cut_normal(0.075, 0.012);
  t.petiole_min_m = 0.006;
  t.petiole_max_m = 0.014;
  t.phyllotaxis = {1, 180, 8, true};
  t.usual_lai = 5;
  return t;
}

LeafTraits oak() {
  LeafTraits t = broadleaf();
  t.shapes = {{lobed_leaf(0.62, 4, {12, 0}), 1}};
  t.length = cut_normal(0.10, 0.018);
  t.petiole_min_m = 0.004;
  t.petiole_max_m = 0.01;
  t.inclination = inclination_law("plagiophile");
  t.phyllotaxis = {1, 144, 12, false};
  return t;
}

LeafTraits maple() {
  LeafTraits t = broadleaf();
  t.shapes = {{palmately_lobed_leaf(0.95, 5, {8, 0}), 1}};
  t.length = cut_normal(0.09, 0.02);
  t.petiole_min_m = 0.04;
  t.petiole_max_m = 0.10;
  t.phyllotaxis = {2, 90, 6, false};
  t.usual_lai = 5;
  return t;
}

LeafTraits birch() {
  LeafTraits t = broadleaf();
  t.shapes = {{simple_leaf(0.75, 0.3, {10, 0}), 1}};
  t.length = cut_normal(0.045, 0.008);
  t.petiole_min_m = 0.012;
  t.petiole_max_m = 0.022;
  t.petiole_rise = 0;
  t.inclination = inclination_law("plagiophile");
  t.bearing.twig_radius_m = 0.003;
  t.usual_lai = 3;
  return t;
}

LeafTraits lime() {
  LeafTraits t = broadleaf();
  t.shapes = {{simple_leaf(0.9, 0.36, {8, 25}), 1}};
  t.length = cut_normal(0.07, 0.012);
  t.petiole_min_m = 0.025;
  t.petiole_max_m = 0.045;
  t.phyllotaxis = {1, 180, 8, true};
  return t;
}

LeafTraits ash() {
  LeafTraits t = broadleaf();
  t.shapes = {{pinnate_leaf(5, 0.30, 0.095), 1}};
  t.length = cut_normal(0.25, 0.035);
  t.petiole_min_m = 0.03;
  t.petiole_max_m = 0.06;
  t.phyllotaxis = {2, 90, 6, false};
  t.bearing.twig_radius_m = 0.006;
  return t;
}

LeafTraits horse_chestnut() {
  LeafTraits t = broadleaf();
  t.shapes = {{palmate_leaf(7, 0.26), 1}};
  t.length = cut_normal(0.17, 0.03);
  t.petiole_min_m = 0.07;
  t.petiole_max_m = 0.16;
  t.phyllotaxis = {2, 90, 6, false};
  t.bearing.twig_radius_m = 0.007;
  return t;
}

LeafTraits conifer(const char* source) {
  LeafTraits t = broadleaf();
  t.source = source;
  t.inclination = inclination_law("spherical");
  t.azimuth.kind = AzimuthLaw::Kind::uniform;
  t.petiole_min_m = 0.0015;
  t.petiole_max_m = 0.003;
  t.petiole_rise = 0.15;
  return t;
}

LeafTraits pine() {
  LeafTraits t = conifer(
      "needle pairs 4-7 cm in tufts: Stace 2019; area is that of the flat needles (projected), not half of "
      "all faces");
  t.shapes = {{needle_bundle(10, 0.03, 60), 1}};
  t.length = cut_normal(0.055, 0.008);
  t.insertion_deg = 45;
  t.bearing = {0.006, 0.02, 0.5, 0.03};
  t.usual_lai = 2.5;
  t.most_per_metre_m2 = 0.03;
  return t;
}

LeafTraits spruce() {
  LeafTraits t = conifer(
      "needles 1-2.5 cm on side shoots: Stace 2019; area is that of the flat needles (projected), not half "
      "of all faces");
  t.shapes = {{needle_shoot(28, 0.24, 0.024), 1}};
  t.length = cut_normal(0.08, 0.015);
  t.insertion_deg = 55;
  t.phyllotaxis = {2, 180, 15, true};
  t.petiole_rise = 0;
  t.bearing = {0.005, 0.02, 1.0, 0.1};
  t.usual_lai = 5;
  t.most_per_metre_m2 = 0.04;
  return t;
}

LeafTraits larch() {
  LeafTraits t = conifer(
      "tufts of 20-40 needles 1.5-3 cm on short shoots: Stace 2019; area is that of the flat needles "
      "(projected)");
  t.shapes = {{needle_bundle(20, 0.04, 70), 1}};
  t.length = cut_normal(0.025, 0.004);
  t.insertion_deg = 80;
  t.bearing = {0.005, 0.02, 1.0, 0.1};
  t.usual_lai = 3;
  t.most_per_metre_m2 = 0.012;
  return t;
}

LeafTraits dogwood() {
  LeafTraits t = broadleaf();
  t.source =
      "leaves 0.6, flowers 0.4: the template of TREE-MAKER (Neighbors & Hodges); sizes: Flora of North "
      "America";
  LeafShape blossom = flower(4);
  blossom.petiole_width = 0.05;
  t.shapes = {{simple_leaf(0.55, 0.42, {15, 20}), 0.6}, {blossom, 0.4}};
  t.length = cut_normal(0.07, 0.012);
  t.petiole_min_m = 0.01;
  t.petiole_max_m = 0.02;
  t.phyllotaxis = {2, 90, 8, false};
  return t;
}

struct Preset {
  std::string_view word;
  LeafTraits (*make)();
};

constexpr Preset kPresets[] = {
    {"broadleaf", broadleaf}, {"beech", beech},   {"oak", oak},     {"maple", maple},
    {"birch", birch},         {"lime", lime},     {"ash", ash},     {"horse-chestnut", horse_chestnut},
    {"pine", pine},           {"spruce", spruce}, {"larch", larch}, {"dogwood", dogwood}};

}  // namespace

void LengthLaw::validate() const {
  require(std::isfinite(min_m) && min_m > 0, "length.min_m", min_m, "must be positive");
  require(std::isfinite(max_m) && max_m >= min_m && max_m <= 5, "length.max_m", max_m, "from min_m to 5 m");
  require(std::isfinite(mean_m) && mean_m >= min_m && mean_m <= max_m, "length.mean_m", mean_m,
          "between min_m and max_m");
  if (kind == Kind::normal || kind == Kind::lognormal)
    require(std::isfinite(sd_m) && sd_m > 0, "length.sd_m", sd_m, "must be positive");
}

double LengthLaw::density(double x) const {
  if (x < min_m || x > max_m) return 0;
  if (kind == Kind::uniform) return 1;
  if (kind == Kind::normal) return std::exp(-0.5 * (x - mean_m) * (x - mean_m) / (sd_m * sd_m));
  if (kind == Kind::lognormal) {
    const double spread = std::log(1 + sd_m * sd_m / (mean_m * mean_m));
    const double z = std::log(x) - std::log(mean_m) + 0.5 * spread;
    return std::exp(-0.5 * z * z / spread) / x;
  }
  return 0;
}

void AzimuthLaw::validate() const {
  require(std::isfinite(mean_deg), "azimuth.mean_deg", mean_deg, "must be finite");
  require(concentration >= 0 && concentration <= 500, "azimuth.concentration", concentration, "0 to 500");
}

void Phyllotaxis::validate() const {
  require(leaves_per_node >= 1 && leaves_per_node <= 60, "leaves_per_node", leaves_per_node, "1 to 60");
  require(std::isfinite(divergence_deg), "divergence_deg", divergence_deg, "must be finite");
  require(jitter_deg >= 0 && jitter_deg <= 180, "jitter_deg", jitter_deg, "0 to 180");
}

void Bearing::validate() const {
  require(twig_radius_m > 0, "twig_radius_m", twig_radius_m, "must be positive");
  require(max_radius_m >= twig_radius_m, "max_radius_m", max_radius_m, "at least twig_radius_m");
  require(full_tip_distance_m > 0, "full_tip_distance_m", full_tip_distance_m, "must be positive");
  require(bare_share >= 0 && bare_share <= 1, "bare_share", bare_share, "0 to 1");
}

void LeafTraits::validate() const {
  require(!shapes.empty(), "leaf shapes", 0, "at least one");
  for (const LeafShapeShare& s : shapes) {
    s.shape.validate();
    require(std::isfinite(s.share) && s.share > 0, "share of leaf shape '" + s.shape.name + "'", s.share,
            "must be positive");
  }
  length.validate();
  require(petiole_min_m >= 0, "petiole_min_m", petiole_min_m, "must not be negative");
  require(petiole_max_m >= petiole_min_m && petiole_max_m <= 2, "petiole_max_m", petiole_max_m,
          "from petiole_min_m to 2 m");
  require(insertion_deg >= 0 && insertion_deg <= 180, "insertion_deg", insertion_deg, "0 to 180");
  require(insertion_sd_deg >= 0 && insertion_sd_deg <= 90, "insertion_sd_deg", insertion_sd_deg, "0 to 90");
  require(petiole_rise >= 0 && petiole_rise <= 1, "petiole_rise", petiole_rise, "0 to 1");
  inclination.validate("inclination");
  azimuth.validate();
  phyllotaxis.validate();
  bearing.validate();
  require(usual_lai > 0, "usual_lai", usual_lai, "must be positive");
  require(most_per_metre_m2 > 0, "most_per_metre_m2", most_per_metre_m2, "must be positive");
}

double LeafTraits::mean_leaf_area_m2() const {
  double area = 0, shares = 0;
  for (const LeafShapeShare& s : shapes) {
    area += s.share * s.shape.unit_area();
    shares += s.share;
  }
  double squared = length.mean_m * length.mean_m;
  if (length.kind != LengthLaw::Kind::constant && length.max_m > length.min_m) {
    // E[length^2] by the midpoint rule.
    double total = 0, sum = 0;
    for (int k = 0; k < 2000; ++k) {
      const double x = length.min_m + (length.max_m - length.min_m) * (k + 0.5) / 2000;
      total += length.density(x);
      sum += length.density(x) * x * x;
    }
    squared = sum / total;
  }
  return area / shares * squared;
}

LeafTraits leaf_traits(std::string_view species) {
  for (const Preset& preset : kPresets)
    if (preset.word == species) {
      LeafTraits traits = preset.make();
      traits.name = species;
      return traits;
    }
  throw InputError("species '" + std::string(species) + "' has no leaf preset; did you mean '" +
                   nearest_word(species, leaf_species()) + "'?");
}

std::vector<std::string> leaf_species() {
  std::vector<std::string> words;
  for (const Preset& preset : kPresets) words.emplace_back(preset.word);
  return words;
}

}  // namespace dendrofit
