// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/report/plots.h"

#include "cli/report/annotations.h"
#include "cli/report/distributions.h"
#include "cli/report/html.h"
#include "cli/report/svg_plot.h"
#include "cli/report/tables.h"

#include <algorithm>
#include <cmath>

namespace dendrofit {
namespace {

constexpr PlotStyle kCapStyle = {{90, 90, 90}, true, false};
constexpr PlotStyle kMeasuredStyle = {{0, 0, 0}, false, true};
constexpr PlotStyle kLeafStyle = {{0, 120, 80}, false, false};

std::string growth(const ReportCurve& curve, std::size_t index) {
  const std::string unit = curve.value_unit.empty() ? "" : " (" + curve.value_unit + ")";
  SvgPlot plot("Growth: " + curve.name, curve.time_unit, curve.name + unit);
  plot.band(curve.time, curve.lo, curve.hi, kRegrownStyle, curve.band);
  plot.line(curve.time, curve.value, {kRegrownStyle.colour, false, false}, "regrown tree");
  std::vector<double> x;
  std::vector<double> y;
  for (const auto& [time, value] : curve.measured) {
    x.push_back(time);
    y.push_back(value);
  }
  plot.points(x, y, kMeasuredStyle, "measured");
  plot.include_zero_x();
  plot.include_zero_y();
  return plot.figure("plot-growth-" + std::to_string(index + 1));
}

/// What was added each cycle against what the growth equation allowed.
std::string increments(const ReportCurve& curve, std::size_t index) {
  if (curve.cap.empty()) return "";
  const std::string unit = curve.value_unit.empty() ? "" : " (" + curve.value_unit + ")";
  SvgPlot plot("Growth a " + curve.time_unit + ": " + curve.name, curve.time_unit, "added" + unit);
  std::vector<double> added(curve.value.size(), NAN);
  for (std::size_t i = 1; i < added.size(); ++i) added[i] = curve.value[i] - curve.value[i - 1];
  plot.line(curve.time, curve.cap, kCapStyle, "cap of the growth equation");
  plot.line(curve.time, added, {kRegrownStyle.colour, false, false}, "regrown tree");
  plot.include_zero_x();
  plot.include_zero_y();
  return plot.figure("plot-increment-" + std::to_string(index + 1));
}

void add_taper(SvgPlot& plot, const std::vector<TaperPoint>& taper, PlotStyle style, const std::string& name,
               bool as_points) {
  std::vector<double> x;
  std::vector<double> y;
  for (const TaperPoint& point : taper) {
    x.push_back(point.height_m);
    y.push_back(100 * point.diameter_m);
  }
  if (as_points)
    plot.points(x, y, style, name);
  else
    plot.line(x, y, style, name);
}

/// The stem's cylinders that were fitted to points of the scan.
std::vector<TaperPoint> fitted_stem(const Tree& model) {
  std::vector<TaperPoint> points;
  const double foot = model.empty() ? 0 : foot_height(model);
  for (std::size_t i = 0; i < model.size(); ++i)
    if (model.order[i] == 0 && model.quality[i] == RadiusQuality::measured)
      points.push_back({0.5 * (model.start[i].z() + model.end[i].z()) - foot, 2 * model.radius[i]});
  return points;
}

std::string taper(const ReportData& data) {
  SvgPlot plot("Stem taper", "height above the foot (m)", "diameter (cm)");
  std::vector<TaperPoint> measured = data.measured_taper;
  if (measured.empty() && data.model) measured = fitted_stem(*data.model);
  add_taper(plot, measured, kMeasuredStyle, "measured on the scan", true);
  if (data.model_metrics)
    add_taper(plot, data.model_metrics->stem_taper, kScanStyle, "model of the scan", false);
  if (data.regrown_metrics)
    add_taper(plot, data.regrown_metrics->stem_taper, kRegrownStyle, "regrown", false);
  plot.include_zero_x();
  plot.include_zero_y();
  return plot.figure("plot-taper");
}

std::string volumes(const ReportData& data, bool by_order) {
  const VolumeUnit unit = volume_unit(data);
  SvgPlot plot(by_order ? "Volume by branch order" : "Volume by diameter class",
               by_order ? "branch order (0 = stem)" : "diameter (cm)",
               std::string("volume (") + unit.words + ")");
  std::size_t classes = 1;
  for (const TreeMetrics* metrics : {data.model_metrics, data.regrown_metrics})
    if (metrics) classes = std::max(classes, metrics->volume_by_diameter_class_m3.size());
  const std::size_t merged = by_order ? 1 : (classes + 14) / 15;  // 2 cm classes a bar
  const auto in_unit = [&](const TreeMetrics& metrics) {
    const std::vector<double>& fine =
        by_order ? metrics.volume_by_order_m3 : metrics.volume_by_diameter_class_m3;
    std::vector<double> values((fine.size() + merged - 1) / merged, 0.0);
    for (std::size_t i = 0; i < fine.size(); ++i) values[i / merged] += unit.per_m3 * fine[i];
    return values;
  };
  std::size_t count = 0;
  for (const TreeMetrics* metrics : {data.model_metrics, data.regrown_metrics}) {
    if (!metrics) continue;
    const std::vector<double> values = in_unit(*metrics);
    count = std::max(count, values.size());
    plot.bars(values, metrics == data.model_metrics ? kScanStyle : kRegrownStyle,
              metrics == data.model_metrics ? "scan" : "regrown");
  }
  std::vector<std::string> names;
  for (std::size_t i = 0; i < count; ++i) {
    std::string name = std::to_string(by_order ? i : 2 * merged * i);
    if (!by_order) name += "\xe2\x80\x93" + std::to_string(2 * merged * (i + 1));
    names.push_back(name);
  }
  plot.categories(names);
  return plot.figure(by_order ? "plot-volume-order" : "plot-volume-diameter");
}

std::string branches(const ReportData& data, bool angles) {
  std::vector<std::pair<BranchValues, PlotStyle>> trees;
  if (data.model && !data.model->empty()) trees.emplace_back(branch_values(*data.model), kScanStyle);
  if (data.regrown && !data.regrown->empty()) trees.emplace_back(branch_values(*data.regrown), kRegrownStyle);
  // Lengths: bins reach to where 95 % of the branches are; longer ones share the last.
  double reach = 0.01;
  for (const auto& [values, style] : trees) {
    std::vector<double> lengths = values.length_m;
    if (lengths.empty()) continue;
    std::sort(lengths.begin(), lengths.end());
    reach = std::max(reach, lengths[lengths.size() * 95 / 100]);
  }
  const double step = angles ? 10 : round_length(reach / 6);
  const auto bins = angles ? std::size_t{12} : static_cast<std::size_t>(std::ceil(reach / step - 1e-9)) + 1;
  const double top = step * static_cast<double>(bins);
  SvgPlot plot(angles ? "Branch angle from the parent" : "Branch length",
               angles ? "degrees (bins from)" : "metres (bins from)", "share of branches (%)");
  for (const auto& [values, style] : trees) {
    const std::vector<double>& sample = angles ? values.angle_deg : values.length_m;
    if (sample.empty()) continue;
    std::vector<double> shares = histogram(sample, 0, top, bins);
    for (double& share : shares) share *= 100;
    plot.bars(shares, style,
              (style.dashed ? "regrown (n = " : "scan (n = ") + with_thousands(sample.size()) + ")");
  }
  std::vector<std::string> names;
  for (std::size_t i = 0; i < bins; ++i) {
    std::string name = number(step * static_cast<double>(i));
    if (i + 1 == bins) name.push_back('+');
    names.push_back(name);
  }
  plot.categories(names);
  return plot.empty() ? "" : plot.figure(angles ? "plot-branch-angle" : "plot-branch-length");
}

std::string profile(const ReportData& data) {
  double height = 0.1;
  for (const TreeMetrics* metrics : {data.model_metrics, data.regrown_metrics})
    if (metrics) height = std::max(height, metrics->height_m);
  const double step = std::max(0.02, round_length(height / 18));
  SvgPlot plot("Vertical profile", "area a metre of height (m\xc2\xb2/m)", "height above the foot (m)");
  const auto draw = [&](const HeightProfile& p, PlotStyle style, const std::string& name) {
    plot.line(p.area_per_m, p.height_m, style, name);
  };
  if (data.model) draw(wood_profile(*data.model, step), kScanStyle, "wood, scan");
  if (data.regrown) draw(wood_profile(*data.regrown, step), kRegrownStyle, "wood, regrown");
  const Tree* bearer = data.regrown && !data.leaves_on_model ? data.regrown : data.model;
  if (data.foliage && bearer) draw(leaf_profile(*data.foliage, *bearer, step), kLeafStyle, "leaves");
  plot.include_zero_x();
  plot.include_zero_y();
  return plot.figure("plot-profile");
}

std::string cost(const ReportData& data) {
  SvgPlot plot("Search: best cost so far", "evaluations", "cost");
  std::vector<double> x;
  std::vector<double> y;
  bool positive = true;
  for (const auto& [evaluation, value] : data.cost_by_evaluation) {
    if (!x.empty()) {  // a staircase: the best holds until the next one
      x.push_back(evaluation);
      y.push_back(y.back());
    }
    x.push_back(evaluation);
    y.push_back(value);
    positive = positive && value > 0;
  }
  if (positive && !y.empty() && y.front() > 5 * y.back()) plot.logarithmic_y();
  plot.line(x, y, {kScanStyle.colour, false, false}, "");
  return plot.figure("plot-cost");
}

std::string descriptors(const ReportData& data) {
  SvgPlot plot("Distance scan \xe2\x80\x93 regrown, by descriptor", "", "distance (0 = the same)");
  std::vector<double> before;
  std::vector<double> after;
  std::vector<std::string> names;
  bool any_before = false;
  for (std::size_t i = 0; i < data.descriptors.size(); ++i) {
    any_before = any_before || data.descriptors[i].before;
    before.push_back(data.descriptors[i].before.value_or(NAN));
    after.push_back(data.descriptors[i].after);
    names.push_back(std::to_string(i + 1));
  }
  if (any_before) plot.bars(before, {{150, 150, 150}, false, true}, "before the fit");
  plot.bars(after, kScanStyle, "after the fit");
  plot.categories(names);
  return plot.figure("plot-descriptors");
}

}  // namespace

std::string report_plots(const ReportData& data) {
  std::string out;
  for (std::size_t i = 0; i < data.curves.size(); ++i)
    out += growth(data.curves[i], i) + increments(data.curves[i], i);
  out += taper(data) + volumes(data, true) + volumes(data, false) + branches(data, true) +
         branches(data, false) + profile(data);
  out += cost(data) + descriptors(data);
  return out;
}

std::string parameter_plot(const std::vector<ReportParameter>& parameters) {
  constexpr double kRow = 26;
  constexpr double kLeft = 132;
  constexpr double kRight = 300;
  std::string body;
  double y = 8;
  for (const ReportParameter& p : parameters) {
    if (p.fixed || !p.prior_lo || !p.prior_hi || !(*p.prior_hi > *p.prior_lo)) continue;
    const auto at = [&](double v) {
      return kLeft + std::clamp((v - *p.prior_lo) / (*p.prior_hi - *p.prior_lo), 0.0, 1.0) * (kRight - kLeft);
    };
    const std::string colour = p.identifiable ? hex(kScanStyle.colour) : "#767676";
    const double middle = y + 0.5 * kRow;
    body += "<text x=\"" + fixed(kLeft - 10, 0) + "\" y=\"" + fixed(middle + 4, 1) +
            "\" text-anchor=\"end\">" + escape_html(p.symbol.empty() ? p.key : p.symbol) + "</text>";
    body += "<rect class=\"prior\" x=\"" + fixed(kLeft, 0) + "\" y=\"" + fixed(middle - 6, 1) +
            "\" width=\"" + fixed(kRight - kLeft, 0) + "\" height=\"12\"/>";
    if (p.lo && p.hi && std::isfinite(*p.lo) && std::isfinite(*p.hi))
      body += "<line x1=\"" + fixed(at(*p.lo), 1) + "\" x2=\"" +
              fixed(std::max(at(*p.hi), at(*p.lo) + 1), 1) + "\" y1=\"" + fixed(middle, 1) + "\" y2=\"" +
              fixed(middle, 1) + "\" stroke=\"" + colour + "\" stroke-width=\"5\"" +
              (p.identifiable ? "" : " stroke-dasharray=\"5 3\"") + "/>";
    if (std::isfinite(p.value))
      body += "<circle cx=\"" + fixed(at(p.value), 1) + "\" cy=\"" + fixed(middle, 1) +
              "\" r=\"5\" fill=\"#fff\" stroke=\"" + colour + "\" stroke-width=\"2.4\"/>";
    body += "<text class=\"small\" x=\"" + fixed(kRight + 8, 0) + "\" y=\"" + fixed(middle + 4, 1) + "\">" +
            escape_html(number(*p.prior_lo) + " to " + number(*p.prior_hi)) + "</text>";
    y += kRow;
  }
  if (body.empty()) return "";
  return "<figure class=\"plot\" id=\"plot-parameters\"><figcaption>Fitted parameters within their "
         "bounds</figcaption><div class=\"legend\"><span>grey bar: bounds before the fit</span><span>line: "
         "90 % interval (dashed: not identifiable)</span><span>ring: value</span></div><svg viewBox=\"0 0 "
         "440 " +
         fixed(y + 8, 0) + "\" role=\"img\" aria-label=\"Fitted parameters within their bounds\">" + body +
         "</svg></figure>\n";
}

}  // namespace dendrofit
