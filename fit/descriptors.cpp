// SPDX-License-Identifier: GPL-3.0-or-later
#include "fit/descriptors.h"

#include "core/errors.h"
#include "core/metrics.h"
#include "fit/descriptor_input.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <set>
#include <string>

namespace dendrofit {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
constexpr int kSectors = 12;  // of azimuth

using In = const DescriptorInput&;

double log_or_none(double value) {
  return value > 0 ? std::log(value) : kNone;
}

double mean(const std::vector<double>& values) {
  if (values.empty()) return kNone;
  double sum = 0;
  for (const double v : values) sum += v;
  return sum / static_cast<double>(values.size());
}

double deviation(const std::vector<double>& values) {
  if (values.size() < 3) return kNone;
  const double centre = mean(values);
  double square = 0;
  for (const double v : values) square += (v - centre) * (v - centre);
  return std::sqrt(square / static_cast<double>(values.size()));
}

/// Of rising values.
double quantile(const std::vector<double>& values, double share) {
  if (values.empty()) return kNone;
  const double at = share * static_cast<double>(values.size() - 1);
  const auto i = static_cast<std::size_t>(at);
  const double next = values[std::min(i + 1, values.size() - 1)];
  return values[i] + (at - static_cast<double>(i)) * (next - values[i]);
}

/// Share of the wood volume below `share` of the height.
double volume_below(In in, double share) {
  double below = 0;
  for (const auto& [z, volume] : in.volume_by_height) {
    if (z > share * in.height) break;
    below += volume;
  }
  return in.total_volume > 0 ? below / in.total_volume : kNone;
}

/// 90th percentile of the horizontal reach within a tenth of the height about `centre` (relative), over the
/// height.
double reach_at(In in, double centre) {
  std::vector<double> band;
  for (const Vec3& p : in.samples)
    if (std::abs(p.z() / in.height - centre) <= 0.1) band.push_back(p.head<2>().norm());
  if (band.empty()) return std::log(0.02);
  std::sort(band.begin(), band.end());
  return std::log(quantile(band, 0.9) / in.height + 0.02);
}

/// Reach by azimuth: standard deviation of the sectors' 90th percentiles over their mean.
double reach_unevenness(In in) {
  std::array<std::vector<double>, kSectors> sectors;
  for (const Vec3& p : in.samples) {
    const double turn = std::atan2(p.y(), p.x()) / (2 * std::numbers::pi) + 0.5;
    sectors[static_cast<std::size_t>(std::min(kSectors - 1.0, turn * kSectors))].push_back(
        p.head<2>().norm());
  }
  std::vector<double> reach;
  for (auto& sector : sectors) {
    std::sort(sector.begin(), sector.end());
    reach.push_back(sector.empty() ? 0 : quantile(sector, 0.9));
  }
  return mean(reach) > 0 ? deviation(reach) / mean(reach) : kNone;
}

double taper(In in, double share) {
  const auto d = stem_diameter(in.tree, share * in.height);
  return d ? *d / in.base_diameter : kNone;
}

/// Slope of the number of occupied boxes against the inverse box size, both logarithms, from an eighth to a
/// thirty-second of the height.
double box_slope(In in) {
  const auto boxes = [&](double size) {
    std::set<std::array<int, 3>> occupied;
    for (const Vec3& p : in.samples)
      occupied.insert({static_cast<int>(std::floor(p.x() / size + 0.5)),
                       static_cast<int>(std::floor(p.y() / size + 0.5)),
                       static_cast<int>(std::floor(p.z() / size))});
    return static_cast<double>(occupied.size());
  };
  return std::log(boxes(in.height / 32) / boxes(in.height / 8)) / std::log(4.0);
}

double branches_per_branch(In in, int order) {
  const int parents = branch_count(in, order - 1);
  return parents > 0 ? std::log(1.0 + double(branch_count(in, order)) / parents) : kNone;
}

double branch_length(In in, int order, double share) {
  return log_or_none(quantile(over_branches(in, order, [](const Axis& a) { return a.length; }), share) /
                     in.height);
}

std::vector<double> insertions(In in, int order) {
  return over_branches(in, order, [&](const Axis& a) { return insertion_angle(in, a); });
}

double mean_elevation(In in, int order, double from, double to) {
  return mean(over_branches(in, order, [&](const Axis& a) { return elevation(in, a, from, to); }));
}

std::vector<double> radius_ratios(In in, int order) {
  return over_branches(in, order, [&](const Axis& a) { return radius_ratio(in, a); });
}

double mean_straightness(In in, int order) {
  return mean(over_branches(in, order, [&](const Axis& a) { return straightness(in, a); }));
}

std::vector<double> branch_heights(In in) {
  return over_branches(in, 1, [&](const Axis& a) { return base_height(in, a); });
}

/// Mean length of first-order branches of the upper half of the tree over that of the lower half, logarithm.
double length_gradient(In in) {
  double sum[2] = {0, 0};
  int count[2] = {0, 0};
  for (const Axis& axis : in.axes) {
    if (!is_branch(axis, 1)) continue;
    const int half = base_height(in, axis) > 0.5;
    sum[half] += axis.length;
    ++count[half];
  }
  return count[0] > 0 && count[1] > 0 ? std::log(sum[1] / count[1] / (sum[0] / count[0])) : kNone;
}

double crown_base(In in) {
  const auto base = measure(in.tree).crown_base_m;
  return base ? *base / in.height : kNone;
}

constexpr auto kTable = std::to_array<DescriptorRow>({
    {"internodes", "log", 0.01, true, "height of the highest wood over the internode length",
     [](In in) { return log_or_none(in.height / in.internode_length); }},
    {"slenderness", "log", 0.03, true, "stem diameter at a tenth of the height over the height",
     [](In in) { return log_or_none(in.base_diameter / in.height); }},
    {"volume", "log", 0.18, false, "volume of the visible wood over height times that diameter squared",
     [](In in) { return log_or_none(in.total_volume / (in.height * std::pow(in.base_diameter, 2))); }},
    {"length", "log", 0.25, false, "length of the visible wood over the height",
     [](In in) { return log_or_none(in.total_length / in.height); }},
    {"volume_below_10", "", 0.02, true, "share of wood volume in the lowest tenth",
     [](In in) { return volume_below(in, 0.10); }},
    {"volume_below_25", "", 0.02, true, "share of wood volume in the lowest quarter",
     [](In in) { return volume_below(in, 0.25); }},
    {"volume_below_50", "", 0.02, true, "share of wood volume in the lower half",
     [](In in) { return volume_below(in, 0.50); }},
    {"volume_below_75", "", 0.02, true, "share of wood volume in the lower three quarters",
     [](In in) { return volume_below(in, 0.75); }},
    {"length_centroid", "", 0.03, true, "height of the wood length's centroid over the height",
     [](In in) { return in.length_centroid / in.height; }},
    {"spread", "log", 0.06, false, "mean horizontal distance of the wood's length from the foot",
     [](In in) { return std::log(in.spread / in.height + 0.02); }},
    {"reach_20", "log", 0.08, true, "crown radius about 0.2 of the height, over the height",
     [](In in) { return reach_at(in, 0.2); }},
    {"reach_40", "log", 0.08, true, "crown radius about 0.4 of the height, over the height",
     [](In in) { return reach_at(in, 0.4); }},
    {"reach_60", "log", 0.08, true, "crown radius about 0.6 of the height, over the height",
     [](In in) { return reach_at(in, 0.6); }},
    {"reach_80", "log", 0.08, true, "crown radius about 0.8 of the height, over the height",
     [](In in) { return reach_at(in, 0.8); }},
    {"reach_unevenness", "", 0.05, false, "coefficient of variation of the crown radius over twelve azimuths",
     reach_unevenness},
    {"crown_base", "", 0.03, true, "height of the lowest long branch over the height", crown_base},
    {"taper_30", "", 0.05, true, "stem diameter at 0.3 of the height over that at a tenth",
     [](In in) { return taper(in, 0.30); }},
    {"taper_50", "", 0.05, true, "stem diameter at half the height over that at a tenth",
     [](In in) { return taper(in, 0.50); }},
    {"taper_70", "", 0.06, true, "stem diameter at 0.7 of the height over that at a tenth",
     [](In in) { return taper(in, 0.70); }},
    {"branches_1", "log", 0.15, false, "number of first-order branches (plus one)",
     [](In in) { return std::log(1.0 + branch_count(in, 1)); }},
    {"branches_2_per_1", "log", 0.20, false, "second-order branches per first-order branch (plus one)",
     [](In in) { return branches_per_branch(in, 2); }},
    {"branches_3_per_2", "log", 0.25, false, "third-order branches per second-order branch (plus one)",
     [](In in) { return branches_per_branch(in, 3); }},
    {"branch_height", "", 0.04, false, "mean height at which first-order branches leave, over the height",
     [](In in) { return mean(branch_heights(in)); }},
    {"branch_height_spread", "", 0.03, false,
     "standard deviation of the heights at which first-order branches leave",
     [](In in) { return deviation(branch_heights(in)); }},
    {"branch_length_1_25", "log", 0.12, false, "lower quartile of first-order branch lengths over the height",
     [](In in) { return branch_length(in, 1, 0.25); }},
    {"branch_length_1_50", "log", 0.12, false, "median of first-order branch lengths over the height",
     [](In in) { return branch_length(in, 1, 0.5); }},
    {"branch_length_1_90", "log", 0.12, false, "ninetieth percentile of first-order branch lengths",
     [](In in) { return branch_length(in, 1, 0.9); }},
    {"branch_length_2_50", "log", 0.12, false, "median of second-order branch lengths over the height",
     [](In in) { return branch_length(in, 2, 0.5); }},
    {"branch_length_gradient", "log", 0.15, false,
     "mean length of first-order branches in the upper half over that in the lower half", length_gradient},
    {"insertion_1", "deg", 3, false, "median angle at which first-order branches leave the stem",
     [](In in) { return quantile(insertions(in, 1), 0.5); }},
    {"insertion_spread_1", "deg", 3, false,
     "standard deviation of the angles at which first-order branches leave the stem",
     [](In in) { return deviation(insertions(in, 1)); }},
    {"insertion_2", "deg", 4, false, "median angle at which second-order branches leave theirs",
     [](In in) { return quantile(insertions(in, 2), 0.5); }},
    {"insertion_spread_2", "deg", 4, false,
     "standard deviation of the angles at which second-order branches leave theirs",
     [](In in) { return deviation(insertions(in, 2)); }},
    {"elevation_1", "deg", 3, false, "mean elevation of first-order branches over their first half",
     [](In in) { return mean_elevation(in, 1, 0, 0.5); }},
    {"bend_1", "deg", 4, false,
     "mean elevation over the last half less that over the first: droop is below 0",
     [](In in) { return mean_elevation(in, 1, 0.5, 1) - mean_elevation(in, 1, 0, 0.5); }},
    {"bend_2", "deg", 5, false,
     "bend of second-order branches: mean elevation over their last half less that over the first",
     [](In in) { return mean_elevation(in, 2, 0.5, 1) - mean_elevation(in, 2, 0, 0.5); }},
    {"radius_ratio_1", "", 0.07, false, "median radius of first-order branches over the stem's there",
     [](In in) { return quantile(radius_ratios(in, 1), 0.5); }},
    {"radius_ratio_1_90", "", 0.15, false,
     "ninetieth percentile of the radii of first-order branches over the stem's there",
     [](In in) { return quantile(radius_ratios(in, 1), 0.9); }},
    {"radius_ratio_2", "", 0.10, false, "median radius of second-order branches over their parents' there",
     [](In in) { return quantile(radius_ratios(in, 2), 0.5); }},
    {"straightness_1", "", 0.01, false, "mean chord over length of first-order branches",
     [](In in) { return mean_straightness(in, 1); }},
    {"stem_straightness", "", 0.005, false, "chord over length of the stem",
     [](In in) { return in.axes.empty() ? kNone : straightness(in, in.axes.front()); }},
    {"path_length", "", 0.05, false, "mean length of wood from the foot to a tip, over the height",
     [](In in) { return mean(in.path_lengths) / in.height; }},
    {"path_length_spread", "", 0.04, false,
     "standard deviation of the lengths of wood from the foot to a tip, over the height",
     [](In in) { return deviation(in.path_lengths) / in.height; }},
    {"pipe_exponent", "", 0.8, false, "median exponent v of r^v = sum r_i^v over the forks (ten or more)",
     [](In in) { return in.fork_exponents.size() < 10 ? kNone : quantile(in.fork_exponents, 0.5); }},
    {"box_slope", "", 0.05, false, "growth of occupied boxes from an eighth to a 32nd of the height",
     box_slope},
});

}  // namespace

std::span<const DescriptorRow> descriptor_table() {
  return kTable;
}

std::size_t descriptor_row(std::string_view name) {
  for (std::size_t i = 0; i < kTable.size(); ++i)
    if (kTable[i].name == name) return i;
  throw InputError("no descriptor is called '" + std::string(name) + "'");
}

std::vector<double> describe(const Tree& tree, const DescribeOptions& options) {
  const DescriptorInput in = analyse(tree, options);
  std::vector<double> values;
  values.reserve(kTable.size());
  for (const DescriptorRow& row : kTable) values.push_back(row.compute(in));
  return values;
}

std::vector<double> describe_at_all_levels(const Tree& tree, const DescribeOptions& options) {
  std::vector<double> all;
  DescribeOptions level = options;
  for (const double share : kVisibleShares) {
    level.visible_share = share;
    const std::vector<double> values = describe(tree, level);
    all.insert(all.end(), values.begin(), values.end());
  }
  return all;
}

}  // namespace dendrofit
