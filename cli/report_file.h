// SPDX-License-Identifier: GPL-3.0-or-later
// report.json: what a report says beside the trees, their measures and the pictures, so that `view` can make
// the page again from the folder.
#pragma once

#include "cli/report/report.h"

#include <filesystem>
#include <string>

namespace dendrofit::cli {

/// Growth model, parameters, curves, descriptors, cost, facts of the leaves, warnings and provenance of
/// `data`.
std::string report_json(const ReportData& data);

/// Puts back into `data` what report_json() took from it. Throws IoError naming file and key, or byte.
void read_report_json(const std::filesystem::path& path, ReportData& data);

}  // namespace dendrofit::cli
