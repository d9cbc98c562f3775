// SPDX-License-Identifier: GPL-3.0-or-later
// Pictures of scans, trees and leaves without a display: a z-buffer of our own, lit by a sun with soft
// shadows and an open sky. The same input gives the same bytes whatever the number of threads.
#pragma once

#include "cli/report/colours.h"
#include "cli/report/image.h"
#include "core/foliage.h"
#include "core/mesh.h"
#include "core/point_cloud.h"
#include "core/progress.h"
#include "core/tree.h"

#include <optional>
#include <span>
#include <string>
#include <vector>

namespace dendrofit {

/// Where the eye stands. Azimuth 0 looks north (+y) from the south, 90 looks west from the east; elevation 0
/// is level, 90 looks straight down.
struct PictureCamera {
  double azimuth_deg = 0;
  double elevation_deg = 0;
  /// Without it the picture is orthographic: true lengths across the line of sight.
  std::optional<double> perspective_fov_deg;
  /// What to show, in metres about the anchor; everything where absent.
  std::optional<Bounds> zoom_box;
  void validate() const;
};

/// One picture of a row. Any of cloud, tree and foliage may be null; a panel without anything says "nothing
/// to show".
struct Panel {
  std::string title;
  std::string subtitle;
  const PointCloud* cloud = nullptr;
  const Tree* tree = nullptr;
  const Foliage* foliage = nullptr;
  const TriangleMesh* surroundings = nullptr;  ///< seen through; the picture does not widen for it
  TreeColour tree_colour = TreeColour::bark;
  std::optional<std::vector<Rgb>> point_colours;  ///< one a point, else one colour for all
  bool smooth_wood = true;  ///< tubes along each axis; false: the cylinders as the model has them
  /// World position that becomes the panel's origin: the foot of the tree. Absent: the tree's first root,
  /// else the middle of the lowest points.
  std::optional<Vec3> anchor;
};

struct RenderOptions {
  int panel_width_px = 560;  ///< at most; panels are narrower where the tree is slender
  int height_px = 900;       ///< at most; less where the tree is broad
  PictureCamera camera;
  bool ground = true;  ///< ground line (and plane, seen from above) at the anchor's height
  bool scale_bar = true;
  bool height_marks = true;  ///< dashes with metres at the left edge of the first panel, elevation 0 only
  bool legend = true;        ///< of tree_colour, under the panel
  bool shadows = true;
  std::optional<double> point_size_m;  ///< diameter of a splat; absent: from the cloud's own density
  Rgb background = {250, 250, 248};
  int threads = 0;
  void validate() const;
};

/// All panels in one row, at one scale. Throws InputError for options out of range or no panel at all.
Image render(std::span<const Panel> panels, const RenderOptions& options = {},
             Progress& progress = no_progress());

/// scan | model | regrown | with leaves: what `side_by_side.png` shows. Null pointers leave their panel out;
/// leaves stand on `regrown` where there is one, else on the model, unless `leaves_on_model` says so.
struct SideBySide {
  const PointCloud* scan = nullptr;
  const Tree* model = nullptr;
  const Tree* regrown = nullptr;
  const Foliage* foliage = nullptr;
  bool leaves_on_model = false;
};
Image side_by_side(const SideBySide& content, const RenderOptions& options = {},
                   Progress& progress = no_progress());

}  // namespace dendrofit
