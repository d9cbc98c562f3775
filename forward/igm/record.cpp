// SPDX-License-Identifier: GPL-3.0-or-later
#include "forward/igm/record.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace dendrofit::igm {
namespace {

constexpr double kBreastHeight = 1.3;

// Stem diameter at breast height, interpolated between the middles of neighbouring internodes; none where the
// trunk does not reach it.
std::optional<double> trunk_dbh(const std::vector<double>& middle, const std::vector<double>& radius,
                                double top) {
  if (top < kBreastHeight || middle.empty()) return std::nullopt;
  for (std::size_t j = 0; j < middle.size(); ++j) {
    if (middle[j] < kBreastHeight) continue;
    if (j == 0) return 2 * radius[0];
    const double part = (kBreastHeight - middle[j - 1]) / (middle[j] - middle[j - 1]);
    return 2 * (radius[j - 1] + part * (radius[j] - radius[j - 1]));
  }
  return 2 * radius.back();
}

}  // namespace

void record(const Stand& stand, int cycle, const std::vector<std::int64_t>& shed,
            std::vector<GrowthRecord>& series) {
  const std::size_t trees = stand.parameters.size();
  std::vector<GrowthRecord> rows(trees);
  std::vector<double> foot(trees, std::numeric_limits<double>::infinity());
  for (const Plant& plant : stand.plants) {
    double& z = foot[static_cast<std::size_t>(plant.tree)];
    z = std::min(z, plant.root.z());
  }
  std::vector<std::vector<double>> middle(stand.plants.size()), radius(stand.plants.size());
  std::vector<double> top(stand.plants.size(), 0);
  std::vector<int> trunk(stand.plants.size(), 0);
  for (std::size_t i = 0; i < stand.nodes.size(); ++i) {
    const auto axis = static_cast<std::size_t>(stand.nodes.axis[i]);
    const auto plant = static_cast<std::size_t>(stand.axes.plant[axis]);
    const auto tree = static_cast<std::size_t>(stand.plants[plant].tree);
    const IgmParameters& p = stand.parameters[tree];
    GrowthRecord& row = rows[tree];
    const double length = stand.internode(i).norm();
    // r^2 from r^v
    const double square = std::pow(stand.nodes.pipe[i], 2.0 / p.pipe_exponent);
    row.height_m = std::max(row.height_m, stand.nodes.position[i].z() - foot[tree]);
    row.internodes += 1;
    row.living_buds += stand.nodes.laterals[i] == 0 && stand.axes.order[axis] < p.max_order;
    row.light_mean += stand.light(i);
    row.length_m += length;
    row.volume_m3 += std::numbers::pi * square * length;
    if (stand.axes.order[axis] == 1) {
      ++trunk[plant];
      middle[plant].push_back(stand.nodes.position[i].z() - 0.5 * stand.internode(i).z() - foot[tree]);
      radius[plant].push_back(std::sqrt(square));
      top[plant] = std::max(top[plant], stand.nodes.position[i].z() - foot[tree]);
    }
  }
  for (std::size_t axis = 0; axis < stand.axes.size(); ++axis)
    ++rows[static_cast<std::size_t>(stand.tree_of_axis(axis))].axes;
  for (std::size_t plant = 0; plant < stand.plants.size(); ++plant) {
    GrowthRecord& row = rows[static_cast<std::size_t>(stand.plants[plant].tree)];
    row.stem_internodes = std::max(row.stem_internodes, trunk[plant]);
    const auto dbh = trunk_dbh(middle[plant], radius[plant], top[plant]);
    if (dbh && (!row.dbh_m || *dbh > *row.dbh_m)) row.dbh_m = dbh;
  }
  for (std::size_t tree = 0; tree < trees; ++tree) {
    GrowthRecord& row = rows[tree];
    row.cycle = cycle;
    row.tree = static_cast<int>(tree);
    row.shed_internodes = shed[tree];
    if (row.internodes > 0) row.light_mean /= static_cast<double>(row.internodes);
    series.push_back(row);
  }
}

}  // namespace dendrofit::igm
