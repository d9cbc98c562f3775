// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/report/render.h"

#include "cli/report/annotations.h"
#include "cli/report/raster.h"
#include "cli/report/scene.h"
#include "core/errors.h"
#include "core/parallel.h"

#include <algorithm>
#include <cmath>
#include <string>

namespace dendrofit {
namespace {

constexpr int kSamples = 2;  // a pixel's side

Vec3 lowest_middle(const PointCloud& cloud) {
  double lowest = 1e300;
  for (const Vec3& p : cloud.points) lowest = std::min(lowest, p.z());
  Vec3 sum = Vec3::Zero();
  double count = 0;
  for (const Vec3& p : cloud.points)
    if (p.z() < lowest + 0.3) {
      sum += p;
      ++count;
    }
  return cloud.origin_shift + Vec3(sum.x() / count, sum.y() / count, lowest);
}

Vec3 anchor_of(const Panel& panel) {
  if (panel.anchor) return *panel.anchor;
  if (panel.tree && !panel.tree->empty()) return panel.tree->origin_shift + panel.tree->start[0];
  if (panel.cloud && !panel.cloud->empty()) return lowest_middle(*panel.cloud);
  return panel.foliage ? panel.foliage->origin_shift : Vec3::Zero();
}

/// Range of one view coordinate over a cloud without its farthest thousandth on either side.
void add_inner_range(std::vector<float>& values, float& lo, float& hi) {
  if (values.empty()) return;
  const std::size_t cut = values.size() / 1000;
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(cut), values.end());
  const float inner_lo = values[cut];
  std::nth_element(values.begin(), values.end() - 1 - static_cast<std::ptrdiff_t>(cut), values.end());
  const float inner_hi = values[values.size() - 1 - cut];
  const float slack = 0.02f * (inner_hi - inner_lo);
  lo = std::min(lo, inner_lo - slack);
  hi = std::max(hi, inner_hi + slack);
}

struct Extent {
  Eigen::Vector2f lo = Eigen::Vector2f::Constant(1e30f);
  Eigen::Vector2f hi = Eigen::Vector2f::Constant(-1e30f);
  float reach = 0;  // greatest depth away from the anchor, either way
  bool empty() const { return lo.x() > hi.x(); }
  void add(const PictureView& axes, const Vec3& place) {
    const Eigen::Vector3f p = place.cast<float>();
    const Eigen::Vector2f flat(axes.right.dot(p), axes.up.dot(p));
    lo = lo.cwiseMin(flat);
    hi = hi.cwiseMax(flat);
    reach = std::max(reach, std::abs(axes.forward.dot(p)));
  }
  void add(const Extent& other) {
    lo = lo.cwiseMin(other.lo);
    hi = hi.cwiseMax(other.hi);
    reach = std::max(reach, other.reach);
  }
};

Extent extent_of(const Panel& panel, const PictureView& axes, const Vec3& anchor) {
  Extent extent;
  if (panel.tree)
    for (std::size_t i = 0; i < panel.tree->size(); ++i) {
      const Vec3 shift = panel.tree->origin_shift - anchor;
      extent.add(axes, panel.tree->start[i] + shift);
      extent.add(axes, panel.tree->end[i] + shift);
    }
  if (panel.foliage)
    for (const Leaf& leaf : panel.foliage->leaves)
      extent.add(axes, leaf.origin + leaf.length_m * leaf.direction + panel.foliage->origin_shift - anchor);
  if (panel.cloud && !panel.cloud->empty()) {
    const Vec3 shift = panel.cloud->origin_shift - anchor;
    std::vector<float> across;
    std::vector<float> upward;
    for (const Vec3& point : panel.cloud->points) {
      const Eigen::Vector3f p = (point + shift).cast<float>();
      across.push_back(axes.right.dot(p));
      upward.push_back(axes.up.dot(p));
      extent.reach = std::max(extent.reach, std::abs(axes.forward.dot(p)));
    }
    add_inner_range(across, extent.lo.x(), extent.hi.x());
    add_inner_range(upward, extent.lo.y(), extent.hi.y());
  }
  return extent;
}

/// A splat that closes the surface of an evenly scanned tree, from the cloud's density in plan of its
/// picture.
double splat_size(const PointCloud& cloud, const Extent& extent) {
  const Eigen::Vector2f size = extent.hi - extent.lo;
  const double area = std::max(1e-6, static_cast<double>(size.x()) * size.y());
  return std::clamp(0.5 * std::sqrt(area / std::max<double>(1, static_cast<double>(cloud.size()))), 0.002,
                    0.1);
}

}  // namespace

