// SPDX-License-Identifier: GPL-3.0-or-later
// Measurements over time from tables.
#pragma once

#include "core/measurements.h"

#include <filesystem>
#include <string>
#include <vector>

namespace dendrofit {

struct ReadTableOptions {
  std::string series_column = "series";  ///< optional in the file: without it, all rows are one series
  std::string time_column = "time";
  std::string value_column = "value";
};

/// Columns series,time,value (header required, any order, further columns ignored; comma, semicolon, tab or
/// blanks between them; decimal comma understood where the delimiter is another). Rows whose time or value is
/// empty, NA or NaN are missing and left out. Series come in order of first appearance; one without a name is
/// called "1". Throws IoError naming file and line: no header, a column missing (with the columns found), a
/// word where a number is due, infinity, a row of another length, no measurement at all.
std::vector<MeasurementSeries> read_measurements(const std::filesystem::path& path,
                                                 const ReadTableOptions& options = {});

}  // namespace dendrofit
