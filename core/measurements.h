// SPDX-License-Identifier: GPL-3.0-or-later
// Repeated measurements of one quantity over time.
#pragma once

#include <string>
#include <vector>

namespace dendrofit {

/// One tree's (plot's, pot's) measurements. Times and values have equal length, are finite, and come in file
/// order.
struct MeasurementSeries {
  std::string name;
  std::vector<double> time;
  std::vector<double> value;
};

}  // namespace dendrofit
