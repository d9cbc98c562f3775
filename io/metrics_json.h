// SPDX-License-Identifier: GPL-3.0-or-later
// metrics.json: what is measured on a tree.
#pragma once

#include "core/metrics.h"

#include <filesystem>
#include <span>
#include <string>

namespace dendrofit {

/// The file's content: an indented JSON object with one key a field of TreeMetrics; absent values are null.
/// Of a stand, `metrics` is of all wood together, and the key `trees` holds an object for each tree (`trees`
/// empty: no such key). `crs`: the coordinate system that the tree's positions are in, as its scan states it
/// (WKT or "EPSG:n"), under the key `crs` (empty: no such key).
std::string metrics_to_json(const TreeMetrics& metrics, std::span<const TreeMetrics> trees = {},
                            const std::string& crs = {});

void write_metrics(const std::filesystem::path& path, const TreeMetrics& metrics,
                   std::span<const TreeMetrics> trees = {}, const std::string& crs = {});

/// Reads such a file back; unknown keys are ignored, missing ones keep their default (height_m must be
/// there). Throws IoError naming file and byte or key.
TreeMetrics metrics_from_json(const std::filesystem::path& path);

/// The key `crs` of the metrics.json in the folder of this tree model, where the model is that folder's
/// qsm.csv; empty where there is none. Throws IoError for such a file that cannot be read.
std::string crs_beside(const std::filesystem::path& tree_model);

}  // namespace dendrofit
