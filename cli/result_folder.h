// SPDX-License-Identifier: GPL-3.0-or-later
// A folder of results, read back to be looked at.
#pragma once

#include "cli/report/report.h"
#include "core/foliage.h"
#include "core/metrics.h"
#include "core/tree.h"

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace dendrofit::cli {

/// What run, reconstruct, fit, grow and leaves leave behind, as far as it is there.
struct ResultFolder {
  std::optional<Tree> model;    ///< qsm.csv
  std::optional<Tree> regrown;  ///< regrown/qsm.csv, or qsm.csv where birth_cycles.csv says that it was grown
  std::optional<TreeMetrics> model_metrics, regrown_metrics;
  std::optional<Foliage> foliage;  ///< leaves.glb, else leaves.obj as one mesh; with shoots.csv
  ReportData report;               ///< what report.json says; else the curves of growth.csv
  std::string overlay_png;

  bool empty() const { return !model && !regrown && !foliage; }
  /// The tree its leaves stand on; nullptr where the folder has no tree.
  const Tree* bearer() const { return regrown ? &*regrown : model ? &*model : nullptr; }
  std::size_t leaf_count = 0;  ///< 0 where they are one mesh
};

/// Throws IoError for a file that is there and cannot be read.
ResultFolder read_result_folder(const std::filesystem::path& folder);

}  // namespace dendrofit::cli
