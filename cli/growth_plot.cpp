// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/growth_plot.h"

#include "cli/growth_table.h"
#include "cli/report/html.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include <fmt/format.h>

namespace dendrofit::cli {
namespace {

constexpr double kWidth = 640, kHeight = 450;
constexpr double kLeft = 70, kRight = 620, kTop = 52, kBottom = 400;
constexpr Rgb kInk{51, 51, 51}, kGrid{228, 228, 228}, kCurve{46, 107, 31}, kConfidence{185, 216, 174},
    kPrediction{230, 240, 226};

std::string brief(double x) {
  return fmt::format("{:.4g}", x == 0 ? 0.0 : x);
}

struct Point {
  double x = 0, y = 0;
};

/// What a picture is drawn with, in units of the SVG.
class Canvas {
 public:
  virtual ~Canvas() = default;
  virtual void line(Point from, Point to, double width, Rgb colour) = 0;
  virtual void polyline(const std::vector<Point>& points, double width, Rgb colour) = 0;
  /// Between two chains over the same x, rising.
  virtual void band(const std::vector<Point>& high, const std::vector<Point>& low, Rgb colour) = 0;
  virtual void dot(Point at, double radius, Rgb colour) = 0;
  virtual void text(Point at, const std::string& words, double size, TextAnchor anchor) = 0;
};

class SvgCanvas : public Canvas {
 public:
  SvgCanvas() {
    out_ = fmt::format(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {0} {1}\" font-family=\"sans-serif\">\n"
        "<rect width=\"{0}\" height=\"{1}\" fill=\"white\"/>\n",
        kWidth, kHeight);
  }
  void line(Point a, Point b, double width, Rgb colour) override { polyline({a, b}, width, colour); }
  void polyline(const std::vector<Point>& points, double width, Rgb colour) override {
    out_ += fmt::format("<polyline fill=\"none\" stroke=\"{}\" stroke-width=\"{}\" points=\"{}\"/>\n",
                        hex(colour), width, list(points));
  }
  void band(const std::vector<Point>& high, const std::vector<Point>& low, Rgb colour) override {
    std::vector<Point> around = high;
    around.insert(around.end(), low.rbegin(), low.rend());
    out_ += fmt::format("<polygon fill=\"{}\" points=\"{}\"/>\n", hex(colour), list(around));
  }
  void dot(Point at, double radius, Rgb colour) override {
    out_ += fmt::format("<circle r=\"{}\" fill=\"{}\" cx=\"{:.2f}\" cy=\"{:.2f}\"/>\n", radius, hex(colour),
                        at.x, at.y);
  }
  void text(Point at, const std::string& words, double size, TextAnchor anchor) override {
    constexpr const char* names[] = {"start", "middle", "end"};
    out_ += fmt::format("<text x=\"{:.2f}\" y=\"{:.2f}\" font-size=\"{}\" text-anchor=\"{}\">{}</text>\n",
                        at.x, at.y, size, names[static_cast<std::size_t>(anchor)], escape_html(words));
  }
  std::string take() { return out_ + "</svg>\n"; }

 private:
  static std::string hex(Rgb c) { return fmt::format("#{:02x}{:02x}{:02x}", c.r, c.g, c.b); }
  static std::string list(const std::vector<Point>& points) {
    std::string text;
    for (const Point& p : points) text += fmt::format("{}{:.2f},{:.2f}", text.empty() ? "" : " ", p.x, p.y);
    return text;
  }
  std::string out_;
};

class ImageCanvas : public Canvas {
 public:
  void line(Point a, Point b, double width, Rgb colour) override {
    draw_line(image_, kScale * a.x, kScale * a.y, kScale * b.x, kScale * b.y, kScale * width, colour);
  }
  void polyline(const std::vector<Point>& points, double width, Rgb colour) override {
    for (std::size_t i = 0; i + 1 < points.size(); ++i) line(points[i], points[i + 1], width, colour);
  }
  void band(const std::vector<Point>& high, const std::vector<Point>& low, Rgb colour) override {
    for (std::size_t i = 0; i + 1 < high.size(); ++i) {
      const int first = static_cast<int>(std::ceil(kScale * high[i].x));
      const int last = static_cast<int>(std::ceil(kScale * high[i + 1].x));
      for (int x = first; x < last; ++x) {
        const double share = (x / kScale - high[i].x) / (high[i + 1].x - high[i].x);
        const auto between = [&](const std::vector<Point>& chain) {
          return kScale * (chain[i].y + share * (chain[i + 1].y - chain[i].y));
        };
        fill_box(image_, x, static_cast<int>(std::lround(between(high))), x + 1,
                 static_cast<int>(std::lround(between(low))), colour);
      }
    }
  }
  void dot(Point at, double radius, Rgb colour) override { line(at, at, 2 * radius, colour); }
  void text(Point at, const std::string& words, double size, TextAnchor anchor) override {
    constexpr double kCapital = 0.72;  // of a font's size
    draw_text(image_, kScale * at.x, kScale * at.y, words, kScale * kCapital * size, kInk, anchor);
  }
  Image take() { return std::move(image_); }

