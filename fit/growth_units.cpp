// SPDX-License-Identifier: GPL-3.0-or-later
#include "fit/growth_units.h"

#include "core/errors.h"
#include "core/parameters.h"

#include <array>

namespace dendrofit {
namespace {

constexpr double kFoot = 0.3048, kInch = 0.0254, kDay = 1 / 365.25;
constexpr std::array<MeasurementUnit, 31> kUnits{{
    {"m", "length", 1},
    {"dm", "length", 0.1},
    {"cm", "length", 0.01},
    {"mm", "length", 0.001},
    {"ft", "length", kFoot},
    {"in", "length", kInch},
    {"m2", "area", 1},
    {"cm2", "area", 1e-4},
    {"ft2", "area", kFoot* kFoot},
    {"ha", "area", 1e4},
    {"m3", "volume", 1},
    {"dm3", "volume", 1e-3},
    {"l", "volume", 1e-3},
    {"cm3", "volume", 1e-6},
    {"ft3", "volume", kFoot* kFoot* kFoot},
    {"years", "time", 1},
    {"year", "time", 1},
    {"yr", "time", 1},
    {"a", "time", 1},
    {"months", "time", 1.0 / 12},
    {"month", "time", 1.0 / 12},
    {"mo", "time", 1.0 / 12},
    {"weeks", "time", 7 * kDay},
    {"week", "time", 7 * kDay},
    {"days", "time", kDay},
    {"day", "time", kDay},
    {"d", "time", kDay},
    {"decades", "time", 10},
    {"decade", "time", 10},
    {"feet", "length", kFoot},
    {"inches", "length", kInch},
}};

MeasurementUnit known_unit(std::string_view name) {
  if (const auto unit = measurement_unit(name)) return *unit;
  std::vector<std::string> known;
  known.reserve(kUnits.size());
  for (const MeasurementUnit& unit : kUnits) known.emplace_back(unit.name);
  throw InputError("unknown unit '" + std::string(name) + "'; did you mean '" + nearest_word(name, known) +
                   "'?");
}

}  // namespace

std::optional<MeasurementUnit> measurement_unit(std::string_view name) {
  for (const MeasurementUnit& unit : kUnits)
    if (unit.name == name) return unit;
  return std::nullopt;
}

double unit_factor(std::string_view from, std::string_view to) {
  const MeasurementUnit a = known_unit(from), b = known_unit(to);
  if (a.kind != b.kind)
    throw InputError("unit '" + std::string(from) + "' is a " + std::string(a.kind) + " and '" +
                     std::string(to) + "' a " + std::string(b.kind) + ": give two units of the same kind");
  return a.factor / b.factor;
}

std::vector<MeasurementSeries> convert_units(std::vector<MeasurementSeries> series, double time_factor,
                                             double value_factor) {
  for (MeasurementSeries& one : series) {
    for (double& t : one.time) t *= time_factor;
    for (double& x : one.value) x *= value_factor;
  }
  return series;
}

}  // namespace dendrofit
