// SPDX-License-Identifier: GPL-3.0-or-later
// Parameter sets in, descriptors of the trees they grow out: what the fit evaluates.
#pragma once

#include "core/progress.h"
#include "fit/descriptors.h"
#include "fit/search_space.h"

#include <cstdint>
#include <vector>

#include <Eigen/Core>

namespace dendrofit {

/// A tree regrown under `parameters`, its radii scaled through the tip radius so that its diameter (at 1.3 m,
/// else at the foot) is the observed one as far as tip radii of 0.005 to 0.06 internode lengths allow.
struct Regrown {
  Tree tree;
  double tip_radius_m = 0;
};
Regrown regrow(const IgmParameters& parameters, const DirectEstimates& observed, std::uint64_t seed,
               Progress& progress);

/// Descriptors of `seeds` trees for each point of the unit box, one row a simulation (NaN where a tree lacks
/// something), point after point. Simulation s of point p is keyed (seed, first_key + p, s).
Eigen::MatrixXd simulate(const std::vector<Eigen::VectorXd>& points, const SearchSpace& space,
                         const DirectEstimates& observed, const DescribeOptions& comparison, int seeds,
                         std::uint64_t seed, std::uint64_t first_key, int threads, Progress& progress);

/// The seed that simulation s of the point with this key grows under.
std::uint64_t simulation_seed(std::uint64_t seed, std::uint64_t key, int s);

}  // namespace dendrofit
