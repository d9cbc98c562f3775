// SPDX-License-Identifier: GPL-3.0-or-later
#include "fit/tree_simulator.h"

#include "core/errors.h"
#include "core/metrics.h"
#include "core/parallel.h"
#include "core/random.h"
#include "core/tree_topology.h"
#include "forward/igm/grow.h"

#include <algorithm>
#include <limits>

namespace dendrofit {
namespace {

// Tip radii over internode lengths (the authors' program: 0.03). Thicker "tips" would let a tree of a few
// poles pass.
constexpr double kThinnestTip = 0.003;
constexpr double kThickestTip = 0.06;
/// By what the regrown tree's radii must be multiplied.
double diameter_ratio(const Tree& tree, const DirectEstimates& observed) {
  if (observed.dbh_m)
    if (const auto dbh = stem_diameter(tree, 1.3)) return *observed.dbh_m / *dbh;
  return observed.reference_radius_m / reference_radius(tree);
}

std::vector<double> simulated(const IgmParameters& parameters, const SimulationSetting& setting,
                              std::uint64_t key) {
  Tree tree = regrow(parameters, setting.observed, key, no_progress()).tree;
  DescribeOptions comparison = setting.comparison;
  comparison.internode_length_m = parameters.rho_m;
  if (!setting.observe) return describe(tree, comparison);
  try {
    return describe(setting.observe(tree, key), comparison);
  } catch (const SolverError&) {  // the observer finds no tree: nothing to compare
    return std::vector<double>(descriptor_table().size(), std::numeric_limits<double>::quiet_NaN());
  }
}

}  // namespace

std::uint64_t simulation_seed(std::uint64_t seed, std::uint64_t key, int s) {
  return Random(seed).child({key, static_cast<std::uint64_t>(s)}).bits();
}

Regrown regrow(const IgmParameters& parameters, const DirectEstimates& observed, std::uint64_t seed,
               Progress& progress) {
  IgmOptions options;
  options.seed = seed;
  Regrown grown;
  grown.tree = grow_igm(parameters, {}, options, progress).tree;
  // A stem is what is thickest, also where the model's leader died and a branch took over.
  assign_axes_by_thickness(grown.tree);
  // Pipe-model radii are proportional to the tip radius, so one growth serves every tip radius.
  grown.tip_radius_m = std::clamp(parameters.tip_radius_m * diameter_ratio(grown.tree, observed),
                                  kThinnestTip * parameters.rho_m, kThickestTip * parameters.rho_m);
  const double scale = grown.tip_radius_m / parameters.tip_radius_m;
  for (double& radius : grown.tree.radius) radius *= scale;
  return grown;
}

Eigen::MatrixXd simulate(const std::vector<Eigen::VectorXd>& points, const SearchSpace& space,
                         const SimulationSetting& setting, int seeds, std::uint64_t first_key,
                         SimulationLog& log, Progress& progress) {
  const auto per_point = static_cast<std::size_t>(seeds);
  const std::size_t count = points.size() * per_point;
  std::vector<std::vector<double>> rows(count);
  std::vector<std::uint64_t> keys(count);
  for (std::size_t i = 0; i < count; ++i) {
    keys[i] = simulation_seed(setting.seed, first_key + i / per_point, static_cast<int>(i % per_point));
    if (const auto* known = log.find(keys[i])) rows[i] = *known;
  }
  parallel_blocks(count, 1, setting.threads, [&](std::size_t i, std::size_t) {
    progress.check();
    if (rows[i].empty()) rows[i] = simulated(space.at(points[i / per_point]), setting, keys[i]);
    progress.advance(1.0 / static_cast<double>(per_point));
  });
  Eigen::MatrixXd all(static_cast<Eigen::Index>(count), static_cast<Eigen::Index>(descriptor_table().size()));
  for (std::size_t i = 0; i < count; ++i) {
    all.row(static_cast<Eigen::Index>(i)) = Eigen::Map<const Eigen::RowVectorXd>(rows[i].data(), all.cols());
    log.add(keys[i], std::move(rows[i]));
  }
  return all;
}

}  // namespace dendrofit
