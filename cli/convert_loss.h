// SPDX-License-Identifier: GPL-3.0-or-later
// What a conversion loses, said.
#pragma once

#include "core/point_cloud.h"
#include "core/tree.h"
#include "io/read_tree.h"

#include <filesystem>
#include <string>
#include <vector>

namespace dendrofit::cli {

/// In what the file that was written differs from the tree: volume (with the reason), parents, and what the
/// format has no place for. Reads the file again. Empty where nothing is lost.
std::vector<std::string> losses(const Tree& tree, const std::filesystem::path& written, TreeFormat format);

/// The same of a cloud, by the extension it was written under.
std::vector<std::string> losses(const PointCloud& cloud, const std::filesystem::path& written);

}  // namespace dendrofit::cli
