// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/fit_settings.h"

#include "cli/bank_file.h"
#include "cli/igm_files.h"
#include "cli/parse.h"
#include "core/atomic_file.h"
#include "io/json_text.h"
#include "io/read_table.h"

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
  options.path("--heights", heights,
               "Table of this tree's dated heights (time in years, value in metres): fixes the time course");
  options.number("--internode-length", internode_length_m, Quantity::length,
                 "Internode length of the model (default: by the tree's height)");
  options.number("--thinnest-wood", thinnest_wood_m, Quantity::length,
                 "Radius below which wood is missing from the model that is given (default: none is)");
  options.choice("--equation", equation, {"logistic", "bertalanffy", "weibull"}, "Growth equation");
}

std::vector<std::filesystem::path> FitSettings::inputs() const {
  return heights.empty() ? std::vector<std::filesystem::path>{} : std::vector{heights};
}

FitOptions FitSettings::resolve(const Session& session) const {
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
  options.thinnest_wood_m = thinnest_wood_m;
  options.equation = equation;
  if (!heights.empty()) {
    const std::vector<MeasurementSeries> series = read_measurements(heights);
    if (series.size() > 1)
      throw UsageError(
          fmt::format("--heights {}: holds {} series; keep the rows of the one tree that is fitted",
                      heights.string(), series.size()));
    options.heights = series.front();
  }
  options.bank = installed_bank();
  if (!options.bank)
    session.warn(
        "share/dendrofit/igm.bank is not beside the program: part of the budget goes into simulating the "
        "prior");
  options.seed = session.common().seed;
  options.threads = session.common().threads;
  options.validate();
  return options;
}

namespace {

Json parameters_json(const std::vector<FittedParameter>& list) {
  Json parameters = Json::object();
  for (const FittedParameter& p : list)
    parameters[p.key] = {{"value", p.value},
                         {"lo", p.lo},
                         {"hi", p.hi},
                         {"level", 0.9},
                         {"median", p.median},
                         {"lo50", p.lo50},
                         {"hi50", p.hi50},
                         {"unit", p.unit},
                         {"bounds", {p.prior_lo, p.prior_hi}},
                         {"shrinkage", p.shrinkage},
                         {"identifiable", p.identifiable},
                         {"meaning", p.meaning}};
  return parameters;
}

}  // namespace

std::string trees_fit_json(const TreesFit& fit) {
  Json trees = Json::array();
  for (const TreeFit& tree : fit.trees) trees.push_back(Json::parse(fit_json(tree)));
  return json_text({{"shared", parameters_json(fit.shared)}, {"trees", trees}}) + "\n";
}

std::string fit_json(const TreeFit& fit) {
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
  Json correlated = Json::array();
  for (const CorrelatedPair& c : fit.correlated)
    correlated.push_back({{"parameters", {c.first, c.second}}, {"correlation", c.correlation}});
  Json evidence = Json::array();
  for (const EquationEvidence& e : fit.evidence)
    evidence.push_back(
        {{"equation", e.equation}, {"probability", e.probability}, {"log10_evidence", e.log10_evidence}});
  Json trees = Json::array();
  for (const PosteriorTree& tree : fit.posterior_trees) {
    Json values = Json::object();
    for (const FittedParameter& p : fit.parameters) values[p.key] = tree.parameters.get(p.key);
    trees.push_back({{"seed", tree.seed}, {"cost", tree.cost}, {"parameters", values}});
  }
  Json fixed = Json::object();
  for (const ParameterSpec& spec : igm_parameter_table(fit.best.equation)) {
    const std::string key(spec.key);
    const bool fitted = std::any_of(fit.parameters.begin(), fit.parameters.end(),
                                    [&](const FittedParameter& p) { return p.key == key; });
    if (!fitted) fixed[key] = fit.best.get(key);
  }
  const DirectEstimates& direct = fit.direct;
  const auto or_null = [](const std::optional<double>& v) { return v ? Json(*v) : Json(); };
  const Json json = {{"model", fit.model},
                     {"equation", fit.best.equation},
                     {"parameters", parameters_json(fit.parameters)},
                     {"fixed", fixed},
                     {"direct",
                      {{"height_m", direct.height_m},
                       {"dbh_m", or_null(direct.dbh_m)},
                       {"internode_length_m", direct.internode_length_m},
                       {"size_internodes", direct.size_internodes},
                       {"pipe_exponent", direct.pipe_exponent},
                       {"forks", direct.forks},
                       {"branches", direct.branches},
                       {"branch_angle_deg", or_null(direct.branch_angle_deg)},
                       {"bend_deg", or_null(direct.bend_deg)}}},
                     {"years_per_cycle", fit.years_per_cycle},
                     {"age_known", fit.age_known},
                     {"course_known", fit.course_known},
                     {"correlated", correlated},
                     {"equations", evidence},
                     {"prior_simulations", fit.prior_simulations},
                     {"used_bank", fit.used_bank},
                     {"comparison",
                      {{"visible_share", fit.comparison.visible_share},
                       {"shortest_axis_share", fit.comparison.shortest_axis_share}}},
                     {"cost_before", fit.cost_before},
                     {"cost_after", fit.cost_after},
                     {"seed_floor", fit.seed_floor},
                     {"descriptors", descriptors},
                     {"refinement",
                      {{"tried", fit.refinement.tried},
                       {"kept", fit.refinement.kept},
                       {"cost_without", fit.refinement.cost_without},
                       {"cost_with", fit.refinement.cost_with},
                       {"outcome", fit.refinement.outcome}}},
                     {"posterior_trees", trees},
                     {"evaluations", fit.evaluations},
                     {"seed", fit.seed},
                     {"best_seed", fit.best_seed},
                     {"seconds", fit.seconds},
                     {"converged", fit.converged},
                     {"stop_reason", fit.stop_reason},
                     {"warnings", fit.warnings}};
  return json_text(json) + "\n";
}

void write_fit(const std::filesystem::path& folder, const TreeFit& fit) {
  write_file(folder / "fit.json", fit_json(fit));
  write_file(folder / "params.toml",
             igm_parameters_toml(fit.best, {"Fitted by dendrofit. Regrow with:",
                                            fmt::format("  dendrofit grow params.toml --seed {} -o regrown",
                                                        fit.best_seed)}));
}

void say_parameters(const Session& session, const std::vector<FittedParameter>& parameters) {
  for (const FittedParameter& p : parameters) {
    if (p.identifiable)
      session.say(fmt::format("  {:<17} {:>8.4g}   {:.4g} to {:.4g} {}", p.key, p.value, p.lo, p.hi, p.unit));
    else
      session.say(fmt::format("  {:<17} not identifiable from this tree (anything from {:.4g} to {:.4g}{}{})",
                              p.key, p.lo, p.hi, p.unit.empty() ? "" : " ", p.unit));
  }
}

void say_fit(const Session& session, const TreeFit& fit) {
  session.say(fmt::format("Growth parameters ({} equation, 90 % intervals)", fit.best.equation));
  say_parameters(session, fit.parameters);
  session.say(fmt::format(
      "  distance    {:.2f} -> {:.2f} (seeds of one tree differ by {:.2f}); {} parameter sets; {}",
      fit.cost_before, fit.cost_after, fit.seed_floor, fit.evaluations, fit.stop_reason));
  for (const std::string& warning : fit.warnings) session.warn(warning);
}

}  // namespace dendrofit::cli
