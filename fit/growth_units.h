// SPDX-License-Identifier: GPL-3.0-or-later
// Units of measurement tables and their conversion.
#pragma once

#include "core/measurements.h"

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace dendrofit {

/// One unit in terms of its kind's base (m, m2, m3, year).
struct MeasurementUnit {
  std::string_view name;
  std::string_view kind;  ///< "length", "area", "volume", "time"
  double factor = 1;      ///< base units in one of this
};

/// Lengths m dm cm mm ft in; areas m2 cm2 ft2 ha; volumes m3 dm3 cm3 ft3; times years months weeks days
/// decades (also in the singular, "yr", "d"). A year has 365.25 days and twelve months. Nothing for an
/// unknown name.
std::optional<MeasurementUnit> measurement_unit(std::string_view name);

/// How many `to` make one `from`; throws InputError for an unknown unit or two of different kinds.
double unit_factor(std::string_view from, std::string_view to);

/// The series with times and values multiplied.
std::vector<MeasurementSeries> convert_units(std::vector<MeasurementSeries> series, double time_factor,
                                             double value_factor);

}  // namespace dendrofit
