// SPDX-License-Identifier: GPL-3.0-or-later
// What the points about each place of a limb tell of its centre and thickness.
#pragma once

#include "core/progress.h"
#include "core/types.h"
#include "recon/cylinder_fit.h"
#include "recon/skeleton.h"

#include <cstddef>
#include <vector>

namespace dendrofit {

/// Where points' middle lies and how far from it they are.
struct Spread {
  Eigen::Vector2d middle{0, 0};
  double square = 0;  ///< mean squared distance from the middle, corrected for the middle being their own;
                      ///< without points beyond several medians, because side twigs cross every view
  std::size_t count = 0;  ///< of points; 0: too few to say anything
};

/// One place seen along its centre line.
struct Sight {
  Spread spread;
  CircleFit circle;            ///< ok only where it is a sound description of the points
  Vec3 centre = Vec3::Zero();  ///< in space
  double centre_se = 0;        ///< metres; infinite where nothing was seen
};

using Sights = std::vector<std::vector<Sight>>;  // by limb, by node

struct SightOptions {
  double noise_m = 0.005;  ///< spread of points about wood, one standard deviation
  int threads = 0;
};

/// Looks at every place through a window along the limb that grows until enough points are seen.
Sights look_at_limbs(const std::vector<Vec3>& points, const std::vector<Limb>& limbs,
                     const SightOptions& options, Progress& = no_progress());

/// The same at the limbs with wanted[l] != 0 alone; the others have no sights.
Sights look_at_some_limbs(const std::vector<Vec3>& points, const std::vector<Limb>& limbs,
                          const std::vector<char>& wanted, const SightOptions& options,
                          Progress& = no_progress());

/// Moves the centre lines to what was seen, evening them with weights by how sure each place is, and takes
/// the rough radii from there. Tips and limbs without sights stay.
void centre_limbs(std::vector<Limb>& limbs, const Sights& sights, const SightOptions& options);

}  // namespace dendrofit
