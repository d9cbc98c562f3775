// SPDX-License-Identifier: GPL-3.0-or-later
// Photographs with their cameras: dendrofit's own cameras.json and COLMAP's text models.
#pragma once

#include "core/photograph.h"

#include <filesystem>

namespace dendrofit {

struct ReadCamerasOptions {
  bool load_photos = true;           ///< false: views hold cameras and photo names only
  double most_megapixels = 25;       ///< a larger picture is halved, its camera with it
  double most_megapixels_all = 160;  ///< together: halved alike until they fit
  void validate() const;
};

/// cameras.json, version 1. Paths are relative to its folder. Throws InputError naming file and field, what
/// was found and what was expected: unknown or missing keys, other units or models, a pose given twice or not
/// at all, |det R - 1| > 1e-3 or a mirrored R, pictures that are missing or of another size.
ViewSet read_cameras_json(const std::filesystem::path& file, const ReadCamerasOptions& options = {});

/// A COLMAP text model: cameras.txt and images.txt in `folder` (PINHOLE, SIMPLE_PINHOLE, SIMPLE_RADIAL or
/// RADIAL). Photographs are looked for in the folder, its images/, and those of the two folders above; masks
/// beside them as masks/NAME.png. Cameras whose focal length (over the picture's larger side) is more than
/// 1.5 times off the median are dropped with their images, and named in the warnings. The model has no scale
/// (metric = false) and no up: the world is turned so that the cameras' mean upward axis is +z. Throws
/// InputError or IoError naming file and line.
ViewSet read_colmap(const std::filesystem::path& folder, const ReadCamerasOptions& options = {});

}  // namespace dendrofit
