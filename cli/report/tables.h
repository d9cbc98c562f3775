// SPDX-License-Identifier: GPL-3.0-or-later
// The report's headline numbers, warnings and tables, as HTML; "" where `data` has nothing for them.
#pragma once

#include "cli/report/report.h"

#include <string>

namespace dendrofit {

/// The unit of wood volumes: litres below a cubic metre, else cubic metres, one for the whole page.
struct VolumeUnit {
  const char* words;
  double per_m3;
};
VolumeUnit volume_unit(const ReportData& data);

std::string headline(const ReportData& data);
std::string warning_box(const ReportData& data);
std::string metrics_table(const ReportData& data);
std::string parameter_table(const ReportData& data);
std::string descriptor_table(const ReportData& data);
std::string leaf_table(const ReportData& data);
std::string provenance_tables(const ReportData& data);

}  // namespace dendrofit
