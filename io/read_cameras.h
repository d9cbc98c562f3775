// SPDX-License-Identifier: GPL-3.0-or-later
// Photographs with their cameras: dendrofit's own cameras.json and COLMAP's text models.
#pragma once

#include "core/photograph.h"

#include <filesystem>

namespace dendrofit {

struct ReadCamerasOptions {
  bool load_photos = true;           ///< false: views hold cameras and photo names only
  double most_megapixels = 13;       ///< a larger picture is halved, its camera with it
  double most_megapixels_all = 160;  ///< together: halved alike until they fit
  void validate() const;
};

/// cameras.json, version 1:
///
///     { "format": "dendrofit-cameras", "version": 1, "units": "m", "up": [0, 0, 1],
///       "origin": [x, y, z],               optional: added to world coordinates
///       "pixel_origin": "corner",          the first pixel's centre is (0.5, 0.5); "centre": (0, 0)
///       "pose_error_px": 0.5,              optional
///       "cameras": [{ "id": 0, "model": "radial2", "width": 1500, "height": 2250, "fx": 1625, "fy": 1625,
///                     "cx": 750, "cy": 1125, "k1": 0, "k2": 0 }],      k1, k2 optional
///       "images": [{ "file": "a.jpg", "mask": "a_mask.png", "camera": 0,     mask optional
///                    "camera_from_world": [[r, r, r, t], [r, r, r, t], [r, r, r, t]] }] }
///
/// or world_from_camera instead. Camera axes: x right, y down, z forward; u = fx x (1 + k1 r^2 + k2 r^4) + cx
/// for normalised x, y. Paths are relative to the file's folder. Throws InputError naming file and field,
/// what was found and what was expected: unknown or missing keys, other units or models, a pose given twice
/// or not at all, |det R - 1| > 1e-3 or a mirrored R, pictures that are missing or of another size.
ViewSet read_cameras_json(const std::filesystem::path& file, const ReadCamerasOptions& options = {});

/// A COLMAP text model: cameras.txt and images.txt in `folder` (PINHOLE, SIMPLE_PINHOLE, SIMPLE_RADIAL or
/// RADIAL). Photographs are looked for in the folder, its images/, and those of the two folders above; masks
/// beside them as masks/NAME.png. Cameras whose focal length (over the picture's larger side) is more than
/// 1.5 times off the median are dropped with their images, and named in the warnings. The model has no scale
/// (metric = false) and no up: the world is turned so that +z is square to the cameras' x axes (cameras held
/// level from side to side, however they look up or down), or their mean upward axis where these say little.
/// Throws InputError or IoError naming file and line.
ViewSet read_colmap(const std::filesystem::path& folder, const ReadCamerasOptions& options = {});

}  // namespace dendrofit
