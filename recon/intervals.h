// SPDX-License-Identifier: GPL-3.0-or-later
// The diameter at breast height from its own slice, and how far the tree's measures can be trusted.
#pragma once

#include "core/metrics.h"
#include "core/types.h"
#include "recon/ellipse_fit.h"
#include "recon/skeleton.h"

#include <optional>
#include <vector>

namespace dendrofit {

/// A circle through the points about one height of a stem.
struct SliceDiameter {
  double diameter_m = 0;
  double se_m = 0;
  double coverage = 0;   ///< share of the circle's sectors that hold points
  double scatter_m = 0;  ///< of the diameters of five slices about that height, off their line (0: too few)
  std::optional<EllipseFit> ellipse = std::nullopt;  ///< where the stem is seen nearly all round
};

/// Robust circle through the stem's points within 10 cm (sparse scans: up to 30 cm) of height z (local), seen
/// along the stem and corrected for noise. Of several stems the thickest. None where the points show no
/// circle.
std::optional<SliceDiameter> slice_diameter(const std::vector<Vec3>& points, const std::vector<Limb>& limbs,
                                            double z, double noise_m);

/// For models without a scan's points (photographs): 95 % intervals for dbh_m, height_m, stem_volume_m3 and
/// total_volume_m3 in metrics.intervals; for scans see scan_intervals.h. Radii err
/// together (noise correction, bark, the volume-equivalent of an uneven section), so their errors add along
/// the wood instead of averaging out; where the radius was not measured its own standard error counts.
void estimate_intervals(const Tree& tree, const std::optional<SliceDiameter>& dbh, double noise_m,
                        double spacing_m, TreeMetrics& metrics);

}  // namespace dendrofit
