// SPDX-License-Identifier: GPL-3.0-or-later
// The files that every command which makes a tree leaves behind.
#pragma once

#include "core/foliage.h"
#include "core/metrics.h"
#include "core/tree.h"

#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace dendrofit::cli {

/// Mesh formats asked for on the command line: "obj", "ply", "glb" (throws UsageError for others).
void check_mesh_formats(const std::vector<std::string>& formats);

/// What metrics.json says besides the measures of all wood.
struct MetricsExtras {
  std::span<const TreeMetrics> trees = {};  ///< of each tree of a stand
  std::string crs = {};                     ///< coordinate system of the positions, as the scan states it
};

/// qsm.csv, metrics.json and tree.<format> for each format, into `folder`; birth_cycles.csv where the tree
/// knows them.
void write_tree_files(const std::filesystem::path& folder, const Tree& tree, const TreeMetrics& metrics,
                      const std::vector<std::string>& mesh_formats, const MetricsExtras& extras = {});

/// leaves.csv, leaves.json (given as text), shoots.csv (the shoots added to a coarse model, as a QSM; none
/// where none were added), and leaves.<format> and petioles.<format> for each format (.glb holds both; a
/// scene without leaves has none).
void write_leaf_files(const std::filesystem::path& folder, const Foliage& foliage,
                      const std::string& report_json, const std::vector<std::string>& mesh_formats);

}  // namespace dendrofit::cli
