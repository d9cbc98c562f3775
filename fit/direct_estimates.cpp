// SPDX-License-Identifier: GPL-3.0-or-later
#include "fit/direct_estimates.h"

#include "core/errors.h"
#include "core/metrics.h"
#include "core/tree_topology.h"
#include "fit/descriptor_input.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace dendrofit {
namespace {

constexpr int kFewestForks = 10;
constexpr int kFewestBranches = 5;
constexpr double kFewestInternodes = 55;

}  // namespace

double scale_for(double height_m) {
  constexpr std::array<double, 14> kSeries = {1,    0.7,  0.5,  0.3,  0.2,   0.15, 0.1,
                                              0.07, 0.05, 0.03, 0.02, 0.015, 0.01, 0.007};
  for (const double rho : kSeries)
    if (height_m / rho >= kFewestInternodes) return rho;
  return kSeries.back();
}

DirectEstimates estimate_directly(const Tree& observed, std::optional<double> internode_length_m) {
  Tree tree = observed;
  assign_axes_by_thickness(tree);
  const TreeMetrics metrics = measure(tree);
  DirectEstimates direct;
  direct.height_m = metrics.height_m;
  direct.dbh_m = metrics.dbh_m;
  direct.total_volume_m3 = metrics.total_volume_m3;
  direct.crown_diameter_m = metrics.crown_diameter_m;
  direct.reference_radius_m = reference_radius(tree);
  direct.internode_length_m = internode_length_m.value_or(scale_for(metrics.height_m));
  require(std::isfinite(direct.internode_length_m) && direct.internode_length_m > 0, "internode_length_m",
          direct.internode_length_m, "must be positive");
  direct.size_internodes = direct.height_m / direct.internode_length_m;

  const std::vector<double> exponents = fork_exponents(tree);
  direct.forks = static_cast<int>(exponents.size());
  if (direct.forks >= kFewestForks)
    direct.pipe_exponent = std::clamp(exponents[exponents.size() / 2], 1.8, 3.5);

  const DescriptorInput in = analyse(tree, {});
  direct.branches = branch_count(in, 1);
  if (direct.branches < kFewestBranches) return direct;
  const auto middle = static_cast<std::size_t>(direct.branches / 2);
  direct.branch_angle_deg =
      over_branches(in, 1, [&](const Axis& a) { return insertion_angle(in, a); })[middle];
  direct.bend_deg = over_branches(
      in, 1, [&](const Axis& a) { return elevation(in, a, 0.5, 1) - elevation(in, a, 0, 0.5); })[middle];
  return direct;
}

}  // namespace dendrofit
