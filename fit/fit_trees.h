// SPDX-License-Identifier: GPL-3.0-or-later
// Several trees of one kind, fitted together.
#pragma once

#include "fit/fit_tree.h"

#include <vector>

namespace dendrofit {

struct TreesFit {
  std::vector<TreeFit> trees;           ///< in the order given; shared parameters have the same values in all
  std::vector<FittedParameter> shared;  ///< what all trees together tell
};

/// Trees that share the parameters of their kind (branching, light, pipe model) but not their size, maturity
/// or age. Each tree's posterior gives a likelihood of every shared parameter (a normal one, on the unit
/// box); their product is the joint estimate, at which the searches hold the shared parameters, and the
/// others' product sharpens each tree's own posterior. `options` hold for every tree; the bank is needed.
/// Throws InputError for fewer than two trees, dated heights, a checkpoint, or without a bank that can be
/// used; else as fit_tree().
TreesFit fit_trees(const std::vector<Tree>& trees, const FitOptions& options,
                   Progress& progress = no_progress());

}  // namespace dendrofit
