// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/report/annotations.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <set>
#include <utility>
#include <vector>

namespace dendrofit {
namespace {

constexpr Rgb kInk = {48, 52, 58};
constexpr Rgb kQuietInk = {104, 110, 118};
constexpr Rgb kGroundInk = {120, 106, 90};

using Legend = std::vector<std::pair<Rgb, std::string>>;

Legend legend_of(const Panel& panel) {
  Legend rows;
  if (!panel.tree || panel.tree->empty()) return rows;
  if (panel.tree_colour == TreeColour::order) {
    const int highest = *std::max_element(panel.tree->order.begin(), panel.tree->order.end());
    const int last = static_cast<int>(kOrderColours.size()) - 1;
    for (int order = 0; order <= std::min(highest, last); ++order) {
      std::string label = order == 0 ? std::string("stem") : std::to_string(order);
      if (order == last && highest > last) label.push_back('+');
      rows.emplace_back(order_colour(order), label);
    }
  }
  if (panel.tree_colour == TreeColour::quality) {
    const std::set<RadiusQuality> present(panel.tree->quality.begin(), panel.tree->quality.end());
    for (RadiusQuality quality : present)
      rows.emplace_back(quality_colour(quality), std::string(to_string(quality)));
  }
  if (panel.tree_colour == TreeColour::radius)
    for (double share : {0.0, 0.5, 1.0})
      rows.emplace_back(scale_colour(share), share == 0 ? "thin" : share == 1 ? "thick" : "");
  if (panel.tree_colour == TreeColour::birth_cycle)
    for (double share : {0.0, 0.5, 1.0})
      rows.emplace_back(scale_colour(share), share == 0 ? "old" : share == 1 ? "young" : "");
  return rows;
}

void veil(Image& image, int from_y, int to_y, Rgb colour) {
  for (int y = from_y; y < to_y; ++y)
    for (int x = 0; x < image.width; ++x) image.blend(x, y, colour, 0.85);
}

/// Entries in lines no wider than `room`, as many on each as go.
std::vector<Legend> lines_of(const Legend& legend, double room, double size) {
  std::vector<Legend> lines(1);
  double width = 0;
  for (const auto& entry : legend) {
    const double own = 1.9 * size + text_width(entry.second, 0.75 * size);
    if (width > 0 && width + own > room) {
      lines.emplace_back();
      width = 0;
    }
    width += own;
    lines.back().push_back(entry);
  }
  return lines;
}

/// Centred at `middle`, its last line on `base`. There is room for two lines; on a narrow picture the words
/// shrink until they go into them.
void draw_legend(Image& image, const Legend& legend, double middle, double base, double room, double size) {
  std::vector<Legend> lines = lines_of(legend, room, size);
  while (size > 5 && lines.size() > 2) lines = lines_of(legend, room, size *= 0.95);
  double y =
      base - 1.15 * size * (static_cast<double>(lines.size()) - 1) + (lines.size() > 1 ? 0.4 * size : 0);
  for (const Legend& line : lines) {
    double width = -0.6 * size;
    for (const auto& entry : line) width += 1.9 * size + text_width(entry.second, 0.75 * size);
    double x = middle - 0.5 * width;
    for (const auto& [colour, label] : line) {
      fill_box(image, static_cast<int>(x), static_cast<int>(y - 0.75 * size),
               static_cast<int>(x + 0.8 * size), static_cast<int>(y), colour);
      draw_text(image, x + 1.1 * size, y, label, 0.75 * size, kInk);
      x += 1.9 * size + text_width(label, 0.75 * size);
    }
    y += 1.15 * size;
  }
}

double text_size(const RenderOptions& options) {
  return std::clamp(options.height_px / 48.0, 8.0, 24.0);
}

}  // namespace

Margins margins_of(const RenderOptions& options) {
  const double size = text_size(options);
  return {static_cast<int>(4.6 * size),
          static_cast<int>((options.legend || options.scale_bar ? 6.0 : 2.0) * size),
          static_cast<int>(1.6 * size)};
}

void annotate_panel(const Panel& panel, const RenderOptions& options, const PictureView& view, bool blank,
                    Image& image) {
  const double size = text_size(options);
  const double middle = 0.5 * image.width;
  const double room = image.width - 1.2 * size;
  if (options.camera.zoom_box) {
    // The picture runs on under the words: a veil keeps them readable.
    const Margins margins = margins_of(options);
    veil(image, 0, margins.top, options.background);
    veil(image, image.height - margins.bottom, image.height, options.background);
  }
  draw_text(image, middle, 2.0 * size, fit_text(panel.title, 1.15 * size, room), 1.15 * size, kInk,
            TextAnchor::middle);
  draw_text(image, middle, 3.6 * size, fit_text(panel.subtitle, 0.8 * size, room), 0.8 * size, kQuietInk,
            TextAnchor::middle);
  Eigen::Vector3f foot;
  if (options.ground && options.camera.elevation_deg <= 2 && view.project(Eigen::Vector3f::Zero(), foot) &&
      foot.y() < static_cast<float>(image.height) - 1)
    draw_line(image, 0, foot.y(), image.width, foot.y(), std::max(1.0, 0.09 * size), kGroundInk);
  if (blank)
    draw_text(image, middle, 0.5 * image.height, fit_text("nothing to show", size, room), size, kQuietInk,
              TextAnchor::middle);
  if (!options.legend) return;
  draw_legend(image, legend_of(panel), middle, image.height - 3.5 * size, room, size);
}

void annotate_row(const RenderOptions& options, const PictureView& view, Image& image) {
  const double size = text_size(options);
  if (options.scale_bar) {
    const double length = round_length(0.5 * 2 * view.centre_x / view.scale);
    const double x0 = 1.6 * size;
    const double x1 = x0 + length * view.scale;
    const double y = image.height - 1.3 * size;
    draw_line(image, x0, y, x1, y, 0.16 * size, kInk);
    for (double x : {x0, x1}) draw_line(image, x, y - 0.35 * size, x, y + 0.35 * size, 0.13 * size, kInk);
    draw_text(image, x1 + 0.6 * size, y + 0.35 * size, length_label(length), 0.8 * size, kInk);
  }
  if (!options.height_marks || std::abs(options.camera.elevation_deg) > 2 || view.perspective) return;
  Eigen::Vector3f foot;
  view.project(Eigen::Vector3f::Zero(), foot);
  const double step =
      round_length(std::max(1e-3, (static_cast<double>(image.height) - 6 * size) / view.scale / 4));
  for (int k = 1; k < 200; ++k) {
    const double y = foot.y() - k * step * view.scale;
    if (y < 5 * size) break;
    if (y > image.height - 6 * size) continue;
    draw_line(image, 0, y, 0.5 * size, y, std::max(1.0, 0.08 * size), kQuietInk);
    draw_text(image, 0.8 * size, y + 0.33 * size, length_label(k * step), 0.66 * size, kQuietInk);
  }
}

std::string with_thousands(std::size_t number) {
  const std::string digits = std::to_string(number);
  std::string text;
  for (std::size_t k = 0; k < digits.size(); ++k) {
    if (k > 0 && (digits.size() - k) % 3 == 0) text.push_back(',');
    text.push_back(digits[k]);
  }
  return text;
}

double round_length(double limit) {
  const double power = std::pow(10.0, std::floor(std::log10(limit)));
  for (double factor : {5.0, 2.0})
    if (factor * power <= limit * (1 + 1e-9)) return factor * power;
  return power;
}

std::string length_label(double metres) {
  char text[32];
  if (metres < 0.00999)
    std::snprintf(text, sizeof text, "%.3g mm", 1000 * metres);
  else if (metres < 0.999)
    std::snprintf(text, sizeof text, "%.3g cm", 100 * metres);
  else
    std::snprintf(text, sizeof text, "%.4g m", metres);
  return text;
}

}  // namespace dendrofit
