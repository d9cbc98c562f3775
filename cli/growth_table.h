// SPDX-License-Identifier: GPL-3.0-or-later
// A growth report as text for the terminal.
#pragma once

#include "fit/growth_result.h"

#include <string>

namespace dendrofit::cli {

/// A series' equations: parameters with limits, AICc, whether the data bound the asymptote, what foresters
/// read off the curve, and every warning.
std::string growth_table(const GrowthReport& report, const GrowthSeries& series);

/// A mixed model: the population's parameters, what varies between series and by how much.
std::string mixed_table(const GrowthReport& report, const GrowthMixed& mixed);

/// "name = value unit [lo, hi]"; the limits in words where they are infinite.
std::string parameter_line(const GrowthParameter& parameter);

/// A growth equation's title, or "power law".
std::string form_title(const std::string& form);

/// Four digits; "-" for what is not a number.
std::string brief_number(double x);

}  // namespace dendrofit::cli
