// SPDX-License-Identifier: GPL-3.0-or-later
// Growth-curve fitting on one core: 107 trees x 3 equations with profile-likelihood intervals. The trees are
// simulated as stem analyses of spruce (ages 10 to 140, heights in metres), so that the program needs no
// data; with DENDROFIT_GROWTH_TABLE set to a `series,time,value` table it measures that instead.
#include "fit/growth_report.h"
#include "tests/support/csv.h"
#include "tests/support/growth_data.h"

#include <cstdlib>
#include <map>
#include <string>

#include <benchmark/benchmark.h>

namespace {

using namespace dendrofit;

std::vector<MeasurementSeries> trees() {
  std::vector<MeasurementSeries> all;
  if (const char* table = std::getenv("DENDROFIT_GROWTH_TABLE")) {
    for (const auto& [name, series] : test::read_series(table))
      if (name != "__pooled__") all.push_back(series);
    return all;
  }
  Random random(1);
  for (int i = 0; i < 107; ++i)
    all.push_back(
        test::simulated("tree" + std::to_string(i), "chapman_richards",
                        {random.uniform(18, 40), random.uniform(0.018, 0.035), random.uniform(1.4, 2.6)},
                        test::ages(10, 140, 12), 0.3, 1000 + i));
  return all;
}

void fit_trees(benchmark::State& state, bool intervals) {
  const auto all = trees();
  GrowthOptions options;
  options.threads = 1;
  options.pooled = false;
  options.profile_intervals = intervals;
  std::size_t fits = 0;
  for (auto _ : state) {
    const GrowthReport report = fit_growth(all, options);
    fits += report.series.size() * options.equations.size();
    benchmark::DoNotOptimize(report.series.front().fits.front().rss);
  }
  state.counters["fits"] = static_cast<double>(all.size() * options.equations.size());
  state.counters["fits_per_s"] = benchmark::Counter(static_cast<double>(fits), benchmark::Counter::kIsRate);
}

void with_intervals(benchmark::State& state) {
  fit_trees(state, true);
}
void without_intervals(benchmark::State& state) {
  fit_trees(state, false);
}

BENCHMARK(with_intervals)->Unit(benchmark::kMillisecond);
BENCHMARK(without_intervals)->Unit(benchmark::kMillisecond);

}  // namespace

BENCHMARK_MAIN();
