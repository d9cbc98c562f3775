// SPDX-License-Identifier: GPL-3.0-or-later
// Means over seeds, and how large a difference is against seed noise.
#pragma once

#include "forward/igm/grow.h"

#include <cmath>
#include <functional>
#include <vector>

namespace dendrofit::test {

struct Sample {
  std::vector<double> values;
  double mean() const {
    double sum = 0;
    for (const double v : values) sum += v;
    return sum / static_cast<double>(values.size());
  }
  double sd() const {
    double sum = 0;
    for (const double v : values) sum += (v - mean()) * (v - mean());
    return std::sqrt(sum / static_cast<double>(values.size() - 1));
  }
};

/// Difference of means over the pooled standard deviation of single trees (Cohen's d).
inline double effect(const Sample& from, const Sample& to) {
  return (to.mean() - from.mean()) / std::sqrt(0.5 * (from.sd() * from.sd() + to.sd() * to.sd()) + 1e-12);
}

inline std::vector<IgmGrowth> grow_seeds(const IgmParameters& parameters, int seeds, const IgmSite& site = {},
                                         bool until_stop = false) {
  std::vector<IgmGrowth> grown;
  for (int seed = 1; seed <= seeds; ++seed) {
    IgmOptions options;
    options.seed = static_cast<std::uint64_t>(seed);
    options.until_stop = until_stop;
    grown.push_back(grow_igm(parameters, site, options));
  }
  return grown;
}

inline Sample sample(const std::vector<IgmGrowth>& grown,
                     const std::function<double(const IgmGrowth&)>& measure) {
  Sample out;
  for (const IgmGrowth& growth : grown) out.values.push_back(measure(growth));
  return out;
}

/// The record of one tree after one cycle.
inline const GrowthRecord& at_cycle(const IgmGrowth& growth, int cycle, int tree = 0) {
  for (const GrowthRecord& record : growth.series)
    if (record.cycle == cycle && record.tree == tree) return record;
  return growth.series.back();
}

/// Length-weighted centroid of the branches.
inline Vec3 crown_centroid(const Tree& tree) {
  Vec3 sum = Vec3::Zero();
  double length = 0;
  for (std::size_t i = 0; i < tree.size(); ++i)
    if (tree.order[i] > 0) {
      sum += tree.length(i) * 0.5 * (tree.start[i] + tree.end[i]);
      length += tree.length(i);
    }
  return sum / length;
}

}  // namespace dendrofit::test
