// SPDX-License-Identifier: GPL-3.0-or-later
// Distributions of leaves as people type them.
#pragma once

#include "forward/leaves/insert_leaves.h"

#include <string>

namespace dendrofit::cli {

/// `uniform`, `beta:A,B`, `weibull:SCALE,SHAPE`, `von-mises:MEAN,KAPPA` (mean as a share of the whole range,
/// 0.5 for its middle), `table:W1,W2,...`, or a sum of them with weights: `0.3*beta:2,8+0.7*beta:9,2`. Throws
/// UsageError naming `option` and what was found.
UnitDistribution unit_distribution_from(const std::string& text, const std::string& option);

/// `planophile`, `erectophile`, `plagiophile`, `extremophile`, `uniform`, `spherical`, `beta:A,B`,
/// `ellipsoidal:RATIO`, `table:W1,W2,...` (equal bins of 0 to 90 degrees). Throws UsageError.
InclinationLaw inclination_law_from(const std::string& text, const std::string& option);

/// `height=beta:2,3` and the like (height, along-axis, compass, radius, order, tip-distance) into `profile`.
/// Throws UsageError, also for a place that is set already.
void set_profile(const std::string& text, LeafProfile& profile);

}  // namespace dendrofit::cli