 private:
  static constexpr double kScale = 2;
  Image image_{static_cast<int>(kScale * kWidth), static_cast<int>(kScale* kHeight), {255, 255, 255}};
};

// Round steps 1, 2, 5 x 10^k, about `count` of them up to `range`.
double tick_step(double range, int count) {
  const double raw = range / count, power = std::pow(10, std::floor(std::log10(raw)));
  for (double factor : {1.0, 2.0, 5.0})
    if (raw <= factor * power) return factor * power;
  return 10 * power;
}

struct Range {
  double lo = 0, hi = 0;
  void add(double v) {
    if (!std::isfinite(v)) return;
    lo = std::min(lo, v);
    hi = std::max(hi, v);
  }
};

// Data coordinates to the drawing's.
struct Frame {
  Range x, y;
  double step_x = 1, step_y = 1;

  explicit Frame(const CurvePicture& picture) {
    for (double v : picture.x) x.add(v);
    for (double v : picture.y) y.add(v);
    const double most = 1.5 * y.hi, least = y.lo - 0.5 * (y.hi - y.lo);
    for (const GrowthBandPoint& p : picture.curve) {
      x.add(p.time);
      y.add(std::clamp(p.prediction_hi, least, most));
      y.add(std::clamp(p.fit, least, most));
    }
    step_x = round_outwards(x, 8);
    step_y = round_outwards(y, 7);
  }
  Point at(double t, double v) const {
    return {kLeft + (t - x.lo) / (x.hi - x.lo) * (kRight - kLeft),
            kBottom - (std::clamp(v, y.lo, y.hi) - y.lo) / (y.hi - y.lo) * (kBottom - kTop)};
  }

