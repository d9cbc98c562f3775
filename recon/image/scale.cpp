// SPDX-License-Identifier: GPL-3.0-or-later
#include "recon/image/scale.h"

#include "core/errors.h"
#include "recon/image/carve.h"
#include "recon/image/foot.h"
#include "recon/image/view_checks.h"

#include <cmath>
#include <string>
#include <vector>

namespace dendrofit {
namespace {

/// The views' cameras and masks, in lengths near those of a tree (10 from the first camera to its middle), so
/// that cells and tolerances are of a sensible size.
struct Sized {
  std::vector<Camera> cameras;
  std::vector<Outline> outlines;
  double scale = 1;  ///< lengths here over the set's
  explicit Sized(const ViewSet& set) {
    std::vector<std::string> warnings;  // told again by the reconstruction
    for (const View& view : set.views) {
      cameras.push_back(view.camera);
      outlines.push_back(outline_of(view, warnings));
    }
    check_depth(cameras, outlines);
    scale = 10 / (cameras.front().centre() - common_middle(cameras, outlines)).norm();
    for (Camera& camera : cameras) camera.translation *= scale;
  }
};

void scale_by(ViewSet& set, double factor) {
  for (View& view : set.views) view.camera.translation *= factor;
  set.metric = true;
}

}  // namespace

void scale_to_height(ViewSet& set, double height_m, Progress& progress) {
  require(std::isfinite(height_m) && height_m > 0 && height_m < 150, "height_m", height_m,
          "must lie between 0 and 150 m");
  const Sized sized(set);
  const Hull hull =
      carve(sized.cameras, sized.outlines,
            {.cell_m = 2 * carving_cell_m(sized.cameras, sized.outlines), .tolerance_px = 2.5}, progress);
  if (hull.cells.empty())
    throw SolverError("no place lies inside all masks: the poses or the masks do not belong together");
  const Bounds bounds = bounds_of(hull.cells);
  const std::optional<MaskFoot> foot = foot_of_masks(sized.cameras, sized.outlines);
  scale_by(set, sized.scale * height_m / (bounds.hi.z() - (foot ? foot->position.z() : bounds.lo.z())));
}

void scale_to_bar(ViewSet& set, const ScaleBar& bar) {
  FrameOptions{.scale_bar = bar}.validate();
  const Sized sized(set);
  const std::optional<MaskFoot> foot = foot_of_masks(sized.cameras, sized.outlines);
  if (!foot)
    throw SolverError(
        "the stem's foot is not seen in three views, which would tell how far away the scale bar is: give "
        "the tree's --height");
  PictureFrame plane;
  plane.camera = sized.cameras.front();
  const Vec3 to_foot = foot->position - plane.camera.centre();
  plane.distance_m = to_foot.head<2>().norm();
  plane.away = Vec3(to_foot.x(), to_foot.y(), 0) / plane.distance_m;
  const auto from = plane.point(bar.from), to = plane.point(bar.to);
  if (!from || !to)
    throw InputError("the scale bar of the first view does not meet the plane the tree stands in");
  scale_by(set, sized.scale * bar.length_m / (*to - *from).norm());
}

}  // namespace dendrofit
