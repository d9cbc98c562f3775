// SPDX-License-Identifier: GPL-3.0-or-later
// Parameter sets in, descriptors of the trees they grow out: what the fit evaluates.
#pragma once

#include "core/progress.h"
#include "fit/descriptors.h"
#include "fit/direct_estimates.h"
#include "fit/search_space.h"
#include "fit/simulation_log.h"

#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include <Eigen/Core>

namespace dendrofit {

/// A tree regrown under `parameters`, its axes laid by thickness as those of a scanned tree, its radii scaled
/// through the tip radius so that its diameter is the observed one as far as tip radii of 0.003 to 0.06
/// internode lengths allow: at 1.3 m, or at a tenth of the height where either tree is lower than that.
struct Regrown {
  Tree tree;
  double tip_radius_m = 0;
};
Regrown regrow(const IgmParameters& parameters, const DirectEstimates& observed, std::uint64_t seed,
               Progress& progress);

/// Stem diameters of a grown tree and the observed one at the same height: at 1.3 m, or at a tenth of each
/// tree's height where either is lower than that.
struct ComparedDiameters {
  double grown = 0, observed = 0;
};
ComparedDiameters compared_diameters(const Tree& grown, const DirectEstimates& observed);

/// The wanted tip radius as far as regrow() allows it.
double possible_tip_radius(double wanted_m, double internode_length_m);

/// What an observer makes of a grown tree (a virtual scan and its reconstruction); the seed is the growth's.
using ObserveTree = std::function<Tree(const Tree& grown, std::uint64_t seed)>;

/// Everything a simulation depends on besides the point and its key.
struct SimulationSetting {
  DirectEstimates observed;
  DescribeOptions comparison;
  ObserveTree observe;                    ///< none: trees are compared as grown
  std::optional<double> thinnest_wood_m;  ///< thinner wood is dropped before trees are compared
  std::uint64_t seed = 1;
  int threads = 0;
};

/// The part of a grown tree that the observed one shows, as far as `setting.thinnest_wood_m` tells.
Tree as_observed(const Tree& grown, const SimulationSetting& setting);

/// Descriptors of a grown tree as `setting` lets it be seen; NaN all where the observer finds none.
std::vector<double> describe_as_observed(const Tree& grown, double internode_length_m,
                                         const SimulationSetting& setting, std::uint64_t seed);

/// Descriptors of `seeds` trees for each point of the unit box, one row a simulation (NaN where a tree lacks
/// something, or where `observe` finds none), point after point. Simulation s of point p is keyed (seed,
/// first_key + p, s); those that `log` knows are taken from it, the others added.
Eigen::MatrixXd simulate(const std::vector<Eigen::VectorXd>& points, const SearchSpace& space,
                         const SimulationSetting& setting, int seeds, std::uint64_t first_key,
                         SimulationLog& log, Progress& progress);

/// The seed that simulation s of the point with this key grows under.
std::uint64_t simulation_seed(std::uint64_t seed, std::uint64_t key, int s);

}  // namespace dendrofit
