// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/run_report.h"

#include "cli/fit_report.h"
#include "cli/output_folder.h"
#include "cli/report/annotations.h"
#include "cli/report/render.h"
#include "cli/report/report.h"
#include "cli/report_file.h"
#include "cli/version.h"
#include "core/atomic_file.h"
#include "core/range.h"

#include <algorithm>
#include <cmath>
#include <map>

#include <fmt/format.h>

namespace dendrofit::cli {
namespace {

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

std::vector<std::pair<std::string, std::string>> leaf_facts(const LeafReport& leaves) {
  return {{"Leaves", with_thousands(leaves.achieved_count)},
          {"Leaf area (one-sided)", fmt::format("{:.4g} m\xc2\xb2 of {:.4g} m\xc2\xb2 asked for",
                                                leaves.achieved_area_m2, leaves.requested_area_m2)},
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
  p.crs = r.observed.scan.crs_wkt;
  for (const OptionSpec& option : r.session.options().all())
    if (changes_results(option) && !option.current().empty())
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
  describe_fit(data, r.fit);
  data.curves = curves_of(r);
  data.leaf_facts = leaf_facts(r.leaves.report);
  // In the order of the stages; describe_fit() gave the fit's.
  const std::vector<std::string>& seen = r.observed.model.warnings;
  data.warnings.insert(data.warnings.begin(), seen.begin(), seen.end());
  const std::vector<std::string>& leafy = r.leaves.report.warnings;
  data.warnings.insert(data.warnings.end(), leafy.begin(), leafy.end());
  data.side_by_side_png = png;
  data.overlay_png = r.observed.overlay_png;
  data.provenance = provenance_of(r);
  write_file(folder / "report.json", report_json(data));
  write_file(folder / "report.html", make_report(data, {}, progress));
}

}  // namespace dendrofit::cli
