// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/fit_report.h"

#include "fit/descriptors.h"

#include <algorithm>
#include <cctype>
#include <cmath>

#include <fmt/format.h>

namespace dendrofit::cli {
namespace {

std::vector<ReportParameter> parameters_of(const TreeFit& fit) {
  const std::vector<ParameterSpec> table = igm_parameter_table(fit.best.equation);
  std::vector<ReportParameter> rows;
  for (const ParameterSpec& spec : table) {
    ReportParameter row;
    row.key = spec.key;
    row.symbol = spec.symbol;
    row.unit = spec.unit;
    row.meaning = spec.meaning;
    row.value = fit.best.get(spec.key);
    const auto fitted = std::find_if(fit.parameters.begin(), fit.parameters.end(),
                                     [&](const FittedParameter& p) { return p.key == spec.key; });
    row.fixed = fitted == fit.parameters.end();
    if (!row.fixed) {
      row.lo = fitted->lo;
      row.hi = fitted->hi;
      row.prior_lo = fitted->prior_lo;
      row.prior_hi = fitted->prior_hi;
      row.identifiable = fitted->identifiable;
    }
    rows.push_back(std::move(row));
  }
  // What was fitted first, in the order of the search.
  std::stable_partition(rows.begin(), rows.end(), [](const ReportParameter& r) { return !r.fixed; });
  return rows;
}

std::vector<ReportDescriptor> descriptors_of(const TreeFit& fit) {
  std::vector<ReportDescriptor> rows;
  for (const DescriptorFit& d : fit.descriptors)
    rows.push_back({explained(d.name), std::abs(d.before - d.observed) / d.noise,
                    std::abs(d.after - d.observed) / d.noise});
  return rows;
}

}  // namespace

std::string explained(std::string text) {
  for (const DescriptorRow& row : descriptor_table()) {
    const std::string name(row.name);
    if (name.find('_') == std::string::npos) continue;
    const auto part_of_name = [](char c) { return std::isalnum(static_cast<unsigned char>(c)) || c == '_'; };
    for (std::size_t at = text.find(name); at != std::string::npos; at = text.find(name, at)) {
      const std::size_t end = at + name.size();
      const bool whole =
          (at == 0 || !part_of_name(text[at - 1])) && (end == text.size() || !part_of_name(text[end]));
      at = end;
      if (!whole) continue;
      const std::string meaning = " (" + std::string(row.meaning) + ")";
      text.insert(end, meaning);
      at += meaning.size();
    }
  }
  return text;
}

void describe_fit(ReportData& data, const TreeFit& fit) {
  data.growth_model = fmt::format("IGM (Yi et al. 2018), {} equation", fit.best.equation);
  data.fit_status = fmt::format(
      "{} parameter sets tried; {}. Distance of the regrown trees from the scanned one: {:.2f} "
      "before, {:.2f} after the fit; trees of one parameter set differ by {:.2f}.",
      fit.evaluations, fit.stop_reason, fit.cost_before, fit.cost_after, fit.seed_floor);
  data.parameters = parameters_of(fit);
  data.descriptors = descriptors_of(fit);
  for (std::size_t i = 0; i < fit.cost_history.size(); ++i)
    data.cost_by_evaluation.emplace_back(static_cast<double>(i + 1), fit.cost_history[i]);
  for (const std::string& warning : fit.warnings) data.warnings.push_back(explained(warning));
}

}  // namespace dendrofit::cli
