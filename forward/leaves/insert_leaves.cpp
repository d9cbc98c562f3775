// SPDX-License-Identifier: GPL-3.0-or-later
#include "forward/leaves/insert_leaves.h"

#include "core/errors.h"
#include "forward/leaves/bearing.h"
#include "forward/leaves/candidates.h"
#include "forward/leaves/leaf_drift.h"
#include "forward/leaves/leaf_measures.h"
#include "forward/leaves/placement.h"
#include "forward/leaves/twigs.h"

#include <algorithm>
#include <chrono>
#include <cmath>

namespace dendrofit {
namespace {

/// The target in what it counts: square metres, or leaves.
struct Target {
  bool by_count = false;
  double value = 0;
};

Target resolve_target(const LeafOptions& options, const BearingWood& wood, double mean_area,
                      LeafReport& report) {
  Target target;
  double area = 0;
  if (options.count) {
    target.by_count = true;
    report.target = "count";
    target.value = std::round(static_cast<double>(*options.count) * options.season);
    area = target.value * mean_area;
  } else if (options.area_m2) {
    report.target = "area";
    area = *options.area_m2 * options.season;
  } else if (options.lai) {
    report.target = "lai";
    area = *options.lai * wood.crown_area_m2 * options.season;
  } else {
    report.target = "usual";
    const double full = options.traits.usual_lai * wood.covered_m2;
    const double carried = options.traits.most_per_metre_m2 * wood.length_m;
    area = std::min(full, carried) * options.season;
    if (carried < full)
      report.warnings.push_back(
          "the twigs of this model carry less than the species' usual leaf area: leaf area index " +
          std::to_string(area / wood.crown_area_m2).substr(0, 4));
  }
  if (!target.by_count) target.value = area;
  report.requested_area_m2 = area;
  report.requested_count = static_cast<std::size_t>(std::llround(area / mean_area));
  report.requested_lai = wood.crown_area_m2 > 0 ? area / wood.crown_area_m2 : 0;
  return target;
}

std::string reason_for(const LeafBudgetBin& bin) {
  if (bin.tried == 0) return "no bearing wood";
  const std::size_t most = std::max({bin.refused_by_leaf, bin.refused_by_wood, bin.refused_by_ground});
  if (most == 0) return "left to other heights";
  if (most == bin.refused_by_leaf) return "full: other leaves are in the way";
  return most == bin.refused_by_wood ? "wood is in the way" : "the ground is in the way";
}

void report_bins(const Placement& placement, const BearingWood& wood, double per_unit, LeafReport& report) {
  const std::vector<BinState>& bins = placement.bins();
  const double step = wood.scale[0] / static_cast<double>(bins.size());
  for (std::size_t b = 0; b < bins.size(); ++b) {
    LeafBudgetBin bin;
    bin.from_m = step * static_cast<double>(b);
    bin.to_m = bin.from_m + step;
    bin.requested_m2 = bins[b].wanted * per_unit;
    bin.achieved_m2 = bins[b].area_m2;
    bin.tried = bins[b].tried;
    bin.placed = bins[b].placed;
    bin.refused_by_wood = bins[b].by_wood;
    bin.refused_by_leaf = bins[b].by_leaf;
    bin.refused_by_ground = bins[b].by_ground;
    // Less than one leaf is no shortfall.
    if (bins[b].wanted - bins[b].have > 1.5 * (per_unit == 1 ? placement.mean_area_m2() : 1))
      bin.reason = reason_for(bin);
    report.bins.push_back(bin);
  }
}

void report_shortfall(const Target& target, const Placement& placement, double per_unit, LeafReport& report) {
  const double missing = (target.value - placement.have()) * per_unit;
  if (missing <= placement.mean_area_m2() || report.achieved_area_m2 >= report.requested_area_m2) {
    if (!target.by_count || placement.have() >= target.value) return;
  }
  report.shortfall_m2 = missing;
  const LeafBudgetBin* worst = nullptr;
  for (const LeafBudgetBin& bin : report.bins)
    if (!worst || bin.requested_m2 - bin.achieved_m2 > worst->requested_m2 - worst->achieved_m2) worst = &bin;
  report.shortfall_reason = placement.stopped_because();
  if (worst && !worst->reason.empty()) report.shortfall_reason += "; most of it " + worst->reason;
}

}  // namespace

void LeafOptions::validate() const {
  const int targets = (area_m2 ? 1 : 0) + (count ? 1 : 0) + (lai ? 1 : 0);
  require(targets <= 1, "targets given (area_m2, count, lai)", targets, "at most one");
  if (area_m2) require(std::isfinite(*area_m2) && *area_m2 >= 0, "area_m2", *area_m2, "must not be negative");
  if (lai) require(std::isfinite(*lai) && *lai >= 0, "lai", *lai, "must not be negative");
  if (count) require(*count <= 100'000'000, "count", static_cast<double>(*count), "at most 100 million");
  traits.validate();
  if (profile.height) profile.height->validate("profile.height");
  if (profile.along_axis) profile.along_axis->validate("profile.along_axis");
  if (profile.compass) profile.compass->validate("profile.compass");
  if (profile.radius) profile.radius->validate("profile.radius");
  if (profile.order) profile.order->validate("profile.order");
  if (profile.tip_distance) profile.tip_distance->validate("profile.tip_distance");
  if (measured) measured->validate();
  require(measured_reach_m > 0, "measured_reach_m", measured_reach_m, "must be positive");
  require(clearance_m >= 1e-4 && clearance_m <= 0.1, "clearance_m", clearance_m, "0.0001 to 0.1 m");
  if (ground_z_m) require(std::isfinite(*ground_z_m), "ground_z_m", *ground_z_m, "must be finite");
  require(season >= 0 && season <= 1, "season", season, "0 to 1");
  require(threads >= 0, "threads", threads, "must not be negative");
}

namespace {

/// Leaf area a metre of added twig is to carry, as a share of the most it could.
constexpr double kTwigLoad = 0.4;

/// The shoots a coarse model needs for what it is asked to carry; none where its own wood will do.
TwigGrowth missing_twigs(const Tree& tree, const BearingWood& wood, const LeafOptions& options,
                         double mean_area) {
  // Foliage hides the twigs of a tree scanned in leaf.
  if (!options.complete_twigs || !(wood.coarse || options.measured)) return {};
  LeafReport ignored;
  Target target = resolve_target(options, wood, mean_area, ignored);
  double area = target.by_count ? target.value * mean_area : target.value;
  if (ignored.target == "usual") area = options.traits.usual_lai * wood.covered_m2 * options.season;
  const double per_metre = options.traits.most_per_metre_m2;
  if (area <= per_metre * wood.length_m) return {};
  return grow_twigs(tree, wood, area / (kTwigLoad * per_metre), options.seed);
}

LeafResult insert_on(const Tree& tree, const LeafOptions& options, const BearingWood& wood,
                     Progress& progress) {
  LeafResult result;
  LeafReport& report = result.report;
  report.seed = options.seed;
  report.clearance_m = options.clearance_m;
  report.source = options.traits.source;
  result.foliage.origin_shift = tree.origin_shift;
  result.foliage.species = options.traits.name;
  for (const LeafShapeShare& s : options.traits.shapes) result.foliage.shapes.push_back(s.shape);
  report.warnings = wood.warnings;
  report.bearing_length_m = wood.length_m;
  report.bearing_radius_m = wood.radius_m;
  report.crown_area_m2 = wood.crown_area_m2;
  if (wood.unreachable > 0.01)
    report.warnings.push_back(
        std::to_string(std::lround(100 * wood.unreachable)) +
        " % of a requested leaf profile lies where the tree has no bearing wood; the rest is "
        "scaled up");

  const CandidateSource source(tree, options, wood);
  const Target target = resolve_target(options, wood, source.mean_area_m2(), report);
  Placement placement(tree, options, wood, source, target.by_count);
  placement.fill(target.value, progress);

  LeafDrift drift(wood, source, options);
  drift.add_candidates(placement.first_candidates());
  result.foliage.leaves = placement.take_leaves(drift);

  measure_foliage(result.foliage, wood.foot_z, options.threads, report);
  report.distributions = drift.report(result.foliage);
  report.candidates = placement.counters().candidates;
  report.poses = placement.counters().poses;
  report.leaf_pair_tests = placement.counters().leaf_pairs;
  report.wood_tests = placement.counters().wood;
  report.rounds = placement.rounds();
  const double per_unit = target.by_count ? source.mean_area_m2() : 1;
  report_bins(placement, wood, per_unit, report);
  report_shortfall(target, placement, per_unit, report);
  return result;
}

}  // namespace

LeafResult insert_leaves(const Tree& tree, const LeafOptions& options, Progress& progress) {
  const auto started = std::chrono::steady_clock::now();
  options.validate();
  tree.validate();
  if (tree.empty()) throw InputError("leaves: the tree has no cylinder");
  const BearingWood wood = find_bearing_wood(tree, options);
  TwigGrowth growth = missing_twigs(tree, wood, options, options.traits.mean_leaf_area_m2());
  LeafResult result;
  if (growth.twigs.empty()) {
    result = insert_on(tree, options, wood, progress);
  } else {
    const Tree completed = with_twigs(tree, growth);
    result = insert_on(completed, options, find_bearing_wood(completed, options), progress);
    for (Leaf& leaf : result.foliage.leaves)
      if (const auto node = static_cast<std::size_t>(leaf.node); node >= tree.size())
        leaf.node = growth.bearer[node - tree.size()];
    for (std::size_t i = 0; i < growth.twigs.size(); ++i)
      result.report.added_twigs_m += growth.twigs.length(i);
    result.report.warnings.push_back(
        std::string(wood.coarse ? "the model ends coarser than twigs: "
                                : "the model has too few twigs for its leaves, as scans in leaf do: ") +
        std::to_string(std::lround(result.report.added_twigs_m)) +
        " m of leafy shoots were added to its outer wood");
    result.foliage.twigs = std::move(growth.twigs);
  }
  result.report.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - started).count();
  return result;
}

}  // namespace dendrofit
