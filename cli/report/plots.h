// SPDX-License-Identifier: GPL-3.0-or-later
// The report's plots.
#pragma once

#include "cli/report/report.h"

#include <string>

namespace dendrofit {

/// All plots that `data` has the numbers for, as <figure> elements; "" where there is none.
std::string report_plots(const ReportData& data);

/// Fitted values with their intervals inside the bounds they started from; "" without any.
std::string parameter_plot(const std::vector<ReportParameter>& parameters);

}  // namespace dendrofit
