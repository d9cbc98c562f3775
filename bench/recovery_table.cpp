// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/recovery_table.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <map>
#include <sstream>

#include <fmt/format.h>

namespace dendrofit {
namespace {

double middle(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values.empty() ? 0 : values[values.size() / 2];
}

}  // namespace

std::vector<RecoveryLine> read_table(const std::string& file) {
  std::vector<RecoveryLine> lines;
  std::ifstream in(file);
  for (std::string text; std::getline(in, text);) {
    std::ranges::replace(text, ',', ' ');
    std::istringstream words(text);
    RecoveryLine l;
    if (words >> l.truth >> l.key >> l.value >> l.estimate >> l.lo >> l.hi >> l.lo50 >> l.hi50 >>
        l.shrinkage >> l.rank)
      lines.push_back(l);
  }
  return lines;
}

void summarise(const std::vector<RecoveryLine>& lines) {
  std::map<std::string, std::vector<RecoveryLine>> by_key;
  for (const RecoveryLine& line : lines) by_key[line.key].push_back(line);
  std::printf(
      "| parameter | n | median error | relative | bias | 50 %% covers | 90 %% covers | shrinkage | "
      "ranks in tenths |\n|---|---|---|---|---|---|---|---|---|\n");
  for (const auto& [key, rows] : by_key) {
    std::vector<double> error, relative, signed_error, shrinkage;
    double half = 0, most = 0;
    std::vector<int> tenths(10, 0);
    for (const RecoveryLine& l : rows) {
      error.push_back(std::abs(l.estimate - l.value));
      relative.push_back(l.value != 0 ? std::abs(l.estimate / l.value - 1) : 0);
      signed_error.push_back(l.estimate - l.value);
      shrinkage.push_back(l.shrinkage);
      half += l.lo50 <= l.value && l.value <= l.hi50;
      most += l.lo <= l.value && l.value <= l.hi;
      ++tenths[static_cast<std::size_t>(std::clamp(l.rank * 10, 0.0, 9.0))];
    }
    std::string ranks;
    for (const int t : tenths) ranks += fmt::format("{} ", t);
    const auto n = static_cast<double>(rows.size());
    std::printf("| %s | %zu | %.4g | %.1f %% | %+.3g | %.0f %% | %.0f %% | %.2f | %s|\n", key.c_str(),
                rows.size(), middle(error), 100 * middle(relative), middle(signed_error), 100 * half / n,
                100 * most / n, middle(shrinkage), ranks.c_str());
  }
}

std::string table_row(const RecoveryLine& l) {
  return fmt::format("{},{},{},{},{},{},{},{},{},{}\n", l.truth, l.key, l.value, l.estimate, l.lo, l.hi,
                     l.lo50, l.hi50, l.shrinkage, l.rank);
}

}  // namespace dendrofit
