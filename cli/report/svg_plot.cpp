// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/report/svg_plot.h"

#include "cli/report/annotations.h"
#include "cli/report/colours.h"
#include "cli/report/html.h"

#include <algorithm>
#include <cmath>

namespace dendrofit {
namespace {

constexpr double kWidth = 400;
constexpr double kHeight = 280;
constexpr double kLeft = 66;
constexpr double kRight = 14;
constexpr double kTop = 12;
constexpr double kBottom = 44;

struct Range {
  double lo = 1e300;
  double hi = -1e300;
  void add(double v) {
    if (!std::isfinite(v)) return;
    lo = std::min(lo, v);
    hi = std::max(hi, v);
  }
  bool empty() const { return lo > hi; }
};

std::string text(double x, double y, const std::string& anchor, const std::string& words,
                 const std::string& more = "") {
  return "<text x=\"" + fixed(x, 1) + "\" y=\"" + fixed(y, 1) + "\" text-anchor=\"" + anchor + "\"" + more +
         ">" + escape_html(words) + "</text>";
}

std::string segment(double x0, double y0, double x1, double y1, const std::string& kind) {
  return "<line class=\"" + kind + "\" x1=\"" + fixed(x0, 1) + "\" y1=\"" + fixed(y0, 1) + "\" x2=\"" +
         fixed(x1, 1) + "\" y2=\"" + fixed(y1, 1) + "\"/>";
}

std::string dashes(const PlotStyle& style) {
  return style.dashed ? " stroke-dasharray=\"7 4\"" : "";
}

}  // namespace

struct SvgPlot::Frame {
  Range x, y;
  bool log_y = false;
  double at_x(double v) const { return kLeft + (v - x.lo) / (x.hi - x.lo) * (kWidth - kLeft - kRight); }
  double at_y(double v) const {
    const double share = log_y ? (std::log10(v) - std::log10(y.lo)) / (std::log10(y.hi) - std::log10(y.lo))
                               : (v - y.lo) / (y.hi - y.lo);
    return kHeight - kBottom - std::clamp(share, -0.5, 1.5) * (kHeight - kTop - kBottom);
  }
  bool shows(double vx, double vy) const {
    return std::isfinite(vx) && std::isfinite(vy) && (!log_y || vy > 0);
  }
};

std::vector<double> round_ticks(double lo, double hi, int wanted) {
  std::vector<double> ticks;
  if (!(hi > lo) || wanted < 1) return {lo};
  double step = round_length((hi - lo) / wanted);
  while ((hi - lo) / step > 1.6 * wanted) step = round_length(step * 2.5);
  for (double k = std::ceil(lo / step - 1e-9); k * step <= hi + 1e-9 * step; ++k)
    ticks.push_back(k == 0 ? 0.0 : k * step);
  return ticks;
}

SvgPlot::SvgPlot(std::string title, std::string x_label, std::string y_label)
    : title_(std::move(title)), x_label_(std::move(x_label)), y_label_(std::move(y_label)) {}

void SvgPlot::line(const std::vector<double>& x, const std::vector<double>& y, PlotStyle style,
                   const std::string& name) {
  if (!x.empty() && x.size() == y.size()) series_.push_back({Kind::line, x, y, {}, style, name});
}
void SvgPlot::band(const std::vector<double>& x, const std::vector<double>& lo, const std::vector<double>& hi,
                   PlotStyle style, const std::string& name) {
  if (!x.empty() && x.size() == lo.size() && lo.size() == hi.size())
    series_.push_back({Kind::band, x, lo, hi, style, name});
}
void SvgPlot::points(const std::vector<double>& x, const std::vector<double>& y, PlotStyle style,
                     const std::string& name) {
  if (!x.empty() && x.size() == y.size()) series_.push_back({Kind::points, x, y, {}, style, name});
}
void SvgPlot::bars(const std::vector<double>& heights, PlotStyle style, const std::string& name) {
  if (!heights.empty()) series_.push_back({Kind::bars, {}, heights, {}, style, name});
}

std::string SvgPlot::draw(const Series& series, const Frame& frame, std::size_t bar_set,
                          std::size_t bar_sets) const {
  const std::string colour = hex(series.style.colour);
  std::string out;
  if (series.kind == Kind::line) {
    bool pen = false;
    for (std::size_t i = 0; i < series.x.size(); ++i) {
      const bool shown = frame.shows(series.x[i], series.y[i]);
      if (shown)
        out +=
            (pen ? "L" : "M") + fixed(frame.at_x(series.x[i]), 1) + " " + fixed(frame.at_y(series.y[i]), 1);
      pen = shown;
    }
    return "<path fill=\"none\" stroke=\"" + colour + "\" stroke-width=\"2\"" + dashes(series.style) +
           " d=\"" + out + "\"/>";
  }
  if (series.kind == Kind::band) {
    std::string back;
    for (std::size_t i = 0; i < series.x.size(); ++i) {
      if (!frame.shows(series.x[i], series.y[i]) || !frame.shows(series.x[i], series.hi[i])) continue;
      const std::string x = fixed(frame.at_x(series.x[i]), 1) + " ";
      out += (out.empty() ? "M" : "L") + x + fixed(frame.at_y(series.hi[i]), 1);
      back = "L" + x + fixed(frame.at_y(series.y[i]), 1) + back;
    }
    return "<path fill=\"" + colour + "\" fill-opacity=\"0.18\" d=\"" + out + back + "Z\"/>";
  }
  if (series.kind == Kind::points) {
    for (std::size_t i = 0; i < series.x.size(); ++i)
      if (frame.shows(series.x[i], series.y[i]))
        out += "<circle cx=\"" + fixed(frame.at_x(series.x[i]), 1) + "\" cy=\"" +
               fixed(frame.at_y(series.y[i]), 1) + "\" r=\"2.6\"/>";
    return "<g fill=\"" + (series.style.hollow ? std::string("none") : colour) + "\" stroke=\"" + colour +
           "\" fill-opacity=\"0.6\">" + out + "</g>";
  }
  const double slot =
      (kWidth - kLeft - kRight) / static_cast<double>(std::max<std::size_t>(1, categories_.size()));
  const double width = 0.8 * slot / static_cast<double>(bar_sets);
  for (std::size_t i = 0; i < series.y.size(); ++i) {
    if (!std::isfinite(series.y[i]) || series.y[i] <= 0) continue;
    const double left = kLeft + slot * (static_cast<double>(i) + 0.1) + width * static_cast<double>(bar_set);
    const double top = frame.at_y(series.y[i]);
    out += "<rect x=\"" + fixed(left, 1) + "\" y=\"" + fixed(top, 1) + "\" width=\"" + fixed(width, 1) +
           "\" height=\"" + fixed(std::max(0.0, kHeight - kBottom - top), 1) + "\"/>";
  }
  return "<g fill=\"" + colour + "\" fill-opacity=\"" + (series.style.hollow ? "0.28" : "0.9") +
         "\" stroke=\"" + colour + "\">" + out + "</g>";
}

std::string SvgPlot::legend() const {
  std::string out;
  for (const Series& series : series_) {
    if (series.name.empty()) continue;
    const std::string colour = hex(series.style.colour);
    std::string mark = "<line x1=\"1\" x2=\"23\" y1=\"6\" y2=\"6\" stroke-width=\"2.4\" stroke=\"" + colour +
                       "\"" + dashes(series.style) + "/>";
    if (series.kind == Kind::points)
      mark = "<circle cx=\"12\" cy=\"6\" r=\"3.4\" stroke=\"" + colour + "\" fill=\"" +
             (series.style.hollow ? std::string("none") : colour) + "\"/>";
    if (series.kind == Kind::bars || series.kind == Kind::band)
      mark = "<rect x=\"3\" y=\"1\" width=\"18\" height=\"10\" stroke=\"" +
             (series.kind == Kind::bars ? colour : std::string("none")) + "\" fill=\"" + colour +
             "\" fill-opacity=\"" +
             (series.kind == Kind::band ? "0.18"
              : series.style.hollow     ? "0.28"
                                        : "0.9") +
             "\"/>";
    out += "<span><svg width=\"24\" height=\"12\" aria-hidden=\"true\">" + mark + "</svg>" +
           escape_html(series.name) + "</span>";
  }
  return out.empty() ? "" : "<div class=\"legend\">" + out + "</div>";
}

std::string SvgPlot::figure(const std::string& id) const {
  Frame frame;
  frame.log_y = log_y_;
  std::size_t bar_sets = 0;
  for (const Series& series : series_) {
    for (double v : series.x) frame.x.add(v);
    for (const auto* values : {&series.y, &series.hi})
      for (double v : *values)
        if (!log_y_ || v > 0) frame.y.add(v);
    bar_sets += series.kind == Kind::bars;
  }
  if (frame.y.empty()) return "";
  if (bar_sets > 0 || zero_y_) frame.y.add(0);
  if (zero_x_) frame.x.add(0);
  if (frame.x.empty()) frame.x = {0, 1};
  for (Range* range : {&frame.x, &frame.y})
    if (!(range->hi > range->lo)) {
      const double slack = range->hi == 0 ? 1 : 0.1 * std::abs(range->hi);
      range->hi += slack;
      if (!log_y_) range->lo -= range->lo == 0 ? 0 : slack;
    }
  if (!log_y_) frame.y.hi += 0.04 * (frame.y.hi - frame.y.lo);

  std::string body;
  std::vector<double> y_ticks = round_ticks(frame.y.lo, frame.y.hi, 5);
  if (log_y_) {
    y_ticks.clear();
    for (double power = std::floor(std::log10(frame.y.lo)); power <= std::ceil(std::log10(frame.y.hi));
         ++power)
      for (double factor : {1.0, 2.0, 5.0}) {
        const double tick = factor * std::pow(10, power);
        const bool wide = frame.y.hi / frame.y.lo > 50;
        if (tick >= frame.y.lo * 0.999 && tick <= frame.y.hi * 1.001 && (!wide || factor == 1))
          y_ticks.push_back(tick);
      }
    if (y_ticks.size() < 2) y_ticks = {frame.y.lo, frame.y.hi};
  }
  for (double tick : y_ticks) {
    body += segment(kLeft, frame.at_y(tick), kWidth - kRight, frame.at_y(tick), "grid");
    body += text(kLeft - 6, frame.at_y(tick) + 4, "end", number(tick));
  }
  if (bar_sets > 0) {
    const double slot =
        (kWidth - kLeft - kRight) / static_cast<double>(std::max<std::size_t>(1, categories_.size()));
    std::size_t longest = 1;
    for (const std::string& name : categories_) longest = std::max(longest, name.size());
    const auto every = static_cast<std::size_t>(std::ceil(7.5 * static_cast<double>(longest) / slot));
    for (std::size_t i = 0; i < categories_.size(); i += every)
      body += text(kLeft + slot * (static_cast<double>(i) + 0.5), kHeight - kBottom + 16, "middle",
                   categories_[i]);
  } else {
    for (double tick : round_ticks(frame.x.lo, frame.x.hi, 6)) {
      body += segment(frame.at_x(tick), kTop, frame.at_x(tick), kHeight - kBottom, "grid");
      body += text(frame.at_x(tick), kHeight - kBottom + 16, "middle", number(tick));
    }
  }
  std::size_t bar_set = 0;
  for (const Series& series : series_) {
    body += draw(series, frame, bar_set, bar_sets) + "\n";
    bar_set += series.kind == Kind::bars;
  }
  body += segment(kLeft, kHeight - kBottom, kWidth - kRight, kHeight - kBottom, "axis") +
          segment(kLeft, kTop, kLeft, kHeight - kBottom, "axis");
  body += text(0.5 * (kLeft + kWidth - kRight), kHeight - 8, "middle", x_label_, " class=\"label\"");
  body += text(
      14, 0.5 * (kTop + kHeight - kBottom), "middle", y_label_,
      " class=\"label\" transform=\"rotate(-90 14 " + fixed(0.5 * (kTop + kHeight - kBottom), 1) + ")\"");
  return "<figure class=\"plot\" id=\"" + escape_html(id) + "\"><figcaption>" + escape_html(title_) +
         "</figcaption>" + legend() + "<svg viewBox=\"0 0 " + fixed(kWidth, 0) + " " + fixed(kHeight, 0) +
         "\" role=\"img\" aria-label=\"" + escape_html(title_) + "\">" + body + "</svg></figure>\n";
}

}  // namespace dendrofit
