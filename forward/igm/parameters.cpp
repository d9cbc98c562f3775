// SPDX-License-Identifier: GPL-3.0-or-later
#include "forward/igm/parameters.h"

#include "core/errors.h"
#include "forward/growth_equations.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <sstream>
#include <variant>

namespace dendrofit {
namespace {

using Member = std::variant<double IgmParameters::*, int IgmParameters::*, bool IgmParameters::*>;

struct Row {
  ParameterSpec spec;  // default_value is filled from the struct itself
  Member member;
};

constexpr std::array<Row, 25> kRows{{
    {{"rho_m", "rho", "m", 0, 1e-4, 10, "internode length", "Table 2"}, &IgmParameters::rho_m},
    {{"lambda", "lambda", "", 0, 0.01, 0.99,
      "share of an axis against its branch; above 0.5 favours the axis", "4.2 (Table 3 says the reverse)"},
     &IgmParameters::lambda},
    {{"k", "k", "", 0, 0.01, 1, "fraction of an axis's nodes that receive resource", "4.2; priority model"},
     &IgmParameters::k},
    {{"tau", "tau", "cycles", 0, 0, 1000, "apical control of the trunk", "4.2"}, &IgmParameters::tau},
    {{"alpha", "alpha", "", 0, 0.01, 1000, "resource per unit of light",
      "4.1; the printed values are about 2.5 times too small for the printed heights"},
     &IgmParameters::alpha},
    {{"sigma", "sigma", "", 0, 0, 2, "ageing of light sensitivity: L = l^(age^sigma)",
      "4.1, authors' program"},
     &IgmParameters::sigma},
    {{"mu", "mu", "", 0, 0, 20, "weight of the optimal direction", "4.4"}, &IgmParameters::mu},
    {{"gamma", "gamma", "", 0, -20, 20, "weight of the tropism of branches; above 0 droops", "4.4"},
     &IgmParameters::gamma},
    {{"gamma_late", "gamma", "", 0, -20, 20, "weight of the tropism from late_cycle on", "4.4, Fig. 4"},
     &IgmParameters::gamma_late},
    {{"late_cycle", "", "cycles", 0, 1, 1000, "cycle from which gamma_late holds; 1000: never",
      "4.4, Fig. 4"},
     &IgmParameters::late_cycle},
    {{"b_min", "b_min", "", 0, 1.01, 20, "shading base until cycle tau", "4.5, Fig. 10b"},
     &IgmParameters::b_min},
    {{"b_max", "b_max", "", 0, 1.01, 20, "shading base from schedule_cycles on", "4.5, Fig. 10b"},
     &IgmParameters::b_max},
    {{"shed_ratio", "r_s", "", 0, 0, 1, "least mean light of a branch that stays; higher is sparser",
      "4.6 (Table 3 says the reverse)"},
     &IgmParameters::shed_ratio},
    {{"branch_angle_deg", "", "deg", 0, 1, 120, "branching angle on the trunk", "authors' program"},
     &IgmParameters::branch_angle_deg},
    {{"pipe_exponent", "v", "", 0, 1, 6, "exponent of the pipe model",
      "4.6; value from the authors' program"},
     &IgmParameters::pipe_exponent},
    {{"tip_radius_m", "", "m", 0, 1e-5, 0.1, "radius of a tip", "authors' program"},
     &IgmParameters::tip_radius_m},
    {{"cycles", "", "cycles", 0, 1, 1000, "cycles to grow, at most", "Table 2, LoS"}, &IgmParameters::cycles},
    {{"schedule_cycles", "", "cycles", 0, 1, 1000, "cycle at which b reaches b_max", "Fig. 10b"},
     &IgmParameters::schedule_cycles},
    {{"resource_allocation", "", "", 0, 0, 1, "0: the growth equation alone", "4.3, Fig. 6"},
     &IgmParameters::resource_allocation},
    {{"restore_light", "", "", 0, 0, 1, "1: shed branches give their light back", "ours"},
     &IgmParameters::restore_light},
    {{"stretch_internodes", "", "", 0, 0, 1, "1: internodes of rho v / floor(v)", "authors' program"},
     &IgmParameters::stretch_internodes},
    {{"stretch_by_node", "", "", 0, 0, 1, "1: v there of the node's shoots together, not of each",
      "the authors' lengths: median 1.03 rho"},
     &IgmParameters::stretch_by_node},
    {{"paper", "", "", 0, 0, 1, "1: siblings counted twice in radii, as the printed diameters need",
      "authors' program"},
     &IgmParameters::paper},
    {{"max_markers", "", "", 0, 1, 1e7, "marker points of a tree in a cycle", "authors' program"},
     &IgmParameters::max_markers},
    {{"max_order", "", "", 0, 1, 100, "branches of this order bear none", "authors' program"},
     &IgmParameters::max_order},
}};
constexpr std::size_t kRowCount = kRows.size();

double read(const IgmParameters& parameters, const Member& member) {
  return std::visit([&](auto field) { return static_cast<double>(parameters.*field); }, member);
}

// What a size and a rate of the growth equation can sensibly be when sizes are internodes and ages cycles.
ParameterSpec in_internodes(ParameterSpec spec) {
  if (spec.unit == "size") {
    spec.unit = "internodes";
    spec.lo = std::max(spec.lo, 0.01);
    spec.hi = std::min(spec.hi, 10000.0);
  } else if (spec.unit == "1/time") {
    spec.unit = "1/cycle";
    spec.lo = std::max(spec.lo, 1e-4);
    spec.hi = std::min(spec.hi, 10.0);
  }
  return spec;
}

std::string lead(std::string_view where) {
  return where.empty() ? std::string() : std::string(where) + ": ";
}

void check_bounds(const ParameterSpec& spec, double value, std::string_view where) {
  if (std::isfinite(value) && value >= spec.lo && value <= spec.hi) return;
  std::ostringstream message;
  message << lead(where) << spec.key << " = " << value << ": must be a number between " << spec.lo << " and "
          << spec.hi;
  if (!spec.unit.empty()) message << " " << spec.unit;
  throw InputError(message.str());
}

[[noreturn]] void unknown_key(std::string_view key, std::string_view equation, std::string_view where) {
  for (const GrowthEquation& other : growth_equations())
    for (const ParameterSpec& spec : other.parameters)
      if (spec.key == key) {
        std::string own;
        for (const ParameterSpec& row : growth_equation(equation).parameters)
          own += (own.empty() ? "" : ", ") + std::string(row.key);
        throw InputError(lead(where) + "parameter '" + std::string(key) + "' belongs to the " +
                         std::string(other.name) + " equation; the " + std::string(equation) +
                         " equation has " + own);
      }
  std::vector<std::string> known{"equation"};
  for (const ParameterSpec& spec : igm_parameter_table(equation)) known.emplace_back(spec.key);
  throw InputError(lead(where) + "unknown parameter '" + std::string(key) + "'; did you mean '" +
                   nearest_word(key, known) + "'?");
}

}  // namespace

std::vector<ParameterSpec> igm_parameter_table(std::string_view equation) {
  const IgmParameters defaults;
  std::vector<ParameterSpec> table;
  for (const ParameterSpec& spec : growth_equation(equation).parameters) table.push_back(in_internodes(spec));
  for (std::size_t i = 0; i < kRowCount; ++i) {
    ParameterSpec spec = kRows[i].spec;
    spec.default_value = read(defaults, kRows[i].member);
    table.push_back(spec);
  }
  return table;
}

double IgmParameters::cap(int cycle) const {
  // Authors' program: young plants grow by 4 whatever the equation, which starts too slowly.
  return cycle < 5 ? 4.0 : growth_equation(equation).rate(equation_values, cycle);
}

double IgmParameters::shading_base(int cycle) const {
  if (cycle <= tau) return b_min;
  const double span = schedule_cycles - tau;
  const double grown = span > 0 ? std::min(1.0, (cycle - tau) / span) : 1.0;
  return b_min + (b_max - b_min) * grown;
}

double IgmParameters::get(std::string_view key) const {
  const auto own = growth_equation(equation).parameters;
  for (std::size_t i = 0; i < own.size(); ++i)
    if (own[i].key == key) return equation_values.at(i);
  for (std::size_t i = 0; i < kRowCount; ++i)
    if (kRows[i].spec.key == key) return read(*this, kRows[i].member);
  unknown_key(key, equation, "");
}

void IgmParameters::set(std::string_view key, double value, std::string_view where) {
  const auto own = growth_equation(equation).parameters;
  for (std::size_t i = 0; i < own.size(); ++i) {
    if (own[i].key != key) continue;
    check_bounds(in_internodes(own[i]), value, where);
    equation_values.at(i) = value;
    return;
  }
  for (std::size_t i = 0; i < kRowCount; ++i) {
    if (kRows[i].spec.key != key) continue;
    check_bounds(kRows[i].spec, value, where);
    const auto assign = [&](auto field) {
      using Value = std::remove_reference_t<decltype(this->*field)>;
      if constexpr (!std::is_same_v<Value, double>)
        if (value != std::floor(value)) {
          std::ostringstream message;
          message << lead(where) << key << " = " << value << ": must be a whole number";
          throw InputError(message.str());
        }
      this->*field = static_cast<Value>(value);
    };
    std::visit(assign, kRows[i].member);
    return;
  }
  unknown_key(key, equation, where);
}

bool IgmParameters::is_switch(std::string_view key) {
  return std::any_of(kRows.begin(), kRows.end(), [&](const Row& row) {
    return row.spec.key == key && std::holds_alternative<bool IgmParameters::*>(row.member);
  });
}

void IgmParameters::set_equation(std::string_view name, std::string_view where) {
  try {
    const GrowthEquation& row = growth_equation(name);
    if (row.name == equation) return;
    equation = row.name;
    equation_values.clear();
    for (const ParameterSpec& spec : row.parameters) equation_values.push_back(spec.default_value);
  } catch (const InputError& error) {
    throw InputError(lead(where) + error.what());
  }
}

void IgmParameters::validate() const {
  const auto own = growth_equation(equation).parameters;
  if (equation_values.size() != own.size())
    throw InputError("equation_values: " + std::to_string(equation_values.size()) + " values; the " +
                     equation + " equation has " + std::to_string(own.size()));
  for (std::size_t i = 0; i < own.size(); ++i) check_bounds(in_internodes(own[i]), equation_values[i], "");
  for (std::size_t i = 0; i < kRowCount; ++i) check_bounds(kRows[i].spec, read(*this, kRows[i].member), "");
  if (equation == "logistic") {
    std::ostringstream limit;
    limit << "must be less than xm (" << equation_values[1] << " internodes)";
    require(equation_values[0] < equation_values[1], "x0", equation_values[0], limit.str());
  }
  std::ostringstream least;
  least << "must not be less than b_min (" << b_min << ")";
  require(b_max >= b_min, "b_max", b_max, least.str());
}

}  // namespace dendrofit
