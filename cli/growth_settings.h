// SPDX-License-Identifier: GPL-3.0-or-later
// The options of `dendrofit growth` that say how to fit.
#pragma once

#include "cli/command.h"
#include "fit/growth_options.h"

#include <optional>
#include <string>
#include <vector>

namespace dendrofit::cli {

struct GrowthSettings {
  std::string equations = "logistic,bertalanffy,weibull";
  bool allometry = false;  ///< height over diameter of trees measured once
  std::string time_unit = "years", diameter_unit = "cm", value_unit = "m", to_time_unit, to_value_unit;
  std::vector<std::string> fix, bound, start;
  bool fit_offset = false, fit_time_shift = false;
  double offset = 0, loss_scale = 1, confidence = 0.95;
  std::optional<double> origin, base_age;
  std::string weights = "equal", loss = "none", mixed = "none", mixed_form = "shape", ages;
  bool no_profile = false, no_pooled = false, trunk_base_unmeasured = false;

  void declare(OptionTable& options);
  /// Throws UsageError for a malformed option, InputError for a value out of range.
  GrowthOptions resolve(const CommonOptions& common) const;
  /// Equations, or with --allometry the forms of height over diameter.
  std::vector<std::string> forms() const;
};

/// A plain number given to `option`; throws UsageError.
double option_number(const std::string& option, const std::string& text);

}  // namespace dendrofit::cli
