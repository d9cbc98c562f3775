// SPDX-License-Identifier: GPL-3.0-or-later
// What the readers of camera files share: pictures fetched for cameras, and the world moved and turned.
#pragma once

#include "io/read_cameras.h"

#include <filesystem>
#include <string>
#include <vector>

namespace dendrofit {

/// A view before its picture is read.
struct ViewFile {
  std::filesystem::path photo;
  std::filesystem::path mask;  ///< empty: none
  std::string where;           ///< "cameras.json: images[3]" for messages
  Camera camera;
};

/// Reads the pictures (halved alike until they fit the options' limits) and scales the cameras with them.
std::vector<View> load_views(const std::vector<ViewFile>& files, const ReadCamerasOptions& options,
                             std::vector<std::string>& warnings);

/// Turns the world so that `up` becomes +z, and moves its origin by whole metres to near the cameras' mean
/// centre where that is far, so that local coordinates stay small. `views.origin_shift` is the file's origin
/// before and world - local after.
void settle_world(ViewSet& views, const Vec3& up);

}  // namespace dendrofit
