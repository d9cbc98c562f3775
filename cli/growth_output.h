// SPDX-License-Identifier: GPL-3.0-or-later
// A growth report as files. Everything returns text; the command writes it.
#pragma once

#include "fit/growth_result.h"

#include <string>

namespace dendrofit::cli {

/// growth.json: {"series":[...], "pooled":..., "mixed":...} with the contract's names; unbounded limits as
/// "inf", "-inf", missing numbers as null. `interval` says how each fit's limits were found: "profile"
/// likelihood, or "wald" (always so for the mixed model).
std::string growth_report_json(const GrowthReport& report);

/// growth.csv: series,equation,time,fit,se,confidence_lo,confidence_hi,prediction_lo,prediction_hi,cai,mai; a
/// row for each age of each ok fit's bands, the pooled and mixed ("population") curves last.
std::string growth_curves_csv(const GrowthReport& report);

}  // namespace dendrofit::cli
