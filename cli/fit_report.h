// SPDX-License-Identifier: GPL-3.0-or-later
// A fit in the words of a report.
#pragma once

#include "cli/report/report.h"
#include "fit/fit_tree.h"

#include <string>

namespace dendrofit::cli {

/// Growth model, status, parameters, descriptors, cost and the fit's warnings.
void describe_fit(ReportData& data, const TreeFit& fit);

/// Descriptors' names with what they mean: "reach_80 (crown radius about ...)". Names that are plain words
/// stay.
std::string explained(std::string text);

}  // namespace dendrofit::cli
