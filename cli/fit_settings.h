// SPDX-License-Identifier: GPL-3.0-or-later
// The options of a growth-model fit, and its files: shared by `fit` and `run`.
#pragma once

#include "cli/command.h"
#include "fit/fit_trees.h"

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace dendrofit::cli {

struct FitSettings {
  std::string budget = "200";
  std::optional<double> age_years;
  std::optional<double> internode_length_m;
  std::optional<double> thinnest_wood_m;
  std::string equation = "logistic";
  std::filesystem::path heights;

  void declare(OptionTable& options);
  /// --budget is a number of parameter sets ("500") or a time ("8min"). Throws UsageError for neither, and
  /// for a table of heights that holds several series. Warns where the bank of prior simulations is missing.
  FitOptions resolve(const Session& session) const;
  /// Files besides the tree that the fit reads.
  std::vector<std::filesystem::path> inputs() const;
};

/// fit.json's content.
std::string fit_json(const TreeFit& fit);

/// fit.json's content for several trees: what they share, and each tree's own.
std::string trees_fit_json(const TreesFit& fit);

/// fit.json and params.toml.
void write_fit(const std::filesystem::path& folder, const TreeFit& fit);

/// One line a parameter.
void say_parameters(const Session& session, const std::vector<FittedParameter>& parameters);
void say_fit(const Session& session, const TreeFit& fit);

}  // namespace dendrofit::cli
