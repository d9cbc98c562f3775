// SPDX-License-Identifier: GPL-3.0-or-later
#include "recon/reconstruct_photo.h"

#include "core/errors.h"
#include "recon/image/lift.h"
#include "recon/image/photo_metrics.h"
#include "recon/image/sky.h"

#include <cmath>

namespace dendrofit {

void ReconstructPhotoOptions::validate() const {
  require(std::isfinite(dbh_height_m) && dbh_height_m > 0, "dbh_height_m", dbh_height_m, "must be positive");
  FrameOptions{.height_m = height_m, .scale_bar = scale_bar, .eye_height_m = eye_height_m}.validate();
  LiftOptions{.opening_angle_deg = opening_angle_deg}.validate();
}

PhotoReconstruction reconstruct_photo(const Photograph& photo, const ReconstructPhotoOptions& options,
                                      Progress& progress) {
  options.validate();
  PhotoReconstruction result;
  progress.begin("silhouette", 0, "pixels");
  result.silhouette = find_silhouette(photo, {.root_px = options.root_px});
  if (result.silhouette.from_mask && !options.camera)  // the picture still tells how the camera was held
    if (const auto sky = find_sky(photo)) result.silhouette.horizon_px = clear_horizon(*sky);
  const Silhouette& silhouette = result.silhouette;
  result.warnings = silhouette.warnings;
  progress.end();
  progress.check();

  const OutlinePixels outline = trace_outline(silhouette);
  Eigen::Vector2d foot = outline.foot, top = outline.top;
  double foot_radius = outline.foot_width / 2;
  if (!silhouette.leafy) {
    progress.begin("skeleton", 0, "lines");
    result.skeleton = skeletonise(silhouette, {.root_px = options.root_px});
    foot = result.skeleton.px.front();
    foot_radius = foot_radius_px(result.skeleton);
    progress.end();
    progress.check();
  }

  result.frame = frame_tree(silhouette.width, silhouette.height, foot, top, foot_radius,
                            {.height_m = options.height_m,
                             .scale_bar = options.scale_bar,
                             .camera = options.camera,
                             .metric_camera = options.metric_camera,
                             .eye_height_m = options.eye_height_m,
                             .horizon_px = silhouette.horizon_px,
                             .top_spread_px = outline.top_spread,
                             .crown_width_px = outline.right - outline.left});
  result.metric = result.frame.scale_source != "none";
  result.outline = measure_outline(silhouette, outline, result.skeleton, result.frame);
  tell_scale(result.frame, silhouette, result.outline, result.warnings);
  if (silhouette.leafy) return result;

  result.tree = lift(result.skeleton, result.frame,
                     {.opening_angle_deg = options.opening_angle_deg, .seed = options.seed});
  result.has_tree = true;
  result.metrics = photo_metrics(result.tree, result.outline, result.frame, silhouette, options.dbh_height_m,
                                 result.metric);
  tell_skeleton(result.skeleton, result.warnings);
  return result;
}

}  // namespace dendrofit
