// SPDX-License-Identifier: GPL-3.0-or-later
#include "recon/image/view_checks.h"

#include "core/errors.h"
#include "core/parallel.h"
#include "core/tree_topology.h"
#include "recon/image/cover.h"
#include "recon/image/foot.h"
#include "recon/image/segmentation.h"
#include "recon/intervals.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace dendrofit {
namespace {

std::string name_of(const ViewSet& set, std::size_t view) {
  const std::string& name = set.views[view].photo.name;
  return "view " + std::to_string(view) + (name.empty() ? "" : " (" + name + ")");
}

std::string percent(double share) {
  return std::to_string(static_cast<int>(std::lround(100 * share))) + " %";
}

/// Length of an axis thinner than `radius_m`: from the median, over thin wood, of radius over the square root
/// of the length beyond.
double unseen_length_m(const Tree& tree, double radius_m) {
  const std::vector<double> beyond = length_beyond(tree);
  std::vector<double> scales;
  for (std::size_t i = 0; i < tree.size(); ++i)
    if (tree.radius[i] < 8 * radius_m && tree.quality[i] == RadiusQuality::measured && beyond[i] > 0.05)
      scales.push_back(tree.radius[i] / std::sqrt(beyond[i]));
  if (scales.empty()) return 0;
  const auto middle = scales.begin() + static_cast<std::ptrdiff_t>(scales.size() / 2);
  std::nth_element(scales.begin(), middle, scales.end());
  return std::pow(radius_m / *middle, 2);
}

}  // namespace

void check_views(const ViewSet& set) {
  if (set.views.size() < 2)
    throw InputError(
        "views: " + std::to_string(set.views.size()) +
        " given, at least 2 are needed for depth (4 for a usable crown, 8 for a good one); a single "
        "photograph goes without --cameras");
  if (!set.metric)
    throw InputError(
        "the cameras have no unit of length: give the tree's height (--height 12.4m) or a "
        "--scale-bar in the first view");
  for (const View& view : set.views) {
    view.photo.validate();
    view.camera.validate();
    require(view.photo.width == view.camera.width && view.photo.height == view.camera.height, "width",
            view.photo.width, view.photo.name + ": the picture is not of its camera's size");
  }
}

void check_depth(const std::vector<Camera>& cameras, const std::vector<Outline>& outlines) {
  constexpr double kLeastAngle = 3 * std::numbers::pi / 180;
  double widest = 0;
  for (std::size_t i = 0; i < cameras.size(); ++i)
    for (std::size_t j = i + 1; j < cameras.size(); ++j) {
      const double cosine =
          std::abs(cameras[i].ray(outlines[i].middle()).dot(cameras[j].ray(outlines[j].middle())));
      widest = std::max(widest, std::acos(std::min(1.0, cosine)));
    }
  if (widest >= kLeastAngle) return;
  double apart = 0;
  for (const Camera& camera : cameras)
    apart = std::max(apart, (camera.centre() - cameras.front().centre()).norm());
  throw InputError("all views look at the tree along one line (their camera centres lie within " +
                   std::to_string(std::lround(100 * apart)) +
                   " cm): pictures from one place show no depth; walk around the tree, 8 places or more");
}

Outline outline_of(const View& view, std::vector<std::string>& warnings) {
  if (!view.photo.mask.empty()) return {view.photo.mask, view.photo.width, view.photo.height};
  try {
    const Silhouette silhouette = find_silhouette(view.photo);
    for (const std::string& warning : silhouette.warnings)
      warnings.push_back(view.photo.name + ": " + warning);
    return {sharpened(silhouette), silhouette.width, silhouette.height, silhouette.cover};
  } catch (const SolverError& error) {
    throw SolverError(view.photo.name + ": " + error.what());
  }
}

void warn_of_borders(const ViewSet& set, const std::vector<Outline>& outlines,
                     std::vector<std::string>& warnings) {
  std::string top, sides;
  std::size_t tops = 0;
  for (std::size_t v = 0; v < outlines.size(); ++v) {
    if (outlines[v].touches_top()) {
      top += (top.empty() ? "" : ", ") + name_of(set, v);
      ++tops;
    }
    if (outlines[v].touches_sides()) sides += (sides.empty() ? "" : ", ") + name_of(set, v);
  }
  if (!top.empty())
    warnings.push_back(
        "tree touches the top border in " + top +
        (2 * tops > outlines.size() ? ": height is a lower bound" : ": these views say nothing above it"));
  if (!sides.empty())
    warnings.push_back("tree touches a side border in " + sides + ": these views say nothing beyond it");
}

void excuse_lost_feet(const ViewSet& set, const std::vector<Camera>& cameras, std::vector<Outline>& outlines,
                      std::vector<std::string>& warnings) {
  constexpr double kLeastPx = 6;  // above the foot's lower rim
  const std::optional<MaskFoot> foot = foot_of_masks(cameras, outlines);
  if (!foot) return;
  std::string lost;
  for (std::size_t v = 0; v < outlines.size(); ++v) {
    const auto pixel = cameras[v].project(foot->position);
    if (!pixel || !outlines[v].holds(*pixel)) continue;
    const double radius_px = foot->radius_m * cameras[v].fx / cameras[v].depth(foot->position);
    const int lowest = outlines[v].lowest_row();
    if (lowest + 1 > pixel->y() - std::max(kLeastPx, 2 * radius_px)) continue;
    outlines[v].tell_nothing_below(lowest);
    lost += (lost.empty() ? "" : ", ") + name_of(set, v);
  }
  if (!lost.empty())
    warnings.push_back(
        "the stem is lost above its foot in " + lost +
        ": what lies below comes from the other views; give these views a mask (\"mask\" in the "
        "cameras file)");
}

