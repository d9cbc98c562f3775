// SPDX-License-Identifier: GPL-3.0-or-later
// How far a scanned tree's measures can be trusted.
#pragma once

#include "core/metrics.h"
#include "core/tree.h"
#include "recon/intervals.h"
#include "recon/skeleton.h"
#include "recon/subsampling.h"

#include <optional>
#include <vector>

namespace dendrofit {

/// What the points show of a tree, for the widths of intervals.
struct Visibility {
  double stem_coverage = 1;  ///< mean share of the stem's girth with points, weighted by volume; 0: nowhere
  double gap_share = 0;      ///< of the stem's length crossed without points, plus that of the branches'
  double unmeasured_share = 0;  ///< of the branches' volume
  bool in_leaf = false;
  SubsampleSpread spread;  ///< of the measures between halves of the points
};

Visibility how_well_seen(const std::vector<Limb>& limbs, bool in_leaf);

/// Highest wood of a tree in leaf. Its top shoot hides in its own leaves: where leaf points rise above the
/// model, the third highest (two may be strays) less half a leaf is nearer to the truth.
double height_in_leaf(double wood_top_m, const std::vector<Vec3>& foliage, double foot_z_m);

/// 95 % intervals for dbh_m, height_m, stem_volume_m3 and total_volume_m3 in metrics.intervals.
///
/// All: what halves of the points disagree by (subsampling.h). DBH: standard error of the circle,
/// disagreement of thin slices about breast height, noise. Height: point spacing (a tip between two beams is
/// missed, so more upwards than downwards); in leaf, a leaf's length either way. Volumes: radii err together
/// along the wood, by a share of themselves, by what the noise correction may be off, and by what the settled
/// radii say of themselves; a girth seen from one side, and gaps, mean wood that nobody saw, which makes the
/// tree larger and never smaller; branches in leaf are hidden, and leaves left on them thicken them. The
/// stem's volume also depends on which limb goes on at its forks: where another is nearly as thick, the
/// difference counts. The factors were set on virtual scans with known trees (bench/recon_bench, leaf-off
/// cases 1 to 48, leaf-on cases 21 to 64); other cases are the test.
void estimate_scan_intervals(const Tree& tree, const std::optional<SliceDiameter>& breast_height,
                             const Visibility& seen, double noise_m, double spacing_m, TreeMetrics& metrics);

}  // namespace dendrofit