void PictureCamera::validate() const {
  require(std::isfinite(azimuth_deg), "azimuth_deg", azimuth_deg, "must be finite");
  require(elevation_deg >= -89.9 && elevation_deg <= 90, "elevation_deg", elevation_deg,
          "must be -89.9 to 90");
  if (perspective_fov_deg)
    require(*perspective_fov_deg >= 2 && *perspective_fov_deg <= 120, "perspective_fov_deg",
            *perspective_fov_deg, "must be 2 to 120");
  if (zoom_box) {
    const Vec3 size = zoom_box->size();
    require(size.minCoeff() >= 0 && size.maxCoeff() > 1e-4 && size.allFinite(), "zoom_box size (m)",
            size.maxCoeff(), "must be greater than 0.0001");
  }
}

void RenderOptions::validate() const {
  camera.validate();
  require(panel_width_px >= 160 && panel_width_px <= 4096, "panel_width_px", panel_width_px,
          "must be 160 to 4096");
  require(height_px >= 160 && height_px <= 8192, "height_px", height_px, "must be 160 to 8192");
  if (point_size_m)
    require(*point_size_m > 0 && *point_size_m <= 10, "point_size_m", *point_size_m, "must be in (0, 10]");
}

Image render(std::span<const Panel> panels, const RenderOptions& options, Progress& progress) {
  options.validate();
  if (panels.empty())
    throw InputError("render: no panel; at least one of scan, model, regrown tree or leaves is needed");
  progress.check();
  const PictureView axes = view_along(options.camera.azimuth_deg, options.camera.elevation_deg);
  std::vector<Vec3> anchors;
  std::vector<Extent> extents;
  Extent all;
  for (const Panel& panel : panels) {
    anchors.push_back(anchor_of(panel));
    extents.push_back(extent_of(panel, axes, anchors.back()));
    all.add(extents.back());
  }
  if (options.camera.zoom_box) {
    all = Extent();
    for (int corner = 0; corner < 8; ++corner) {
      const Bounds& box = *options.camera.zoom_box;
      all.add(axes, Vec3(corner & 1 ? box.hi.x() : box.lo.x(), corner & 2 ? box.hi.y() : box.lo.y(),
                         corner & 4 ? box.hi.z() : box.lo.z()));
    }
  } else if (options.ground) {
    all.add(axes, Vec3::Zero());
  }
  if (all.empty()) all.add(axes, Vec3(0, 0, 1));

  const Margins margins = margins_of(options);
  const Eigen::Vector2f size = (all.hi - all.lo).cwiseMax(0.02f);
  const float room_x = static_cast<float>(options.panel_width_px - 2 * margins.side);
  const float room_y = static_cast<float>(options.height_px - margins.top - margins.bottom);
  PictureView view = axes;
  view.scale = std::min(room_x / size.x(), room_y / size.y());
  // A broad tree needs less height than there is.
  const int height =
      std::clamp(static_cast<int>(std::ceil(view.scale * size.y())) + margins.top + margins.bottom,
                 std::min(options.height_px, options.panel_width_px / 2), options.height_px);
  const int width = std::clamp(static_cast<int>(std::ceil(view.scale * size.x())) + 2 * margins.side,
                               std::min(240, options.panel_width_px), options.panel_width_px);
  view.centre = 0.5f * ((all.lo.x() + all.hi.x()) * axes.right + (all.lo.y() + all.hi.y()) * axes.up);
  view.centre_x = 0.5f * static_cast<float>(width);
  // The tree stands on the bottom margin.
  view.centre_y = static_cast<float>(height - margins.bottom) - 0.5f * view.scale * size.y();
  float reach = 0;
  for (const Extent& extent : extents) reach = std::max(reach, extent.reach);
  view.distance = reach + size.norm();
  if (options.camera.perspective_fov_deg) {
    view.perspective = true;
    const double half = 0.5 * *options.camera.perspective_fov_deg * 3.14159265358979 / 180;
    view.distance = static_cast<float>(0.5 * std::max(size.x(), size.y()) / std::tan(half)) + 0.3f * reach;
  }

  std::vector<Image> pictures(panels.size());
  parallel_blocks(panels.size(), 1, options.threads, [&](std::size_t first, std::size_t last) {
    for (std::size_t k = first; k < last; ++k) {
      progress.check();
      const Panel& panel = panels[k];
      Scene scene;
      Shading shading{options.shadows, 0.01f, options.background};
      const double thinnest = 0.55 / (view.scale * kSamples);
      if (panel.tree)
        add_wood(*panel.tree, panel.tree->origin_shift - anchors[k],
                 tree_colours(*panel.tree, panel.tree_colour), panel.smooth_wood, thinnest, scene);
      if (panel.foliage) add_leaves(*panel.foliage, panel.foliage->origin_shift - anchors[k], scene);
      if (panel.cloud) {
        add_points(*panel.cloud, panel.cloud->origin_shift - anchors[k],
                   panel.point_colours ? &*panel.point_colours : nullptr, scene);
        shading.point_size_m = static_cast<float>(
            options.point_size_m ? *options.point_size_m : splat_size(*panel.cloud, extents[k]));
      }
      if (panel.surroundings)
        add_panes(*panel.surroundings, panel.surroundings->origin_shift - anchors[k], scene);
      const bool blank = scene.triangles.empty() && scene.points.empty();
      if (!blank && options.ground && options.camera.elevation_deg > 2 && !options.camera.zoom_box)
        add_ground(0, 0, 0.62 * std::max(size.x(), 0.3f * size.y()), scene);
      pictures[k] = draw_scene(scene, view, width, height, kSamples, shading);
      annotate_panel(panel, options, view, blank, pictures[k]);
    }
  });
  Image row(width * static_cast<int>(panels.size()), height, options.background);
  for (std::size_t k = 0; k < pictures.size(); ++k) row.paste(pictures[k], width * static_cast<int>(k), 0);
  annotate_row(options, view, row);
  return row;
}