std::string odd_view_warning(const ViewSet& set, std::size_t view, double explained, double missing) {
  return name_of(set, view) + " contradicts the others and was left out: they explain " + percent(explained) +
         " of its mask, and " + percent(missing) +
         " of what they show lies outside it; its pose is wrong, or its mask (give \"mask\" in the cameras "
         "file)";
}

std::string coarse_warning(double cell_m) {
  return "the masks leave so much space open (a dense or leafy crown, or too few views for it) that it was "
         "carved in "
         "cells of " +
         std::to_string(std::lround(1000 * cell_m)) + " mm: thinner branches are lost or run together";
}

std::string disagreement_warning(const ViewSet& set, const std::vector<std::size_t>& views,
                                 const std::vector<double>& shares) {
  std::string text = "the views do not agree: the space they have in common explains only";
  for (std::size_t k = 0; k < views.size(); ++k)
    if (shares[k] < 0.85)
      text += " " + percent(shares[k]) + " of the mask of " + name_of(set, views[k]) + ",";
  text.back() = ';';
  return text + " the poses are off by pixels, the masks miss parts of the tree, or it moved in the wind";
}

std::vector<double> covered_shares(const Tree& tree, const std::vector<Camera>& cameras,
                                   const std::vector<Outline>& outlines, int threads) {
  std::vector<double> shares(cameras.size(), 0);
  parallel_blocks(cameras.size(), 1, threads, [&](std::size_t first, std::size_t end) {
    for (std::size_t v = first; v < end; ++v) {
      const Camera& camera = cameras[v];
      const int w = outlines[v].width(), h = outlines[v].height();
      std::vector<char> drawn(static_cast<std::size_t>(w) * static_cast<std::size_t>(h), 0);
      std::size_t both = 0;
      for (std::size_t i = 0; i < tree.size(); ++i) {
        const auto a = camera.project(tree.start[i]), b = camera.project(tree.end[i]);
        if (!a || !b) continue;
        const double reach =
            std::max(0.5, tree.radius[i] * camera.fx / camera.depth(0.5 * (tree.start[i] + tree.end[i])));
        const Eigen::Vector2d run = *b - *a, lo = a->cwiseMin(*b).array() - reach,
                              hi = a->cwiseMax(*b).array() + reach;
        const double square = std::max(1e-12, run.squaredNorm());
        for (int y = std::max(0, static_cast<int>(lo.y())); y <= std::min<double>(h - 1, hi.y()); ++y)
          for (int x = std::max(0, static_cast<int>(lo.x())); x <= std::min<double>(w - 1, hi.x()); ++x) {
            const Eigen::Vector2d p(x + 0.5, y + 0.5);
            const double t = std::clamp((p - *a).dot(run) / square, 0.0, 1.0);
            char& pixel = drawn[static_cast<std::size_t>(y) * static_cast<std::size_t>(w) +
                                static_cast<std::size_t>(x)];
            if (pixel || (*a + t * run - p).squaredNorm() > reach * reach) continue;
            pixel = 1;
            both += outlines[v].inside(x, y);
          }
      }
      shares[v] = static_cast<double>(both) / static_cast<double>(outlines[v].area_px());
    }
  });
  return shares;
}

void measure_from_views(Reconstruction& model, const std::vector<Camera>& cameras, double dbh_height_m) {
  model.metrics = measure(model.tree, MetricsOptions{.dbh_height_m = dbh_height_m});
  model.foot = model.tree.origin_shift + model.tree.start.front();
  std::vector<double> footprint;
  footprint.reserve(cameras.size());
  const Vec3 middle = 0.5 * (bounds_of(model.tree.end).lo + bounds_of(model.tree.end).hi);
  for (const Camera& camera : cameras) footprint.push_back(camera.depth(middle) / camera.fx);
  std::sort(footprint.begin(), footprint.end());
  const double pixel_m = footprint[footprint.size() / 2];
  std::optional<SliceDiameter> breast;
  if (model.metrics.dbh_m) {
    const double height = foot_height(model.tree) + dbh_height_m;
    double nearest = 1e300;
    for (std::size_t i = 0; i < model.tree.size(); ++i) {
      const double off = std::abs(0.5 * (model.tree.start[i].z() + model.tree.end[i].z()) - height);
      if (model.tree.order[i] > 0 || off >= nearest) continue;
      nearest = off;
      breast = SliceDiameter{*model.metrics.dbh_m, 2 * model.tree.radius_se[i], 1};
    }
  }
  model.noise_m = 0.5 * pixel_m;
  model.spacing_m = pixel_m;
  estimate_intervals(model.tree, breast, model.noise_m, pixel_m, model.metrics);
  // Twigs under half a pixel leave no mark on a mask: the tree may go on above by what its own taper says.
  Interval& height = model.metrics.intervals["height_m"];
  height.hi += std::min(0.03 * height.value, unseen_length_m(model.tree, 0.25 * pixel_m));
}

}  // namespace dendrofit
