// SPDX-License-Identifier: GPL-3.0-or-later
// A fitted height curve as the growth model's parameters: metres and years become internodes and cycles.
#pragma once

#include "fit/growth_result.h"

#include <optional>
#include <string>

namespace dendrofit::cli {

/// The text of a params.toml for `dendrofit grow`: the curve X(t) of `fit` in internodes over cycles, one
/// cycle a year, an internode being `internode_m` long (absent: the growth model's default); the other
/// parameters are the model's defaults, and it grows to the oldest age measured. Values in 'internodes'
/// (or 'count') stay as they are. Throws InputError, naming cause and remedy, for a
/// fit without an answer, an offset or time shift (the model's equations have none), values that are no
/// lengths, or a parameter outside the model's range.
std::string growth_params_toml(const GrowthReport& report, const GrowthSeries& series, const GrowthFit& fit,
                               double offset, std::optional<double> internode_m);

}  // namespace dendrofit::cli
