// SPDX-License-Identifier: GPL-3.0-or-later
// What the recovery bench writes down, and how it sums it up.
#pragma once

#include <string>
#include <vector>

namespace dendrofit {

/// One true value beside its estimate.
struct RecoveryLine {
  int truth = 0;
  std::string key;
  double value = 0, estimate = 0, lo = 0, hi = 0, lo50 = 0, hi50 = 0, shrinkage = 0, rank = 0;
};

std::vector<RecoveryLine> read_table(const std::string& file);
std::string table_row(const RecoveryLine& line);
/// A Markdown table on standard output, one row a parameter.
void summarise(const std::vector<RecoveryLine>& lines);

}  // namespace dendrofit
