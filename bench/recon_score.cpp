// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/recon_score.h"

#include "core/neighbors.h"
#include "core/tree_topology.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <vector>

namespace dendrofit::bench {
namespace {

constexpr double kStep = 0.01, kThinnest = 0.005, kTolerance = 0.02, kCosine = 0.7071;
constexpr std::size_t kCandidates = 24;

/// A tree's axes as points, in the frame of `origin`.
struct Samples {
  const Tree& tree;
  Vec3 shift;
  std::vector<Vec3> at;
  std::vector<std::uint32_t> node;
  std::vector<double> weight;
  Samples(const Tree& t, const Vec3& origin, double thinnest) : tree(t), shift(t.origin_shift - origin) {
    for (std::size_t i = 0; i < t.size(); ++i) {
      if (t.radius[i] < thinnest) continue;
      const int n = std::max(1, static_cast<int>(std::ceil(t.length(i) / kStep)));
      for (int k = 0; k < n; ++k) {
        at.push_back(shift + t.start[i] + (k + 0.5) / n * (t.end[i] - t.start[i]));
        node.push_back(static_cast<std::uint32_t>(i));
        weight.push_back(t.length(i) / n);
      }
    }
  }
};

struct Match {
  double nearest = 1e9, aligned = 1e9;  // distances
  std::int32_t nearest_node = -1, aligned_node = -1;
};

std::vector<Match> match(const Samples& from, const Samples& to, const Neighbors& index) {
  std::vector<Match> matches(from.at.size());
  std::vector<Neighbor> found;
  for (std::size_t i = 0; i < from.at.size(); ++i) {
    index.nearest(from.at[i], kCandidates, found);
    const Vec3 heading = from.tree.direction(from.node[i]);
    for (const Neighbor& f : found) {
      const std::uint32_t c = to.node[f.index];
      const Vec3 along = to.tree.direction(c), d = from.at[i] - to.shift - to.tree.start[c];
      const double t = std::clamp(d.dot(along), 0.0, to.tree.length(c));
      const double distance = (d - t * along).norm();
      Match& m = matches[i];
      if (distance < m.nearest) m.nearest = distance, m.nearest_node = static_cast<std::int32_t>(c);
      if (std::abs(along.dot(heading)) >= kCosine && distance < m.aligned)
        m.aligned = distance, m.aligned_node = static_cast<std::int32_t>(c);
    }
  }
  return matches;
}

double f_score(double precision, double recall) {
  return precision + recall > 0 ? 2 * precision * recall / (precision + recall) : 0;
}

struct Share {
  double good = 0, all = 0;
  void add(bool hit, double weight) {
    all += weight;
    if (hit) good += weight;
  }
  double value() const { return all > 0 ? good / all : 0; }
};

/// Whether a strayed sample runs inside thicker wood of its own model: neither right nor wrong.
bool is_stub(const Samples& samples, std::size_t i, const Samples& all, const Neighbors& own,
             std::vector<Neighbor>& found) {
  own.nearest(samples.at[i], kCandidates, found);
  const double r = samples.tree.radius[samples.node[i]];
  for (const Neighbor& f : found) {
    const double thick = all.tree.radius[all.node[f.index]];
    if (thick >= 0.02 && thick > 1.25 * r && f.distance_squared < 0.96 * thick * thick) return true;
  }
  return false;
}

/// The true axis each model cylinder lies on, by its samples; -1 for none.
std::vector<std::int32_t> true_axes(const Samples& model, const std::vector<Match>& matches,
                                    const Tree& truth) {
  std::vector<std::map<std::int32_t, double>> votes(model.tree.size());
  for (std::size_t i = 0; i < matches.size(); ++i) {
    const Match& m = matches[i];
    const std::int32_t n = m.aligned <= m.nearest + kTolerance ? m.aligned_node : m.nearest_node;
    if (n < 0 || m.nearest > kTolerance + truth.radius[static_cast<std::size_t>(m.nearest_node)]) continue;
    votes[model.node[i]][truth.axis[static_cast<std::size_t>(n)]] += model.weight[i];
  }
  std::vector<std::int32_t> axis(model.tree.size(), -1);
  for (std::size_t i = 0; i < votes.size(); ++i) {
    double most = 0;
    for (const auto& [a, w] : votes[i])
      if (w > most) most = w, axis[i] = a;
  }
  return axis;
}

/// Share of the true branches, as far as found, whose cylinders come from the right branch.
double parents_right(const Samples& model, const std::vector<Match>& matches, const Tree& truth) {
  const std::vector<std::int32_t> on = true_axes(model, matches, truth);
  const std::vector<Axis> axes = axes_of(truth);
  std::vector<std::map<std::int32_t, int>> from(axes.size());
  for (std::size_t i = 0; i < on.size(); ++i) {
    if (on[i] < 0) continue;
    std::int32_t j = model.tree.parent[i];
    while (j >= 0 && (on[static_cast<std::size_t>(j)] < 0 || on[static_cast<std::size_t>(j)] == on[i]))
      j = model.tree.parent[static_cast<std::size_t>(j)];
    ++from[static_cast<std::size_t>(on[i])][j >= 0 ? on[static_cast<std::size_t>(j)] : -1];
  }
  int right = 0, all = 0;
  for (std::size_t a = 0; a < axes.size(); ++a) {
    if (axes[a].parent_axis < 0 || from[a].empty()) continue;
    if (truth.radius[static_cast<std::size_t>(axes[a].nodes.front())] < kThinnest) continue;
    const auto most = std::max_element(from[a].begin(), from[a].end(),
                                       [](const auto& x, const auto& y) { return x.second < y.second; });
    ++all;
    right += most->first == axes[a].parent_axis;
  }
  return all > 0 ? static_cast<double>(right) / all : 1;
}

double volume_over_1cm(const Tree& tree) {
  double volume = 0;
  for (std::size_t i = 0; i < tree.size(); ++i)
    if (tree.radius[i] >= 0.01) volume += tree.volume(i);
  return volume;
}

}  // namespace

AxisScore score_axes(const Tree& model, const Tree& truth, const std::vector<std::uint32_t>& hits) {
  AxisScore score;
  const Samples m(model, truth.origin_shift, kThinnest), t(truth, truth.origin_shift, kThinnest);
  // What is sampled may be matched by thinner wood too.
  const Samples all_model(model, truth.origin_shift, 0), all_truth(truth, truth.origin_shift, 0);
  score.volume_1cm = volume_over_1cm(model);
  score.true_volume_1cm = volume_over_1cm(truth);
  if (m.at.empty() || t.at.empty()) return score;
  const Neighbors model_index(all_model.at), truth_index(all_truth.at);
  const std::vector<Match> of_truth = match(t, all_model, model_index),
                           of_model = match(m, all_truth, truth_index);
  Share loose_recall, strict_recall, thick_recall, loose_precision, strict_precision, thick_precision;
  std::vector<double> errors;
  for (std::size_t i = 0; i < of_truth.size(); ++i) {
    const double r = truth.radius[t.node[i]];
    const bool strict = of_truth[i].aligned <= kTolerance + 0.25 * r;
    loose_recall.add(of_truth[i].nearest <= kTolerance + r, t.weight[i]);
    strict_recall.add(strict, t.weight[i]);
    if (r >= 0.01 && (hits.empty() || hits[t.node[i]] >= 3)) thick_recall.add(strict, t.weight[i]);
    if (strict) errors.push_back(model.radius[static_cast<std::size_t>(of_truth[i].aligned_node)] / r - 1);
  }
  std::vector<Neighbor> found;
  for (std::size_t i = 0; i < of_model.size(); ++i) {
    const Match& at = of_model[i];
    const auto radius = [&](std::int32_t n) { return n < 0 ? 0 : truth.radius[static_cast<std::size_t>(n)]; };
    const bool strict = at.aligned <= kTolerance + 0.25 * radius(at.aligned_node);
    loose_precision.add(at.nearest <= kTolerance + radius(at.nearest_node), m.weight[i]);
    if (!strict && is_stub(m, i, all_model, model_index, found)) continue;
    strict_precision.add(strict, m.weight[i]);
    if (model.radius[m.node[i]] >= 0.01) thick_precision.add(strict, m.weight[i]);
  }
  score.loose_f = f_score(loose_precision.value(), loose_recall.value());
  score.strict_f = f_score(strict_precision.value(), strict_recall.value());
  score.strict_f_thick = f_score(thick_precision.value(), thick_recall.value());
  if (!errors.empty()) {
    const auto middle = errors.begin() + static_cast<std::ptrdiff_t>(errors.size() / 2);
    std::nth_element(errors.begin(), middle, errors.end());
    score.radius_bias = *middle;
  }
  score.parent_agreement = parents_right(m, of_model, truth);
  return score;
}

LeafScore score_leaves(const PointCloud& cloud, const std::vector<char>& is_leaf,
                       const std::vector<float>& radius, const PointCloud& called_leaf, double merged_m) {
  std::vector<Vec3> places;
  for (const Vec3& p : called_leaf.points)
    places.push_back(p + (called_leaf.origin_shift - cloud.origin_shift));
  const Neighbors index(places);
  std::vector<Neighbor> found;
  Share right, thick, wood;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    if (!is_leaf[i] && radius[i] <= 0) continue;
    bool called = false;
    if (!places.empty()) {
      index.nearest(cloud.points[i], 1, found);
      called = found.front().distance_squared <= merged_m * merged_m;
    }
    right.add(called == (is_leaf[i] != 0), 1);
    if (is_leaf[i]) continue;
    wood.add(called, 1);
    if (radius[i] >= 0.01f) thick.add(!called, 1);
  }
  return {right.value(), thick.value(), wood.value()};
}

}  // namespace dendrofit::bench
