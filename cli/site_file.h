// SPDX-License-Identifier: GPL-3.0-or-later
// site.toml: where trees grow, and what stands in their way.
#pragma once

#include "forward/igm/grow.h"

#include <filesystem>
#include <string>
#include <vector>

namespace dendrofit::cli {

/// A site, and the files its meshes came from.
struct SiteFile {
  IgmSite site;
  std::vector<std::filesystem::path> mesh_files;
};

/// [[tree]] root = [x, y, z] (several stems: 3 numbers each, one list) and parameters = preset, file or
/// table; [[box]] min, max; [[halfspace]] point, normal; [[mesh]] file (relative to the site file). Trees
/// without parameters of their own grow under `parameters`. Throws InputError or IoError with file and line.
SiteFile load_site(const std::filesystem::path& file, const IgmParameters& parameters);

/// The same site as a file in `folder`: every tree's own parameters in full, meshes named from there.
std::string site_toml(const SiteFile& site, const std::filesystem::path& folder);

}  // namespace dendrofit::cli
