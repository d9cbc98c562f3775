// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/fit_settings.h"

#include "cli/igm_files.h"
#include "cli/parse.h"
#include "core/atomic_file.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace dendrofit::cli {

using Json = nlohmann::ordered_json;

void FitSettings::declare(OptionTable& options) {
  options.text("--budget", budget, "N|TIME",
               "Parameter sets to try, or a time such as 8min (then results depend on the machine)");
  options.number("--age", age_years, Quantity::pure,
                 "Age of the tree in years (default: searched, in growth cycles)");
  options.number("--internode-length", internode_length_m, Quantity::length,
                 "Internode length of the model (default: by the tree's height)");
  options.choice("--equation", equation, {"logistic", "bertalanffy", "weibull"}, "Growth equation");
}

FitOptions FitSettings::resolve(const CommonOptions& common) const {
  FitOptions options;
  const bool plain = !budget.empty() && std::all_of(budget.begin(), budget.end(),
                                                    [](unsigned char c) { return std::isdigit(c); });
  try {
    const double amount = parse_quantity(budget, plain ? Quantity::pure : Quantity::duration);
    if (plain && amount > 1e7) throw std::invalid_argument("'" + budget + "' is more than 10 million");
    if (plain)
      options.evaluations = static_cast<int>(amount);
    else
      options.seconds = amount;
  } catch (const std::invalid_argument& error) {
    throw UsageError(std::string("--budget: ") + error.what());
  }
  if (options.seconds) options.evaluations = 1'000'000;
  options.age_years = age_years;
  options.internode_length_m = internode_length_m;
  options.equation = equation;
  options.seed = common.seed;
  options.threads = common.threads;
  options.validate();
  return options;
}

std::string fit_json(const TreeFit& fit) {
  Json parameters = Json::object();
  for (const FittedParameter& p : fit.parameters)
    parameters[p.key] = {{"value", p.value},
                         {"lo", p.lo},
                         {"hi", p.hi},
                         {"level", 0.9},
                         {"unit", p.unit},
                         {"bounds", {p.prior_lo, p.prior_hi}},
                         {"shrinkage", p.shrinkage},
                         {"identifiable", p.identifiable},
                         {"meaning", p.meaning}};
  Json descriptors = Json::array();
  const auto off = [](double value, const DescriptorFit& d) {
    return std::abs(value - d.observed) / d.noise;
  };
  for (const DescriptorFit& d : fit.descriptors)
    descriptors.push_back({{"name", d.name},
                           {"unit", d.unit},
                           {"observed", d.observed},
                           {"noise", d.noise},
                           {"before", d.before},
                           {"after", d.after},
                           {"cost_before", off(d.before, d)},
                           {"cost_after", off(d.after, d)}});
  const Json json = {{"model", fit.model},
                     {"equation", fit.best.equation},
                     {"parameters", parameters},
                     {"fixed",
                      {{"rho_m", fit.best.rho_m},
                       {"pipe_exponent", fit.best.pipe_exponent},
                       {"tip_radius_m", fit.best.tip_radius_m},
                       {"cycles", fit.best.cycles},
                       {"tau", fit.best.tau},
                       {"alpha", fit.best.alpha},
                       {"sigma", fit.best.sigma},
                       {"b_min", fit.best.b_min},
                       {"b_max", fit.best.b_max}}},
                     {"years_per_cycle", fit.years_per_cycle},
                     {"age_known", fit.age_known},
                     {"cost_before", fit.cost_before},
                     {"cost_after", fit.cost_after},
                     {"seed_floor", fit.seed_floor},
                     {"descriptors", descriptors},
                     {"evaluations", fit.evaluations},
                     {"seed", fit.seed},
                     {"best_seed", fit.best_seed},
                     {"converged", fit.converged},
                     {"stop_reason", fit.stop_reason},
                     {"warnings", fit.warnings}};
  return json.dump(2) + "\n";
}

void write_fit(const std::filesystem::path& folder, const TreeFit& fit) {
  write_file(folder / "fit.json", fit_json(fit));
  write_file(folder / "params.toml",
             igm_parameters_toml(fit.best, {"Fitted by dendrofit. Regrow with:",
                                            fmt::format("  dendrofit grow params.toml --seed {} -o regrown",
                                                        fit.best_seed)}));
}

void say_fit(const Session& session, const TreeFit& fit) {
  session.say(fmt::format("Growth parameters ({} equation, 90 % intervals)", fit.best.equation));
  for (const FittedParameter& p : fit.parameters) {
    if (p.identifiable)
      session.say(fmt::format("  {:<17} {:>8.4g}   {:.4g} to {:.4g} {}", p.key, p.value, p.lo, p.hi, p.unit));
    else
      session.say(fmt::format("  {:<17} not identifiable from this tree (anything from {:.4g} to {:.4g}{}{})",
                              p.key, p.lo, p.hi, p.unit.empty() ? "" : " ", p.unit));
  }
  session.say(fmt::format(
      "  distance    {:.2f} -> {:.2f} (seeds of one tree differ by {:.2f}); {} parameter sets; {}",
      fit.cost_before, fit.cost_after, fit.seed_floor, fit.evaluations, fit.stop_reason));
  for (const std::string& warning : fit.warnings) session.warn(warning);
}

}  // namespace dendrofit::cli
