// SPDX-License-Identifier: GPL-3.0-or-later
// What stands about a tree, as a picture shows it.
#pragma once

#include "core/mesh.h"
#include "core/point_cloud.h"
#include "forward/igm/grow.h"

namespace dendrofit::cli {

/// The obstacles of a site as one mesh about what is shown: boxes from the ground up, of a half-space a
/// square of its plane (none where it lies under everything, as level ground does), meshes as they are.
/// `shown` in world coordinates.
TriangleMesh surroundings_of(const IgmSite& site, const Bounds& shown);

}  // namespace dendrofit::cli
