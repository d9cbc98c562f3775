// SPDX-License-Identifier: GPL-3.0-or-later
// The files that every command which makes a tree leaves behind.
#pragma once

#include "core/foliage.h"
#include "core/metrics.h"
#include "core/tree.h"

#include <filesystem>
#include <string>
#include <vector>

namespace dendrofit::cli {

/// Mesh formats asked for on the command line: "obj", "ply", "glb" (throws UsageError for others).
void check_mesh_formats(const std::vector<std::string>& formats);

/// qsm.csv, metrics.json and tree.<format> for each format, into `folder`.
void write_tree_files(const std::filesystem::path& folder, const Tree& tree, const TreeMetrics& metrics,
                      const std::vector<std::string>& mesh_formats);

/// leaves.csv, leaves.json (given as text) and leaves.<format> for each format (a scene without leaves has no
/// .glb).
void write_leaf_files(const std::filesystem::path& folder, const Foliage& foliage,
                      const std::string& report_json, const std::vector<std::string>& mesh_formats);

}  // namespace dendrofit::cli
