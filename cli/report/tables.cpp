// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/report/tables.h"

#include "cli/report/annotations.h"
#include "cli/report/html.h"

#include <algorithm>
#include <cmath>
#include <functional>

namespace dendrofit {
namespace {

struct MetricRow {
  const char* name;
  const char* unit;
  double factor;
  const char* interval;  ///< key in TreeMetrics::intervals, "" for none
  std::function<std::optional<double>(const TreeMetrics&)> value;
  bool headline = false;  ///< on the first screen
};

std::vector<MetricRow> metric_rows(const ReportData& data) {
  const VolumeUnit volume = volume_unit(data);
  const char* unit = volume.words;
  const double factor = volume.per_m3;
  using M = const TreeMetrics&;
  using Value = std::optional<double>;
  return {
      {"Height", "m", 1, "height_m", [](M m) -> Value { return m.height_m; }, true},
      {"Diameter at breast height", "cm", 100, "dbh_m", [](M m) -> Value { return m.dbh_m; }, true},
      {"Stem volume", unit, factor, "stem_volume_m3", [](M m) -> Value { return m.stem_volume_m3; }, true},
      {"Branch volume", unit, factor, "branch_volume_m3", [](M m) -> Value { return m.branch_volume_m3; },
       true},
      {"Total wood volume", unit, factor, "total_volume_m3", [](M m) -> Value { return m.total_volume_m3; },
       true},
      {"Wood surface", "m\xc2\xb2", 1, "wood_area_m2", [](M m) -> Value { return m.wood_area_m2; }},
      {"Length of all wood", "m", 1, "total_length_m", [](M m) -> Value { return m.total_length_m; }},
      {"Crown base", "m", 1, "crown_base_m", [](M m) -> Value { return m.crown_base_m; }, true},
      {"Crown diameter", "m", 1, "crown_diameter_m", [](M m) -> Value { return m.crown_diameter_m; }, true},
      {"Crown projection", "m\xc2\xb2", 1, "crown_area_m2", [](M m) -> Value { return m.crown_area_m2; }},
      {"Crown volume (hull)", "m\xc2\xb3", 1, "crown_volume_m3",
       [](M m) -> Value { return m.crown_volume_m3; }},
      {"Lean", "degrees", 1, "lean_deg", [](M m) -> Value { return m.lean_deg; }},
      {"Branches", "", 1, "", [](M m) -> Value {
         double count = 0;
         for (std::size_t order = 1; order < m.branch_count_by_order.size(); ++order)
           count += m.branch_count_by_order[order];
         return count;
       }}};
}

std::string interval(const Interval& range, double factor) {
  return measured(factor * range.lo) + " to " + measured(factor * range.hi);
}

/// "4.81 <span>(4.75 to 4.87)</span>".
std::string with_interval(const TreeMetrics& metrics, const MetricRow& row) {
  const std::optional<double> value = row.value(metrics);
  if (!value) return number(value);
  std::string cell = measured(row.factor * *value);
  const auto found = metrics.intervals.find(row.interval);
  if (found != metrics.intervals.end())
    cell += " <span class=\"quiet\">(" + interval(found->second, row.factor) + ")</span>";
  return cell;
}

std::string cards(std::string table) {
  const std::string plain = "<table id";
  return table.replace(table.find(plain), plain.size(), "<table class=\"cards\" id");
}

}  // namespace

VolumeUnit volume_unit(const ReportData& data) {
  double wood = 0;
  for (const TreeMetrics* metrics : {data.model_metrics, data.regrown_metrics})
    if (metrics) wood = std::max(wood, metrics->total_volume_m3);
  return wood < 1 ? VolumeUnit{"litres", 1000} : VolumeUnit{"m\xc2\xb3", 1};
}

std::string headline(const ReportData& data) {
  std::string out;
  std::string line;
  const auto add = [&](const std::string& words) { line += (line.empty() ? "" : " \xc2\xb7 ") + words; };
  if (!data.provenance.input_name.empty() && data.provenance.input_name != data.title)
    add("from " + escape_html(data.provenance.input_name));
  if (data.scan_points || data.scan)
    add(with_thousands(data.scan_points.value_or(data.scan ? data.scan->size() : 0)) + " points");
  if (data.model) add(with_thousands(data.model->size()) + " cylinders");
  if (data.foliage) add(with_thousands(data.foliage->size()) + " leaves");
  if (!data.growth_model.empty()) add(escape_html(data.growth_model));
  if (!line.empty()) out += "<p class=\"quiet\">" + line + "</p>\n";
  const TreeMetrics* metrics = data.model_metrics ? data.model_metrics : data.regrown_metrics;
  if (!metrics) return out;
  out += "<ul class=\"facts\" id=\"facts\">";
  for (const MetricRow& row : metric_rows(data)) {
    if (!row.headline) continue;
    const std::optional<double> value = row.value(*metrics);
    out += std::string("<li><span>") + row.name + "</span><b>" +
           (value ? measured(row.factor * *value) + " " + row.unit : number(value)) + "</b>";
    const auto found = metrics->intervals.find(row.interval);
    if (found != metrics->intervals.end())
      out += "<small>95 %: " + interval(found->second, row.factor) + "</small>";
    out += "</li>";
  }
  return out + "</ul>\n";
}

std::string warning_box(const ReportData& data) {
  if (data.warnings.empty()) return "";
  std::string out =
      "<div class=\"warnings\" id=\"warnings\"><strong>Worth knowing before you use these "
      "numbers</strong><ul>";
  for (const std::string& warning : data.warnings) out += "<li>" + escape_html(warning) + "</li>";
  return out + "</ul></div>\n";
}

std::string metrics_table(const ReportData& data) {
  if (!data.model_metrics && !data.regrown_metrics) return "";
  HtmlTable table{"table-metrics", "", {"Measure"}, {0}, {}};
  for (const auto& [metrics, name] :
       {std::pair{data.model_metrics, "Scan (model)"}, {data.regrown_metrics, "Regrown"}})
    if (metrics) {
      table.columns.push_back(name);
      table.numeric.push_back(1);
    }
  for (const MetricRow& row : metric_rows(data)) {
    const std::string unit = row.unit;
    std::vector<std::string> cells = {row.name + (unit.empty() ? unit : " (" + unit + ")")};
    for (const TreeMetrics* metrics : {data.model_metrics, data.regrown_metrics})
      if (metrics) cells.push_back(with_interval(*metrics, row));
    table.rows.push_back(cells);
  }
  const bool intervals = (data.model_metrics && !data.model_metrics->intervals.empty()) ||
                         (data.regrown_metrics && !data.regrown_metrics->intervals.empty());
  return cards(table.html()) +
         (intervals ? "<p class=\"quiet\">In brackets: 95 % intervals where they are estimated.</p>\n" : "");
}

std::string parameter_table(const ReportData& data) {
  if (data.parameters.empty()) return "";
  HtmlTable fitted{"table-parameters",
                   data.growth_model,
                   {"Parameter", "Meaning", "Value", "90 % interval", "Bounds", "Note"},
                   {0, 0, 1, 1, 1, 0},
                   {}};
  HtmlTable given{"table-given", "Given, not fitted", {"Parameter", "Meaning", "Value"}, {0, 0, 1}, {}};
  bool doubtful = false;
  for (const ReportParameter& p : data.parameters) {
    const auto range = [](const std::optional<double>& lo, const std::optional<double>& hi) {
      return lo && hi ? number(*lo) + " to " + number(*hi) : std::string("\xe2\x80\x93");
    };
    const std::string name =
        "<code>" + escape_html(p.key) + "</code>" +
        (p.symbol.empty() || p.symbol == p.key ? "" : " (" + escape_html(p.symbol) + ")");
    const std::string value =
        number(p.value) + (p.unit.empty() || p.unit == "1" ? "" : " " + escape_html(p.unit));
    if (p.fixed) {
      given.rows.push_back({name, escape_html(p.meaning), value});
      continue;
    }
    doubtful = doubtful || !p.identifiable;
    fitted.rows.push_back({name, escape_html(p.meaning), value, range(p.lo, p.hi),
                           range(p.prior_lo, p.prior_hi),
                           p.identifiable ? "" : "<span class=\"flag\">not identifiable</span>"});
  }
  std::string out;
  if (!data.fit_status.empty()) out += "<p>" + escape_html(data.fit_status) + "</p>\n";
  if (!fitted.rows.empty()) out += cards(fitted.html());
  if (doubtful)
    out +=
        "<p class=\"quiet\">\xe2\x80\x9cNot identifiable\xe2\x80\x9d: this tree alone does not tell the "
        "value from others within its interval; do not read biology into it.</p>\n";
  if (!given.rows.empty()) out += cards(given.html());
  return out;
}

std::string descriptor_table(const ReportData& data) {
  if (data.descriptors.empty()) return "";
  HtmlTable table{"table-descriptors", "", {"Descriptor", "Before the fit", "After the fit"}, {0, 1, 1}, {}};
  for (std::size_t i = 0; i < data.descriptors.size(); ++i)
    table.rows.push_back({std::to_string(i + 1) + ". " + escape_html(data.descriptors[i].name),
                          number(data.descriptors[i].before), number(data.descriptors[i].after)});
  return table.html() +
         "<p class=\"quiet\">Distance between the scanned and the regrown tree; 0 is the same.</p>\n";
}

std::string leaf_table(const ReportData& data) {
  if (data.leaf_facts.empty()) return "";
  HtmlTable table{"table-leaves", "", {"What", "Value"}, {0, 1}, {}};
  for (const auto& [name, value] : data.leaf_facts)
    table.rows.push_back({escape_html(name), escape_html(value)});
  return table.html();
}

std::string provenance_tables(const ReportData& data) {
  const ReportProvenance& p = data.provenance;
  HtmlTable made{"table-provenance", "", {"What", "Value"}, {0, 0}, {}};
  const auto row = [&](const char* name, const std::string& value) {
    if (!value.empty()) made.rows.push_back({name, "<code>" + escape_html(value) + "</code>"});
  };
  row("Program", p.program + " " + p.version);
  row("Command", p.command_line);
  row("Input", p.input_name);
  row("Input checksum", p.input_checksum);
  row("Coordinate system", p.crs);
  if (p.seed) row("Seed", std::to_string(*p.seed));
  std::string out = made.html();
  if (!p.options.empty()) {
    HtmlTable options{"table-options", "Options", {"Option", "Value"}, {0, 0}, {}};
    for (const auto& [name, value] : p.options)
      options.rows.push_back(
          {"<code>" + escape_html(name) + "</code>", "<code>" + escape_html(value) + "</code>"});
    out += options.html();
  }
  if (!p.stages.empty()) {
    HtmlTable stages{"table-stages", "Time by stage", {"Stage", "Seconds"}, {0, 1}, {}};
    double sum = 0;
    for (const ReportStage& stage : p.stages) {
      stages.rows.push_back({escape_html(stage.name), fixed(stage.seconds, 1)});
      sum += stage.seconds;
    }
    stages.rows.push_back({"<strong>All</strong>", "<strong>" + fixed(sum, 1) + "</strong>"});
    out += stages.html();
  }
  return out;
}

}  // namespace dendrofit
