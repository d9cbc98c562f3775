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
/// empty: no such key).
std::string metrics_to_json(const TreeMetrics& metrics, std::span<const TreeMetrics> trees = {});

void write_metrics(const std::filesystem::path& path, const TreeMetrics& metrics,
                   std::span<const TreeMetrics> trees = {});

/// Reads such a file back; unknown keys are ignored, missing ones keep their default (height_m must be
/// there). Throws IoError naming file and byte or key.
TreeMetrics metrics_from_json(const std::filesystem::path& path);

}  // namespace dendrofit
