// SPDX-License-Identifier: GPL-3.0-or-later
// How thick the wood is: measured where points suffice, elsewhere from the tree's own proportions.
#pragma once

#include "core/types.h"
#include "recon/sights.h"
#include "recon/skeleton.h"

#include <optional>
#include <vector>

namespace dendrofit {

struct RadiusOptions {
  std::optional<double> twig_diameter_m = std::nullopt;  ///< of the species' twig ends, where known
  bool in_leaf = false;                                  ///< leaves left about thin twigs widen them
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

/// The points' spread about wood: from the thinnest twigs, where noise and footprint are nearly all there is,
/// bounded by the scatter about thick wood's circles. `fallback_m` where neither says enough.
double scan_noise(const std::vector<Limb>& limbs, const Sights& sights, double fallback_m,
                  const RadiusOptions& options = {});

/// Corrects what was seen for the widening by noise, fits the allometry, and settles every radius and its
/// quality: measured where the points say more than the allometry, interpolated between such places, else
/// allometric. Radii fall towards the tips, and no limb is thicker than its bearer.
RadiusReport settle_radii(std::vector<Limb>& limbs, const Sights& sights, double noise_m,
                          const RadiusOptions& options = {});

}  // namespace dendrofit
