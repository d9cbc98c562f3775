// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/read_table.h"

#include "io/csv_table.h"
#include "io/text_numbers.h"

#include <unordered_map>

namespace dendrofit {

std::vector<MeasurementSeries> read_measurements(const std::filesystem::path& path,
                                                 const ReadTableOptions& options) {
  const FileBytes bytes(path);
  CsvTable table(bytes);
  const int series_column = table.find(options.series_column);
  const std::size_t time_column = table.column(options.time_column);
  const std::size_t value_column = table.column(options.value_column);
  std::vector<MeasurementSeries> all;
  std::unordered_map<std::string, std::size_t> index;
  std::size_t rows = 0;
  while (table.next()) {
    ++rows;
    const std::string name = series_column < 0
                                 ? std::string("1")
                                 : std::string(table.text(static_cast<std::size_t>(series_column)));
    if (name.empty())
      table.fail("column '" + options.series_column + "' is empty; name the series, or leave the column out");
    const auto [found, is_new] = index.emplace(name, all.size());
    if (is_new) all.push_back({name, {}, {}});
    if (table.missing(time_column) || table.missing(value_column)) continue;
    all[found->second].time.push_back(table.number(time_column));
    all[found->second].value.push_back(table.number(value_column));
  }
  std::size_t measurements = 0;
  for (const MeasurementSeries& series : all) measurements += series.time.size();
  if (measurements == 0)
    fail_in_file(path, rows == 0
                           ? "a header without rows; expected measurements below it"
                           : "no row has both a " + options.time_column + " and a " + options.value_column);
  return all;
}

}  // namespace dendrofit
