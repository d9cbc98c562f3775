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

}  // namespace

ComparedDiameters compared_diameters(const Tree& grown, const DirectEstimates& observed) {
  if (observed.dbh_m)
    if (const auto dbh = stem_diameter(grown, 1.3)) return {*dbh, *observed.dbh_m};
  return {2 * reference_radius(grown), 2 * observed.reference_radius_m};
}

double possible_tip_radius(double wanted_m, double internode_length_m) {
  return std::clamp(wanted_m, kThinnestTip * internode_length_m, kThickestTip * internode_length_m);
}

std::vector<double> describe_as_observed(const Tree& grown, double internode_length_m,
                                         const SimulationSetting& setting, std::uint64_t seed) {
  DescribeOptions comparison = setting.comparison;
  comparison.internode_length_m = internode_length_m;
  if (!setting.observe) return describe(as_observed(grown, setting), comparison);
  try {
    return describe(setting.observe(grown, seed), comparison);
  } catch (const SolverError&) {  // the observer finds no tree: nothing to compare
    return std::vector<double>(descriptor_table().size(), std::numeric_limits<double>::quiet_NaN());
  }
}

Tree as_observed(const Tree& grown, const SimulationSetting& setting) {
  return setting.thinnest_wood_m ? without_thin_wood(grown, *setting.thinnest_wood_m) : grown;
}

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
  const ComparedDiameters diameters = compared_diameters(grown.tree, observed);
  grown.tip_radius_m =
      possible_tip_radius(parameters.tip_radius_m * diameters.observed / diameters.grown, parameters.rho_m);
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
    if (rows[i].empty()) {
      const IgmParameters parameters = space.at(points[i / per_point]);
      const Tree tree = regrow(parameters, setting.observed, keys[i], no_progress()).tree;
      rows[i] = describe_as_observed(tree, parameters.rho_m, setting, keys[i]);
    }
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
