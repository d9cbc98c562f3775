// SPDX-License-Identifier: GPL-3.0-or-later
// Calibration from the bank alone: its last draws are the truths, the others the bank.
#pragma once

#include "fit/prior_bank.h"

#include <string>
#include <vector>

namespace dendrofit {

struct HeldOut {
  int truth = 0;
  std::string key;  ///< coordinate of the search box; values in the unit box
  double value = 0, median = 0, lo = 0, hi = 0, lo50 = 0, hi50 = 0, shrinkage = 0, rank = 0;
};

/// Posteriors of the last `truths` draws of the bank whose trees are 40 to 110 internodes tall, at a
/// truncation (index of kVisibleShares), with `errors` times the scan's errors drawn onto their descriptors.
std::vector<HeldOut> held_out_posteriors(const PriorBank& bank, int truths, std::size_t level, double errors);

}  // namespace dendrofit
