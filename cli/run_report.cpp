// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/run_report.h"

#include "cli/output_folder.h"
#include "cli/report/render.h"
#include "cli/report/report.h"
#include "cli/version.h"
#include "core/atomic_file.h"
#include "core/range.h"
#include "fit/descriptors.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <map>

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

constexpr int kOtherSeeds = 8;

/// Heights and diameters of trees of the same parameters and other seeds, cycle by cycle: what chance alone
/// makes.
struct ChanceBands {
  std::map<int, Range> height, diameter;
};

ChanceBands grow_with_other_seeds(const RunResults& r) {
  ChanceBands bands;
  const auto widen = [&](const std::vector<GrowthRecord>& series) {
    for (const GrowthRecord& record : series) {
      bands.height[record.cycle].add(record.height_m);
      if (record.dbh_m) bands.diameter[record.cycle].add(100 * *record.dbh_m);
    }
  };
  widen(r.regrown.series);
  for (int k = 1; k <= kOtherSeeds; ++k) {
    IgmOptions options;
    options.seed = r.fit.best_seed + static_cast<std::uint64_t>(k);
    widen(grow_igm(r.fit.best, {}, options, r.session.progress()).series);
  }
  return bands;
}

void set_band(ReportCurve& curve, const std::map<int, Range>& bands) {
  curve.band = fmt::format("range over {} seeds", kOtherSeeds + 1);
  for (const double time : curve.time) {
    const Range& at = bands.at(static_cast<int>(time));
    curve.lo.push_back(at.lo);
    curve.hi.push_back(at.hi);
  }
}

std::vector<ReportCurve> curves_of(const RunResults& r) {
  const ChanceBands bands = grow_with_other_seeds(r);
  ReportCurve height;
  height.name = "height";
  ReportCurve diameter;
  diameter.name = "diameter at breast height";
  diameter.value_unit = "cm";
  for (const GrowthRecord& record : r.regrown.series) {
    height.time.push_back(record.cycle);
    height.value.push_back(record.height_m);
    height.cap.push_back(record.cycle > 0 ? r.fit.best.cap(record.cycle) * r.fit.best.rho_m : std::nan(""));
    if (!record.dbh_m) continue;
    diameter.time.push_back(record.cycle);
    diameter.value.push_back(100 * *record.dbh_m);
  }
  set_band(height, bands.height);
  set_band(diameter, bands.diameter);
  const double now = r.regrown.series.empty() ? 0 : r.regrown.series.back().cycle;
  height.measured = {{now, r.observed.model.metrics.height_m}};
  if (r.observed.model.metrics.dbh_m) diameter.measured = {{now, 100 * *r.observed.model.metrics.dbh_m}};
  std::vector<ReportCurve> curves = {height};
  if (!diameter.time.empty()) curves.push_back(diameter);
  return curves;
}

/// Descriptors' names with what they mean: "reach_80 (crown radius about ...)". Names that are plain words
/// stay.
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

std::vector<ReportDescriptor> descriptors_of(const TreeFit& fit) {
  std::vector<ReportDescriptor> rows;
  for (const DescriptorFit& d : fit.descriptors)
    rows.push_back({explained(d.name), std::abs(d.before - d.observed) / d.noise,
                    std::abs(d.after - d.observed) / d.noise});
  return rows;
}

std::vector<std::pair<std::string, std::string>> leaf_facts(const LeafReport& leaves) {
  return {{"Leaves", fmt::format("{}", leaves.achieved_count)},
          {"Leaf area (one-sided)", fmt::format("{:.4g} m2 of {:.4g} m2 asked for", leaves.achieved_area_m2,
                                                leaves.requested_area_m2)},
          {"LAI over the crown projection", fmt::format("{:.2f}", leaves.lai)},
          {"Intersections", "none: every pair closer than its reach was tested"}};
}

ReportProvenance provenance_of(const RunResults& r) {
  ReportProvenance p;
  p.version = version();
  p.seed = r.session.common().seed;
  p.command_line = fmt::format("dendrofit {} {}", r.session.command(), r.observed.file().filename().string());
  p.input_name = r.observed.file().filename().string();
  p.input_checksum = "crc32:" + checksum(r.observed.file());
  for (const OptionSpec& option : r.session.options().all())
    if (!option.positional && !option.current().empty())
      p.options.emplace_back(option.name, option.current());
  for (const auto& [stage, seconds] : r.watch.laps()) p.stages.push_back({stage, seconds});
  return p;
}

}  // namespace

void write_run_report(const std::filesystem::path& folder, const RunResults& r) {
  Progress& progress = r.session.progress();
  RenderOptions picture;
  picture.threads = r.session.common().threads;
  const PointCloud* scan = r.observed.scan.empty() ? nullptr : &r.observed.scan;
  const SideBySide content{scan, &r.observed.model.tree, &r.regrown.tree, &r.leaves.foliage, false};
  const std::string png = encode_png(side_by_side(content, picture, progress));
  write_file(folder / "side_by_side.png", png);
  r.watch.lap("picture");

  ReportData data;
  data.title = r.observed.file().stem().string();
  data.scan = scan;
  data.model = &r.observed.model.tree;
  data.regrown = &r.regrown.tree;
  data.foliage = &r.leaves.foliage;
  data.model_metrics = &r.observed.model.metrics;
  data.regrown_metrics = &r.regrown_metrics;
  data.growth_model = fmt::format("IGM (Yi et al. 2018), {} equation", r.fit.best.equation);
  data.fit_status = fmt::format(
      "{} parameter sets tried; {}. Distance of the regrown trees from the scanned one: {:.2f} "
      "before, {:.2f} after the fit; trees of one parameter set differ by {:.2f}.",
      r.fit.evaluations, r.fit.stop_reason, r.fit.cost_before, r.fit.cost_after, r.fit.seed_floor);
  data.parameters = parameters_of(r.fit);
  data.curves = curves_of(r);
  data.descriptors = descriptors_of(r.fit);
  for (std::size_t i = 0; i < r.fit.cost_history.size(); ++i)
    data.cost_by_evaluation.emplace_back(static_cast<double>(i + 1), r.fit.cost_history[i]);
  data.leaf_facts = leaf_facts(r.leaves.report);
  for (const auto* list : {&r.observed.model.warnings, &r.fit.warnings, &r.leaves.report.warnings})
    for (const std::string& warning : *list) data.warnings.push_back(explained(warning));
  data.side_by_side_png = png;
  data.overlay_png = r.observed.overlay_png;
  data.provenance = provenance_of(r);
  write_file(folder / "report.html", make_report(data, {}, progress));
}

}  // namespace dendrofit::cli
