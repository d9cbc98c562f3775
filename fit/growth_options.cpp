// SPDX-License-Identifier: GPL-3.0-or-later
#include "fit/growth_options.h"

#include "core/errors.h"
#include "core/parameters.h"
#include "forward/growth_equations.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace dendrofit {
namespace {

constexpr std::array<std::pair<std::string_view, GrowthLoss>, 6> kLosses{{{"none", GrowthLoss::none},
                                                                          {"huber", GrowthLoss::huber},
                                                                          {"soft_l1", GrowthLoss::soft_l1},
                                                                          {"cauchy", GrowthLoss::cauchy},
                                                                          {"arctan", GrowthLoss::arctan},
                                                                          {"tukey", GrowthLoss::tukey}}};
constexpr std::array<std::pair<std::string_view, GrowthWeights>, 3> kWeights{
    {{"equal", GrowthWeights::equal},
     {"inverse_value", GrowthWeights::inverse_value},
     {"inverse_square", GrowthWeights::inverse_square}}};

template <class Table>
auto named(const Table& table, const std::string& name, const std::string& what) {
  std::vector<std::string> known;
  for (const auto& [key, value] : table) {
    if (key == name) return value;
    known.emplace_back(key);
  }
  throw InputError("unknown " + what + " '" + name + "'; did you mean '" + nearest_word(name, known) + "'?");
}

template <class Table, class Value>
std::string name_of(const Table& table, Value value) {
  for (const auto& [key, known] : table)
    if (known == value) return std::string(key);
  return {};
}

// Every name by which a parameter of the chosen equations may be called.
std::vector<std::string> parameter_names(const GrowthOptions& options) {
  std::vector<std::string> names{"asymptote", "offset", "time_shift"};
  for (const std::string& equation : options.equations)
    for (const ParameterSpec& spec : growth_equation(equation).parameters)
      for (std::string_view name : {spec.symbol, spec.key}) {
        names.emplace_back(name);
        names.push_back(equation + "." + std::string(name));
      }
  return names;
}

void require_known(const std::vector<std::string>& names, const std::string& name, const std::string& field) {
  if (std::find(names.begin(), names.end(), name) == names.end())
    throw InputError(field + ": no chosen equation has a parameter '" + name + "'; did you mean '" +
                     nearest_word(name, names) + "'?");
}

}  // namespace

GrowthLoss growth_loss(const std::string& name) {
  return named(kLosses, name, "loss");
}
std::string growth_loss_name(GrowthLoss loss) {
  return name_of(kLosses, loss);
}
GrowthWeights growth_weights(const std::string& name) {
  return named(kWeights, name, "weighting");
}
std::string growth_weights_name(GrowthWeights weights) {
  return name_of(kWeights, weights);
}

void GrowthOptions::validate() const {
  require(!equations.empty(), "equations", 0, "must name at least one equation");
  const std::vector<std::string> names = parameter_names(*this);
  for (const auto& [name, value] : fixed) {
    require_known(names, name, "fixed");
    require(std::isfinite(value), "fixed." + name, value, "must be a finite number");
  }
  for (const auto& [name, value] : start) {
    require_known(names, name, "start");
    require(std::isfinite(value), "start." + name, value, "must be a finite number");
  }
  for (const auto& [name, limits] : bounds) {
    require_known(names, name, "bounds");
    if (limits.lo && limits.hi)
      require(*limits.lo < *limits.hi, "bounds." + name, *limits.lo,
              "the lower limit must be below the upper one");
  }
  require(std::isfinite(offset), "offset", offset, "must be a finite number");
  require(loss_scale > 0 && std::isfinite(loss_scale), "loss_scale", loss_scale, "must be above 0");
  require(confidence > 0 && confidence < 1, "confidence", confidence, "must be between 0 and 1");
  if (base_age) require(*base_age > 0, "base_age", *base_age, "must be above 0");
  require(threads >= 0, "threads", threads, "must be 0 (all cores) or more");
}

}  // namespace dendrofit
