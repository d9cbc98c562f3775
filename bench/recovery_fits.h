// SPDX-License-Identifier: GPL-3.0-or-later
// One truth fitted, and what came of it.
#pragma once

#include "fit/fit_tree.h"

#include <string>
#include <vector>

#include "bench/recovery_table.h"
#include "bench/recovery_truth.h"

namespace dendrofit {

/// The posterior from the bank alone, as the fit has it before its search. Throws SolverError where the bank
/// does not serve the tree.
std::vector<RecoveryLine> first_posterior(const Truth& truth, const Tree& seen, const FitOptions& options);

/// The whole fit. KEY is the value that regrows the tree, KEY_median the posterior's median; then the regrown
/// trees beside the true one.
std::vector<RecoveryLine> whole_fit(const Truth& truth, const Tree& seen, const FitOptions& options);

/// A baseline (recovery_baselines.h) with as many simulated trees as the whole fit has in its search.
std::vector<RecoveryLine> baseline_fit(const std::string& method, const Truth& truth, const Tree& seen,
                                       const FitOptions& options);

}  // namespace dendrofit
