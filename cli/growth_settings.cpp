// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/growth_settings.h"

#include "cli/parse.h"
#include "forward/growth_equations.h"

#include <map>
#include <sstream>
#include <stdexcept>

namespace dendrofit::cli {
namespace {

std::vector<std::string> split(const std::string& text, char at) {
  std::vector<std::string> words;
  std::istringstream stream(text);
  for (std::string word; std::getline(stream, word, at);)
    if (!word.empty()) words.push_back(word);
  return words;
}

/// "name=value" words as a map.
std::map<std::string, std::string> assignments(const std::string& option,
                                               const std::vector<std::string>& words) {
  std::map<std::string, std::string> map;
  for (const std::string& word : words) {
    const auto equals = word.find('=');
    if (equals == std::string::npos || equals == 0)
      throw UsageError(option + " " + word + ": expected NAME=VALUE, e.g. " + option + " X0=0.3");
    map[word.substr(0, equals)] = word.substr(equals + 1);
  }
  return map;
}

}  // namespace

double option_number(const std::string& option, const std::string& text) {
  try {
    return parse_quantity(text, Quantity::pure);
  } catch (const std::invalid_argument& error) {
    throw UsageError(option + ": " + error.what());
  }
}

void GrowthSettings::declare(OptionTable& table) {
  table.text("--equations", equations, "LIST",
             "Growth equations, comma separated, or 'all' (with --allometry also 'power', and there by "
             "default power, "
             "weibull, chapman_richards, korf, hossfeld4, bertalanffy)");
  table.flag("--allometry", allometry,
             "Height over diameter of trees measured once: columns dbh,height (series is optional)");
  table.text("--diameter-unit", diameter_unit, "UNIT", "Unit of the diameters with --allometry");
  table.text("--time-unit", time_unit, "UNIT", "Unit of the times: years, months, days");
  table.text("--value-unit", value_unit, "UNIT",
             "Unit of the values: m, cm, mm, ft, in, m3, ... or any word");
  table.text("--to-time-unit", to_time_unit, "UNIT", "Convert the times first");
  table.text("--to-value-unit", to_value_unit, "UNIT", "Convert the values first");
  table.texts("--fix", fix, "NAME=VALUE", "Hold a parameter, e.g. X0=0.3 or weibull.w3=2; may be repeated");
  table.texts("--bound", bound, "NAME=LO:HI",
              "Bound a parameter ('asymptote' for each equation's own); may be repeated");
  table.texts("--start", start, "NAME=VALUE",
              "Starting value tried before the automatic ones; may be repeated");
  table.flag("--fit-offset", fit_offset, "Fit an offset: X = offset + f(t)");
  table.flag("--fit-time-shift", fit_time_shift, "Fit a time shift: X = f(t + shift)");
  table.number("--offset", offset, Quantity::pure,
               "Known size at the origin, e.g. 1.3 for breast-height ages");
  table.number("--origin", origin, Quantity::pure, "Year of germination, where times are calendar years");
  table.choice("--weights", weights, {"equal", "inverse_value", "inverse_square"},
               "Weights of the measurements");
  table.choice("--loss", loss, {"none", "huber", "soft_l1", "cauchy", "arctan", "tukey"}, "Robust loss");
  table.number("--loss-scale", loss_scale, Quantity::pure,
               "Residual at which the loss starts to give way, in the values' unit");
  table.number("--confidence", confidence, Quantity::pure, "Of intervals and bands");
  table.number("--base-age", base_age, Quantity::pure, "Base age of the site index");
  table.choice("--mixed", mixed, {"none", "asymptote", "asymptote_and_rate"},
               "Mixed-effects model over the series");
  table.choice("--mixed-form", mixed_form, {"shape", "start"},
               "What the series share in the mixed model: the curve's shape in time, or the size at age 0");
  table.text("--ages", ages, "LIST",
             "Ages of the curves and bands, comma separated (default: 60 over the data)");
  table.flag("--no-profile", no_profile,
             "Wald limits in place of profile-likelihood ones (faster, less honest)");
  table.flag("--no-pooled", no_pooled, "No fit of all series as one");
  table.flag("--trunk-base-unmeasured", trunk_base_unmeasured,
             "The first years are missing from the measurements");
}

std::vector<std::string> GrowthSettings::forms() const {
  if (equations == "all") {
    std::vector<std::string> names;
    for (const GrowthEquation& equation : growth_equations()) {
      if (allometry && !equation.starts_at_zero) continue;
      names.emplace_back(equation.name);
    }
    if (allometry) names.emplace_back("power");
    return names;
  }
  const bool untouched = equations == GrowthSettings().equations;
  if (allometry && untouched)
    return {"power", "weibull", "chapman_richards", "korf", "hossfeld4", "bertalanffy"};
  return split(equations, ',');
}

GrowthOptions GrowthSettings::resolve(const CommonOptions& common) const {
  if (allometry && (mixed != "none" || fit_offset || fit_time_shift || offset != 0 || origin || base_age))
    throw UsageError(
        "--allometry: heights over diameters start at 1.3 m and have no age: --mixed, --offset, "
        "--fit-offset, "
        "--fit-time-shift, --origin and --base-age do not go with it");
  GrowthOptions options;
  options.equations = allometry ? std::vector<std::string>{"weibull"} : forms();
  for (const auto& [name, value] : assignments("--fix", fix))
    options.fixed[name] = option_number("--fix", value);
  for (const auto& [name, range] : assignments("--bound", bound)) {
    const auto colon = range.find(':');
    if (colon == std::string::npos)
      throw UsageError("--bound " + name + "=" + range + ": expected NAME=LO:HI (either may be empty)");
    GrowthBounds& bounds = options.bounds[name];
    if (colon > 0) bounds.lo = option_number("--bound", range.substr(0, colon));
    if (colon + 1 < range.size()) bounds.hi = option_number("--bound", range.substr(colon + 1));
  }
  options.fit_offset = fit_offset;
  options.fit_time_shift = fit_time_shift;
  options.offset = offset;
  options.origin_time = origin;
  options.weights = growth_weights(weights);
  options.loss = growth_loss(loss);
  options.loss_scale = loss_scale;
  options.confidence = confidence;
  options.base_age = base_age;
  options.mixed = mixed == "none"        ? GrowthMixedEffects::none
                  : mixed == "asymptote" ? GrowthMixedEffects::asymptote
                                         : GrowthMixedEffects::asymptote_and_rate;
  options.mixed_form = mixed_form == "shape" ? GrowthMixedForm::shape : GrowthMixedForm::start;
  for (const auto& [name, value] : assignments("--start", start))
    options.start[name] = option_number("--start", value);
  for (const std::string& age : split(ages, ',')) options.band_times.push_back(option_number("--ages", age));
  options.profile_intervals = !no_profile;
  options.pooled = !no_pooled;
  options.trunk_base_unmeasured = trunk_base_unmeasured;
  options.time_unit = allometry ? diameter_unit : to_time_unit.empty() ? time_unit : to_time_unit;
  options.value_unit = to_value_unit.empty() ? value_unit : to_value_unit;
  options.threads = common.threads;
  options.validate();
  return options;
}

}  // namespace dendrofit::cli
