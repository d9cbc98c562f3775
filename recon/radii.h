// SPDX-License-Identifier: GPL-3.0-or-later
// How thick the wood is: measured where points suffice, elsewhere from the tree's own proportions.
#pragma once

#include "core/progress.h"
#include "core/types.h"
#include "recon/skeleton.h"

#include <optional>
#include <vector>

namespace dendrofit {

struct RadiusOptions {
  std::optional<double> twig_diameter_m;  ///< of the species' twig ends, where known
  int threads = 0;
  void validate() const;
};

/// The tree's own relation between a place's radius and the wood length beyond it: radius = scale *
/// beyond^exponent.
struct Allometry {
  double scale = 0;
  double exponent = 0.5;
  double tip_radius_m = 0.0015;
  double spread = 0.4;     ///< standard deviation of log radius about it
  std::size_t places = 0;  ///< measured radii it rests on
  double radius_at(double beyond_m) const;
};

struct RadiusReport {
  double noise_m = 0;  ///< spread of points about wood, one standard deviation across the view
  Allometry allometry;
};

/// Fits a circle across every place with enough points about it, moves the centre line there, corrects for
/// the widening by noise and footprint (seen on the thinnest twigs, where it is all there is), fits the
/// allometry to the measured radii, and fills and evens out the rest. Radii fall towards the tips.
RadiusReport measure_radii(const std::vector<Vec3>& points, std::vector<Limb>& limbs, double spacing_m,
                           const RadiusOptions& options = {}, Progress& = no_progress());

}  // namespace dendrofit
