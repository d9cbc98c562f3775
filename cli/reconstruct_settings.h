// SPDX-License-Identifier: GPL-3.0-or-later
// Scan in, tree out, files written: what `reconstruct`, `fit` and `run` have in common.
#pragma once

#include "cli/command.h"
#include "io/read_cloud.h"
#include "recon/reconstruct.h"

#include <filesystem>
#include <optional>
#include <string>

namespace dendrofit::cli {

struct ReconstructSettings {
  ReconstructOptions options;
  std::string columns, delimiter, tree_at;

  void declare(OptionTable& table);
  PointCloud read_scan(const Session& session, const std::filesystem::path& file, Progress& progress) const;
  ReconstructOptions resolve(const CommonOptions& common) const;
  /// Throws UsageError for an option that chooses within a scan.
  void check_for_photographs() const;
};

/// qsm.csv, metrics.json (with the scan's coordinate system `crs`), reconstruction.json, tree meshes and, on
/// a leaf-on scan, leaf_points.ply.
void write_reconstruction(const std::filesystem::path& folder, const Reconstruction& result,
                          const std::vector<std::string>& mesh_formats, const std::string& crs = {});

/// The facts beside the metrics (points by stage, foot, wood share, noise, warnings) as a JSON object.
std::string reconstruction_json(const Reconstruction& result);

void say_reconstruction(const Session& session, const Reconstruction& result);

}  // namespace dendrofit::cli
