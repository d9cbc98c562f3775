// SPDX-License-Identifier: GPL-3.0-or-later
// Reads small comma-separated reference tables in tests; no quoting.
#pragma once

#include "core/measurements.h"

#include <filesystem>
#include <fstream>
#include <limits>
#include <map>
#include <sstream>
#include <string>
#include <vector>

namespace dendrofit::test {

using CsvRow = std::map<std::string, std::string>;

inline std::vector<CsvRow> read_csv(const std::filesystem::path& path) {
  std::ifstream file(path);
  const auto split = [](const std::string& line) {
    std::vector<std::string> cells;
    std::string cell;
    for (char c : line + ",") {
      if (c == ',') {
        cells.push_back(cell);
        cell.clear();
      } else if (c != '\r' && c != '"') {
        cell += c;
      }
    }
    return cells;
  };
  std::string line;
  std::getline(file, line);
  const auto header = split(line);
  std::vector<CsvRow> rows;
  while (std::getline(file, line)) {
    const auto cells = split(line);
    CsvRow row;
    for (std::size_t i = 0; i < header.size() && i < cells.size(); ++i) row[header[i]] = cells[i];
    rows.push_back(row);
  }
  return rows;
}

/// NaN for an empty cell; "Inf" and "-Inf" as numbers.
inline double number(const CsvRow& row, const std::string& column) {
  const auto cell = row.find(column);
  if (cell == row.end() || cell->second.empty() || cell->second == "NA")
    return std::numeric_limits<double>::quiet_NaN();
  return std::stod(cell->second);
}

/// Series of a `series,time,value` table by name, and all together as "__pooled__".
inline std::map<std::string, MeasurementSeries> read_series(const std::filesystem::path& path) {
  std::map<std::string, MeasurementSeries> all;
  for (const CsvRow& row : read_csv(path))
    for (const std::string& name : {row.at("series"), std::string("__pooled__")}) {
      MeasurementSeries& series = all[name];
      series.name = name;
      series.time.push_back(number(row, "time"));
      series.value.push_back(number(row, "value"));
    }
  return all;
}

}  // namespace dendrofit::test
