// SPDX-License-Identifier: GPL-3.0-or-later
// How long trees take to grow, on one core. Build with -DDENDROFIT_BENCH=ON; run
//   igm_bench --benchmark_repetitions=5 --benchmark_report_aggregates_only=true
// and read the medians of CPU time. "made" counts every internode grown, those shed later included.
#include "forward/igm/grow.h"

#include <cstdint>

#include <benchmark/benchmark.h>

namespace {

using dendrofit::GrowthRecord;
using dendrofit::IgmGrowth;
using dendrofit::IgmOptions;
using dendrofit::IgmParameters;

void count(benchmark::State& state, const IgmGrowth& growth) {
  std::int64_t shed = 0;
  for (const GrowthRecord& record : growth.series) shed += record.shed_internodes;
  const auto living = static_cast<double>(growth.tree.size());
  state.counters["living"] = living;
  state.counters["made"] = living + static_cast<double>(shed);
}

// The standard tree, whole columns of shade, to cycle 20; one seed an argument.
void standard_tree(benchmark::State& state) {
  const IgmParameters parameters = dendrofit::igm_preset("standard").parameters;
  IgmOptions options;
  options.seed = static_cast<std::uint64_t>(state.range(0));
  IgmGrowth growth;
  for (auto _ : state) growth = dendrofit::grow_igm(parameters, {}, options);
  count(state, growth);
}
BENCHMARK(standard_tree)->DenseRange(1, 3)->Unit(benchmark::kMillisecond);

// What the inverse fit asks for thousands of times: younger, smaller trees.
void young_tree(benchmark::State& state) {
  IgmParameters parameters = dendrofit::igm_preset("standard").parameters;
  parameters.cycles = static_cast<int>(state.range(0));
  IgmGrowth growth;
  for (auto _ : state) growth = dendrofit::grow_igm(parameters);
  count(state, growth);
}
BENCHMARK(young_tree)->Arg(8)->Arg(12)->Arg(16)->Unit(benchmark::kMillisecond);

// Cost over size: nothing is shed, markers are no limit, taller and taller trees (xm).
void large_tree(benchmark::State& state) {
  IgmParameters parameters = dendrofit::igm_preset("standard").parameters;
  parameters.set("xm", static_cast<double>(state.range(0)));
  parameters.shed_ratio = 0;
  parameters.max_markers = static_cast<int>(state.range(1));
  IgmGrowth growth;
  for (auto _ : state) growth = dendrofit::grow_igm(parameters);
  count(state, growth);
}
BENCHMARK(large_tree)
    ->Args({100, 20000})
    ->Args({140, 100000})
    ->Args({200, 300000})
    ->Args({400, 1000000})
    ->Args({800, 3000000})
    ->Iterations(1)
    ->Unit(benchmark::kMillisecond);

}  // namespace

BENCHMARK_MAIN();