 private:
  static double round_outwards(Range& range, int count) {
    if (!(range.hi > range.lo)) range.hi = range.lo + 1;
    const double step = tick_step(range.hi - range.lo, count);
    range.lo = step * std::floor(range.lo / step + 1e-9);
    range.hi = step * std::ceil(range.hi / step - 1e-9);
    return step;
  }
};

std::vector<double> ticks(const Range& range, double step) {
  std::vector<double> values;
  const auto count = std::lround((range.hi - range.lo) / step);
  for (long k = 0; k <= count; ++k) {
    const double v = range.lo + static_cast<double>(k) * step;
    values.push_back(std::abs(v) < 1e-9 * step ? 0 : v);
  }
  return values;
}

void draw_band(Canvas& canvas, const Frame& frame, const std::vector<GrowthBandPoint>& curve,
               double GrowthBandPoint::*lo, double GrowthBandPoint::*hi, Rgb colour) {
  std::vector<Point> high, low;
  for (const GrowthBandPoint& p : curve) {
    if (!std::isfinite(p.*lo) || !std::isfinite(p.*hi)) continue;
    high.push_back(frame.at(p.time, p.*hi));
    low.push_back(frame.at(p.time, p.*lo));
  }
  if (high.size() > 1) canvas.band(high, low, colour);
}

void draw(const CurvePicture& picture, Canvas& canvas) {
  canvas.text({kLeft, 20}, picture.title, 15, TextAnchor::left);
  if (picture.x.empty()) return canvas.text({kLeft, 60}, "no measurements", 13, TextAnchor::left);
  const Frame frame(picture);
  for (double t : ticks(frame.x, frame.step_x)) {
    const double x = frame.at(t, 0).x;
    canvas.line({x, kTop}, {x, kBottom}, 1, kGrid);
    canvas.text({x, kBottom + 18}, brief(t), 13, TextAnchor::middle);
  }
  for (double v : ticks(frame.y, frame.step_y)) {
    const double y = frame.at(frame.x.lo, v).y;
    canvas.line({kLeft, y}, {kRight, y}, 1, kGrid);
    canvas.text({kLeft - 8, y + 4}, brief(v), 13, TextAnchor::right);
  }
  draw_band(canvas, frame, picture.curve, &GrowthBandPoint::prediction_lo, &GrowthBandPoint::prediction_hi,
            kPrediction);
  draw_band(canvas, frame, picture.curve, &GrowthBandPoint::confidence_lo, &GrowthBandPoint::confidence_hi,
            kConfidence);
  std::vector<Point> line;
  for (const GrowthBandPoint& p : picture.curve)
    if (std::isfinite(p.fit)) line.push_back(frame.at(p.time, p.fit));
  if (line.size() > 1) canvas.polyline(line, 2, kCurve);
  const double radius = picture.x.size() > 300 ? 1.5 : 3;
  for (std::size_t i = 0; i < picture.x.size(); ++i)
    if (std::isfinite(picture.x[i]) && std::isfinite(picture.y[i]))
      canvas.dot(frame.at(picture.x[i], picture.y[i]), radius, kInk);
  canvas.polyline({{kLeft, kTop}, {kRight, kTop}, {kRight, kBottom}, {kLeft, kBottom}, {kLeft, kTop}}, 1,
                  kInk);
  canvas.text({0.5 * (kLeft + kRight), kHeight - 12}, picture.x_label, 13, TextAnchor::middle);
  canvas.text({12, kTop - 12}, picture.y_label, 13, TextAnchor::left);
}

}  // namespace

CurvePicture growth_picture(const GrowthReport& report, const GrowthSeries* series) {
  if (!series)
    series = report.pooled ? &*report.pooled : report.series.empty() ? nullptr : &report.series.front();
  CurvePicture picture;
  picture.x_label = report.abscissa + " (" + report.time_unit + ")";
  picture.y_label = report.ordinate + " (" + report.value_unit + ")";
  if (!series) return picture;
  picture.title = series->name;
  picture.x = series->time;
  picture.y = series->value;
  const GrowthFit* fit = series->best.empty() ? nullptr : series->fit(series->best);
  if (!fit) return picture;
  picture.curve = fit->bands;
  picture.title += fmt::format(": {}, {:.4g} % bands", form_title(fit->equation), 100 * report.confidence);
  return picture;
}

std::string curve_svg(const CurvePicture& picture) {
  SvgCanvas canvas;
  draw(picture, canvas);
  return canvas.take();
}

Image curve_image(const CurvePicture& picture) {
  ImageCanvas canvas;
  draw(picture, canvas);
  return canvas.take();
}

std::string curve_text(const CurvePicture& picture, int columns, int rows) {
  if (picture.x.empty() || columns < 20 || rows < 4) return {};
  Range x, y;
  for (double v : picture.x) x.add(v);
  for (double v : picture.y) y.add(v);
  if (!(x.hi > x.lo)) x.hi = x.lo + 1;
  if (!(y.hi > y.lo)) y.hi = y.lo + 1;
  std::vector<std::string> canvas(static_cast<std::size_t>(rows),
                                  std::string(static_cast<std::size_t>(columns), ' '));
  const auto mark = [&](double t, double v, char c) {
    const double column = (t - x.lo) / (x.hi - x.lo) * (columns - 1);
    const double row = (v - y.lo) / (y.hi - y.lo) * (rows - 1);
    if (!(column >= 0 && column <= columns - 1 && row >= 0 && row <= rows - 1)) return;
    canvas[static_cast<std::size_t>(rows - 1 - std::lround(row))]
          [static_cast<std::size_t>(std::lround(column))] = c;
  };
  for (std::size_t i = 0; i + 1 < picture.curve.size(); ++i)
    for (int k = 0; k < 4; ++k) {
      const GrowthBandPoint &a = picture.curve[i], &b = picture.curve[i + 1];
      mark(a.time + k * (b.time - a.time) / 4, a.fit + k * (b.fit - a.fit) / 4, '.');
    }
  for (std::size_t i = 0; i < picture.x.size(); ++i) mark(picture.x[i], picture.y[i], 'o');
  std::string text = fmt::format("{:>11}\n", picture.y_label);
  for (int row = 0; row < rows; ++row)
    text += fmt::format("{:>9} |{}\n",
                        row == 0          ? brief(y.hi)
                        : row == rows - 1 ? brief(y.lo)
                                          : "",
                        canvas[static_cast<std::size_t>(row)]);
  text += fmt::format("{:>11}{}\n", "+", std::string(static_cast<std::size_t>(columns), '-'));
  const std::string from = brief(x.lo), to = brief(x.hi);
  const auto room = static_cast<std::size_t>(columns) - from.size() - to.size();
  return text + fmt::format("{:11}{}{:^{}}{}\n", "", from, picture.x_label, room, to);
}

}  // namespace dendrofit::cli
