// SPDX-License-Identifier: GPL-3.0-or-later
// The picture and the page that end a run.
#pragma once

#include "cli/command.h"
#include "cli/observed_tree.h"
#include "cli/stopwatch.h"
#include "core/metrics.h"
#include "fit/fit_tree.h"
#include "forward/igm/grow.h"
#include "forward/leaves/insert_leaves.h"

#include <filesystem>

namespace dendrofit::cli {

/// Everything a run made, borrowed for the call.
struct RunResults {
  Session& session;
  const ObservedTree& observed;
  const TreeFit& fit;
  const IgmGrowth& regrown;
  const TreeMetrics& regrown_metrics;
  const LeafResult& leaves;
  Stopwatch& watch;
};

/// side_by_side.png and report.html in `folder`.
void write_run_report(const std::filesystem::path& folder, const RunResults& results);

}  // namespace dendrofit::cli
