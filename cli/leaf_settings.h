// SPDX-License-Identifier: GPL-3.0-or-later
// The options about leaves, shared by `leaves` and `run`.
#pragma once

#include "cli/command.h"
#include "forward/leaves/insert_leaves.h"

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace dendrofit::cli {

struct LeafSettings {
  std::string species = "broadleaf";
  std::optional<double> area_m2;
  std::optional<double> lai;
  std::optional<int> count;
  double season = 1;
  std::filesystem::path blade;
  std::optional<double> length_m;
  std::string inclination;
  std::vector<std::string> profile;
  double clearance_m = LeafOptions{}.clearance_m;

  void declare(OptionTable& options);
  /// Throws UsageError for more than one target or a law it cannot read, IoError for a blade it cannot.
  LeafOptions resolve(const CommonOptions& common) const;
};

/// What was asked for and what came of it, for the terminal.
void say_leaves(const Session& session, const LeafResult& result);

}  // namespace dendrofit::cli
