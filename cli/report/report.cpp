// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/report/report.h"

#include "cli/report/annotations.h"
#include "cli/report/colours.h"
#include "cli/report/html.h"
#include "cli/report/page_style.h"
#include "cli/report/plots.h"
#include "cli/report/scene_payload.h"
#include "cli/report/tables.h"
#include "cli/report/viewer_bundle.h"
#include "core/errors.h"

#include <cmath>

namespace dendrofit {
namespace {

void check(const ReportData& data) {
  for (const Tree* tree : {data.model, data.regrown})
    if (tree) tree->validate();
  if (data.scan) data.scan->validate();
  for (const ReportCurve& curve : data.curves)
    for (const auto* column : {&curve.value, &curve.cap, &curve.lo, &curve.hi})
      if (!column->empty() && column->size() != curve.time.size())
        throw InputError("report: curve '" + curve.name + "' has " + std::to_string(column->size()) +
                         " values for " + std::to_string(curve.time.size()) + " times; they must be equal");
}

std::string section(const std::string& id, const std::string& heading, const std::string& body) {
  return body.empty() ? "" : "<section id=\"" + id + "\"><h2>" + heading + "</h2>\n" + body + "</section>\n";
}

std::string view(const ReportData& data, const ReportOptions& options) {
  const ScenePayload payload = scene_payload(data, options);
  if (payload.binary.empty()) return "";
  if (!has_viewer())
    return "<div id=\"viewer\"><p class=\"missing\">The 3-D view is not in this report: this build of "
           "dendrofit was made without it (it needs Node.js and npm while building; see README). Pictures, "
           "plots and tables are complete.</p></div>";
  std::string note;
  if (data.scan && payload.scan_shown < data.scan_points.value_or(data.scan->size()))
    note += "The view shows " + with_thousands(payload.scan_shown) + " of the scan's " +
            with_thousands(data.scan_points.value_or(data.scan->size())) + " points. ";
  if (data.foliage && payload.leaves_shown < data.foliage->size())
    note += "The view shows " + with_thousands(payload.leaves_shown) + " of " +
            with_thousands(data.foliage->size()) + " leaves, larger so that the area stays. ";
  std::string palette;
  for (const Rgb& colour : kOrderColours) palette += (palette.empty() ? "\"" : ",\"") + hex(colour) + "\"";
  std::string qualities;
  for (int q = 0; q < 4; ++q)
    qualities += (q ? ",[" : "[") + quote_json(to_string(static_cast<RadiusQuality>(q))) + ",\"" +
                 hex(quality_colour(static_cast<RadiusQuality>(q))) + "\"]";
  std::string ramp;
  for (int k = 0; k <= 10; ++k) ramp += (k ? ",\"" : "\"") + hex(scale_colour(k / 10.0)) + "\"";
  const std::string colours = "\"colours\":{\"order\":[" + palette + "],\"quality\":[" + qualities +
                              "],\"ramp\":[" + ramp + "],\"bark\":\"" + hex(kBark) + "\",\"leaf\":\"" +
                              hex(kLeaf) + "\",\"scan\":\"" + hex(kScan) + "\"}";
  return "<div id=\"viewer\"><p class=\"missing\">The 3-D view is being prepared. If this line stays, this "
         "browser runs no scripts or has no WebGL; the picture below shows the same.</p></div>\n<p "
         "class=\"quiet\">" +
         note +
         "Drag to turn, scroll or pinch to zoom, right-drag to move; click a cylinder to read it. By "
         "keyboard: "
         "arrows, + and -, Home; Page Down and Page Up go from cylinder to cylinder.</p>\n"
         "<script type=\"application/json\" id=\"scene\">{" +
         colours + ",\"layers\":" + payload.directory +
         "}</script>\n<script type=\"text/plain\" id=\"scene-data\">" + base64(payload.binary) +
         "</script>\n<script>" + std::string(viewer_bundle()) + "</script>\n";
}

std::string picture(const ReportData& data) {
  if (data.side_by_side_png.empty()) return "";
  return "<figure class=\"picture\"><img id=\"side-by-side\" alt=\"The scan, the model, the regrown tree and "
         "the tree with leaves, side by side at one scale\" src=\"data:image/png;base64," +
         base64(data.side_by_side_png) + "\"></figure>";
}

std::string overlay(const ReportData& data) {
  if (data.overlay_png.empty()) return "";
  return "<figure class=\"picture\"><img id=\"overlay\" alt=\"The model drawn over its photograph, coloured "
         "by branch "
         "order\" src=\"data:image/png;base64," +
         base64(data.overlay_png) + "\"></figure>";
}

}  // namespace

bool has_viewer() {
  return !viewer_bundle().empty();
}

void ReportOptions::validate() const {
  require(max_scan_points >= 0 && max_scan_points <= 5'000'000, "max_scan_points", max_scan_points,
          "must be 0 to 5000000");
  require(max_leaves >= 0 && max_leaves <= 2'000'000, "max_leaves", max_leaves, "must be 0 to 2000000");
}

std::string make_report(const ReportData& data, const ReportOptions& options, Progress& progress) {
  options.validate();
  check(data);
  progress.check();
  const std::string title = escape_html(data.title.empty() ? "Tree" : data.title);
  std::string page =
      "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
      "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; script-src "
      "'unsafe-inline'; style-src 'unsafe-inline'; img-src data: blob:\">\n"
      "<link rel=\"icon\" href=\"data:,\">\n<title>" +
      title + " \xc2\xb7 dendrofit</title>\n<style>" + std::string(page_style()) +
      "</style></head>\n<body>\n<header><h1>" + title + "</h1>\n" + headline(data) + warning_box(data) +
      "</header>\n<main>\n";
  page += section("view", "The tree in three dimensions", view(data, options));
  progress.check();
  page += section("picture", "Side by side", picture(data));
  page += section("overlay", "The model over its photograph", overlay(data));
  page += section("metrics", "Measures", metrics_table(data));
  const std::string plots = report_plots(data);
  page += section("plots", "Plots", plots.empty() ? "" : "<div class=\"plots\">" + plots + "</div>");
  const std::string intervals = parameter_plot(data.parameters);
  page += section(
      "parameters", "Growth parameters",
      parameter_table(data) + (intervals.empty() ? "" : "<div class=\"plots\">" + intervals + "</div>"));
  page += section("distances", "How near the regrown tree comes", descriptor_table(data));
  page += section("leaves", "Leaves", leaf_table(data));
  page += section("provenance", "How this was made", provenance_tables(data));
  page += "</main>\n<footer>Made by " + escape_html(data.provenance.program + " " + data.provenance.version) +
          ". One file; nothing is loaded from the network.</footer>\n</body></html>\n";
  return page;
}

}  // namespace dendrofit
