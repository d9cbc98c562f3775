// SPDX-License-Identifier: GPL-3.0-or-later
// What a file holds, for `dendrofit info`.
#pragma once

#include "core/point_cloud.h"
#include "core/progress.h"
#include "core/tree.h"
#include "io/write_cloud.h"

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace dendrofit {

/// What a file turned out to be; exactly one of cloud and tree is set unless kind is "mesh" or "table".
struct FileInfo {
  std::string kind;  ///< "cloud", "tree", "mesh" or "table"
  std::string
      format;  ///< "las", "laz", "ply", "pcd", "xyz", "ptx", "e57", "dendrofit", "treeqsm-text", "glb", ...
  std::uint64_t bytes = 0;
  std::vector<std::pair<std::string, std::string>> details;  ///< further facts in order: "version" "1.4", ...
  std::string crs_wkt;  ///< as the file states it, or the metrics.json beside a qsm.csv; else empty
  Bounds bounds;        ///< world coordinates, metres
  std::optional<PointCloud> cloud;
  std::optional<LasFrame> frame;  ///< of LAS and LAZ
  std::optional<Tree> tree;
  std::size_t series = 0;  ///< of a measurement table
  std::size_t rows = 0;    ///< measurements of a table; triangles of a mesh
};

/// Reads the whole file, so that what is told is what every command would see. Throws IoError as the readers
/// do, and for a file that is of no known kind.
FileInfo describe_file(const std::filesystem::path& path, Progress& progress = no_progress());

}  // namespace dendrofit
