// SPDX-License-Identifier: GPL-3.0-or-later
// A growth report as files and as text for the terminal. Everything returns text; the command writes it.
#pragma once

#include "fit/growth_options.h"
#include "fit/growth_result.h"

#include <string>

namespace dendrofit::cli {

/// growth.json: {"series":[...], "pooled":..., "mixed":...} with the contract's names; unbounded limits as
/// "inf", "-inf", missing numbers as null.
std::string growth_report_json(const GrowthReport& report);

/// growth.csv: series,equation,time,fit,se,confidence_lo,confidence_hi,prediction_lo,prediction_hi,cai,mai; a
/// row for each age of each ok fit's bands, the pooled and mixed ("population") curves last.
std::string growth_curves_csv(const GrowthReport& report);

/// growth.svg: measurements, the best curve and its bands of one series (of the pooled curve over all
/// measurements where `series` is null), axes labelled with units.
std::string growth_svg(const GrowthReport& report, const GrowthSeries* series = nullptr);

/// The terminal's table of a series' equations (parameters with limits, AICc, whether the data bound the
/// asymptote) and a small plot.
std::string growth_table(const GrowthReport& report, const GrowthSeries& series);
std::string growth_plot_text(const GrowthSeries& series, int columns = 64, int rows = 14);

/// params.toml of a series' fit for `dendrofit grow`: the equation and its parameters by their file keys.
/// Throws InputError where the fit has none.
std::string growth_params_toml(const GrowthSeries& series, const std::string& equation);

}  // namespace dendrofit::cli
