// SPDX-License-Identifier: GPL-3.0-or-later
// Plots as SVG text: lines, bands, points, bars and intervals on two axes. Series differ by dash or mark as
// well as by colour.
#pragma once

#include "cli/report/image.h"

#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace dendrofit {

struct PlotStyle {
  Rgb colour;
  bool dashed = false;
  bool hollow = false;  ///< of points and bars
};

/// The two styles that stand for the scanned and the regrown tree everywhere in the report.
inline constexpr PlotStyle kScanStyle = {{0, 90, 160}, false, false};
inline constexpr PlotStyle kRegrownStyle = {{200, 80, 0}, true, true};

/// Values that are not finite are left out, and break a line. Ranges follow the data; bars start at zero.
class SvgPlot {
 public:
  SvgPlot(std::string title, std::string x_label, std::string y_label);

  void line(const std::vector<double>& x, const std::vector<double>& y, PlotStyle style,
            const std::string& name);
  void band(const std::vector<double>& x, const std::vector<double>& lo, const std::vector<double>& hi,
            PlotStyle style, const std::string& name);
  void points(const std::vector<double>& x, const std::vector<double>& y, PlotStyle style,
              const std::string& name);
  /// One bar a category; several calls stand side by side. All calls together share the categories.
  void bars(const std::vector<double>& heights, PlotStyle style, const std::string& name);
  void categories(std::vector<std::string> names) { categories_ = std::move(names); }
  void logarithmic_y() { log_y_ = true; }
  void include_zero_x() { zero_x_ = true; }
  void include_zero_y() { zero_y_ = true; }

  bool empty() const { return series_.empty(); }
  /// A <figure> with a caption; "" for a plot without anything finite on it.
  std::string figure(const std::string& id) const;

 private:
  enum class Kind { line, band, points, bars };
  struct Series {
    Kind kind;
    std::vector<double> x, y, hi;
    PlotStyle style;
    std::string name;
  };
  struct Frame;
  std::string title_, x_label_, y_label_;
  std::vector<Series> series_;
  std::vector<std::string> categories_;
  bool log_y_ = false;
  bool zero_x_ = false;
  bool zero_y_ = false;

  std::string legend() const;
  std::string draw(const Series& series, const Frame& frame, std::size_t bar_set, std::size_t bar_sets) const;
};

/// Round tick positions covering lo..hi, about `wanted` of them.
std::vector<double> round_ticks(double lo, double hi, int wanted);

}  // namespace dendrofit
