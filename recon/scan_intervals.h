// SPDX-License-Identifier: GPL-3.0-or-later
// How far a scanned tree's measures can be trusted.
#pragma once

#include "core/metrics.h"
#include "core/tree.h"
#include "recon/intervals.h"
#include "recon/skeleton.h"

#include <optional>
#include <vector>

namespace dendrofit {

/// What the points show of a tree, for the widths of intervals.
struct Visibility {
  double stem_coverage = 1;  ///< mean share of the stem's girth with points, weighted by volume; 0: nowhere
  double gap_share = 0;      ///< of the stem's length crossed without points, plus that of the branches'
  double unmeasured_share = 0;  ///< of the branches' volume
  bool in_leaf = false;
};

Visibility how_well_seen(const std::vector<Limb>& limbs, bool in_leaf);

/// 95 % intervals for dbh_m, height_m, stem_volume_m3 and total_volume_m3 in metrics.intervals.
///
/// DBH: standard error of the circle, disagreement of thin slices about breast height, noise. Height: point
/// spacing (a tip between two beams is missed, so more upwards than downwards). Volumes: radii err together
/// along the wood, by a share of themselves, by what the noise correction may be off, and by what the settled
/// radii say of themselves; a girth seen from one side, and gaps, mean wood that nobody saw, which makes the
/// tree larger and never smaller. The stem's volume also depends on which limb goes on at its forks: where
/// another is nearly as thick, the difference counts. The factors were set on 48 virtual scans with known
/// trees (bench/recon_bench, cases 1 to 48); other cases are the test.
void estimate_scan_intervals(const Tree& tree, const std::optional<SliceDiameter>& breast_height,
                             const Visibility& seen, double noise_m, double spacing_m, TreeMetrics& metrics);

}  // namespace dendrofit
