// SPDX-License-Identifier: GPL-3.0-or-later
#include "fit/tree_simulator.h"

#include "core/metrics.h"
#include "core/parallel.h"
#include "core/random.h"
#include "forward/igm/grow.h"

#include <algorithm>

namespace dendrofit {
namespace {

// Tip radii over internode lengths (the authors' program: 0.03). Thicker "tips" would let a tree of a few
// poles pass.
constexpr double kThinnestTip = 0.005;
constexpr double kThickestTip = 0.06;

double thickest_root(const Tree& tree) {
  double radius = 0;
  for (std::size_t i = 0; i < tree.size(); ++i)
    if (tree.parent[i] < 0) radius = std::max(radius, tree.radius[i]);
  return radius;
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
  // Pipe-model radii are proportional to the tip radius, so one growth serves every tip radius.
  double wanted = 2 * observed.base_radius_m;
  double has = 2 * thickest_root(grown.tree);
  if (observed.dbh_m) {
    if (const auto dbh = stem_diameter(grown.tree, 1.3)) {
      wanted = *observed.dbh_m;
      has = *dbh;
    }
  }
  grown.tip_radius_m = std::clamp(parameters.tip_radius_m * wanted / has, kThinnestTip * parameters.rho_m,
                                  kThickestTip * parameters.rho_m);
  const double scale = grown.tip_radius_m / parameters.tip_radius_m;
  for (double& radius : grown.tree.radius) radius *= scale;
  return grown;
}

Eigen::MatrixXd simulate(const std::vector<Eigen::VectorXd>& points, const SearchSpace& space,
                         const DirectEstimates& observed, const DescribeOptions& comparison, int seeds,
                         std::uint64_t seed, std::uint64_t first_key, int threads, Progress& progress) {
  const auto per_point = static_cast<std::size_t>(seeds);
  Eigen::MatrixXd rows(static_cast<Eigen::Index>(points.size() * per_point),
                       static_cast<Eigen::Index>(descriptor_table().size()));
  parallel_blocks(points.size() * per_point, 1, threads, [&](std::size_t first, std::size_t) {
    progress.check();
    const std::size_t p = first / per_point;
    const int s = static_cast<int>(first % per_point);
    const std::uint64_t key = simulation_seed(seed, first_key + p, s);
    const Regrown grown = regrow(space.at(points[p]), observed, key, no_progress());
    const std::vector<double> values = describe(grown.tree, comparison);
    rows.row(static_cast<Eigen::Index>(first)) =
        Eigen::Map<const Eigen::RowVectorXd>(values.data(), static_cast<Eigen::Index>(values.size()));
    progress.advance(1.0 / static_cast<double>(per_point));
  });
  return rows;
}

}  // namespace dendrofit