Image side_by_side(const SideBySide& content, const RenderOptions& options, Progress& progress) {
  const auto count = [](std::size_t n, const char* what) { return with_thousands(n) + " " + what; };
  const std::optional<Vec3> foot =
      content.model && !content.model->empty()
          ? std::optional<Vec3>(content.model->origin_shift + content.model->start[0])
          : std::nullopt;
  std::vector<Panel> panels;
  if (content.scan) {
    Panel panel;
    panel.title = "Scan";
    panel.subtitle = count(content.scan->size(), "points");
    panel.cloud = content.scan;
    panel.anchor = foot;
    panels.push_back(panel);
  }
  if (content.model) {
    Panel panel;
    panel.title = "Model";
    panel.subtitle = count(content.model->size(), "cylinders");
    panel.tree = content.model;
    panel.tree_colour = TreeColour::order;
    panels.push_back(panel);
  }
  if (content.regrown) {
    Panel panel;
    panel.title = "Regrown";
    panel.subtitle = count(content.regrown->size(), "internodes");
    panel.tree = content.regrown;
    panel.tree_colour = TreeColour::order;
    panels.push_back(panel);
  }
  if (content.foliage) {
    Panel panel;
    panel.title = "With leaves";
    panel.subtitle = count(content.foliage->size(), "leaves");
    panel.tree = content.regrown && !content.leaves_on_model ? content.regrown : content.model;
    panel.foliage = content.foliage;
    panels.push_back(panel);
  }
  return render(panels, options, progress);
}

}  // namespace dendrofit
