// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/photo_score.h"

#include "core/metrics.h"
#include "core/neighbors.h"
#include "core/tree_topology.h"
#include "tests/support/photo_render.h"

#include <algorithm>
#include <cmath>
#include <map>

namespace dendrofit::bench {
namespace {

struct Samples {
  std::vector<Vec3> at;
  std::vector<std::uint32_t> node;
  std::vector<double> weight;
};

/// Every centimetre of the axes; `least` of the radius. Positions relative to `shift`.
Samples sample_axes(const Tree& tree, const Vec3& shift, double least) {
  Samples s;
  for (std::uint32_t i = 0; i < tree.size(); ++i) {
    if (tree.radius[i] < least) continue;
    const int n = std::max(1, static_cast<int>(std::ceil(tree.length(i) / 0.01)));
    for (int k = 0; k < n; ++k) {
      s.at.push_back(tree.start[i] + (tree.end[i] - tree.start[i]) * ((k + 0.5) / n) + tree.origin_shift -
                     shift);
      s.node.push_back(i);
      s.weight.push_back(tree.length(i) / n);
    }
  }
  return s;
}

/// The nearest axis of a tree to any point.
class AxisIndex {
 public:
  AxisIndex(const Tree& tree, const Vec3& shift)
      : tree_(tree),
        offset_(tree.origin_shift - shift),
        samples_(sample_axes(tree, shift, 0)),
        index_(samples_.at) {}
  std::pair<double, std::uint32_t> nearest(const Vec3& p) const {
    std::vector<Neighbor> found;
    index_.nearest(p, 8, found);
    double least = 1e300;
    std::uint32_t best = 0;
    for (const Neighbor& f : found) {
      const std::uint32_t i = samples_.node[f.index];
      const Vec3 run = tree_.end[i] - tree_.start[i], from = p - offset_ - tree_.start[i];
      const double t = std::clamp(from.dot(run) / run.squaredNorm(), 0.0, 1.0);
      const double d = (from - t * run).norm();
      if (d < least) least = d, best = i;
    }
    return {least, best};
  }

 private:
  const Tree& tree_;
  Vec3 offset_;
  Samples samples_;
  Neighbors index_;
};

void score_parents(const Tree& model, const Tree& truth, const AxisIndex& true_axes, const Vec3& shift,
                   const std::vector<double>& covered, PhotoScore& score) {
  // Each cylinder of the model belongs to the true axis most of it follows.
  const Samples samples = sample_axes(model, shift, 0);
  std::vector<std::map<std::int32_t, double>> votes(model.size());
  for (std::size_t s = 0; s < samples.at.size(); ++s) {
    const auto [d, node] = true_axes.nearest(samples.at[s]);
    if (d <= 0.02 + truth.radius[node]) votes[samples.node[s]][truth.axis[node]] += samples.weight[s];
  }
  std::vector<std::int32_t> label(model.size(), -1);
  for (std::size_t i = 0; i < model.size(); ++i) {
    double most = 0;
    for (const auto& [axis, weight] : votes[i])
      if (weight > most) most = weight, label[i] = axis;
  }
  const std::vector<Axis> axes = axes_of(truth);
  std::vector<std::map<std::int32_t, int>> bearer(axes.size());
  for (std::size_t i = 0; i < model.size(); ++i) {
    if (label[i] < 0) continue;
    std::int32_t up = model.parent[i];
    while (up >= 0 &&
           (label[static_cast<std::size_t>(up)] == label[i] || label[static_cast<std::size_t>(up)] < 0))
      up = model.parent[static_cast<std::size_t>(up)];
    ++bearer[static_cast<std::size_t>(label[i])][up < 0 ? -1 : label[static_cast<std::size_t>(up)]];
  }
  int good = 0;
  for (std::size_t a = 0; a < axes.size(); ++a) {
    double thickest = 0;
    for (const std::int32_t n : axes[a].nodes)
      thickest = std::max(thickest, truth.radius[static_cast<std::size_t>(n)]);
    if (axes[a].parent_axis < 0 || thickest < 0.01 || covered[a] < 0.5 || bearer[a].empty()) continue;
    ++score.parents_tested;
    const auto most = std::max_element(bearer[a].begin(), bearer[a].end(),
                                       [](const auto& x, const auto& y) { return x.second < y.second; });
    good += most->first == axes[a].parent_axis;
  }
  score.parents = score.parents_tested ? static_cast<double>(good) / score.parents_tested : 0;
}

void score_reprojection(const Tree& model, const ViewSet& views, PhotoScore& score) {
  Tree moved = model;
  const Vec3 shift = model.origin_shift - views.origin_shift;
  for (std::size_t i = 0; i < moved.size(); ++i) moved.start[i] += shift, moved.end[i] += shift;
  double iou = 0, precision = 0, recall = 0;
  for (const View& view : views.views) {
    const View again = test::render_view(moved, view.camera, {.photograph = false});
    const auto &a = view.photo.mask, &b = again.photo.mask;
    const int w = view.photo.width, h = view.photo.height;
    std::size_t both = 0, either = 0, in_a = 0, in_b = 0, near_a = 0, near_b = 0;
    const auto near = [&](const std::vector<std::uint8_t>& mask, int x, int y) {
      for (int dy = -1; dy <= 1; ++dy)
        for (int dx = -1; dx <= 1; ++dx)
          if (x + dx >= 0 && x + dx < w && y + dy >= 0 && y + dy < h &&
              mask[view.photo.pixel(x + dx, y + dy)])
            return true;
      return false;
    };
    for (int y = 0; y < h; ++y)
      for (int x = 0; x < w; ++x) {
        const bool p = a[view.photo.pixel(x, y)] != 0, q = b[view.photo.pixel(x, y)] != 0;
        both += p && q;
        either += p || q;
        in_a += p;
        in_b += q;
        near_a += p && near(b, x, y);
        near_b += q && near(a, x, y);
      }
    iou += static_cast<double>(both) / static_cast<double>(std::max<std::size_t>(1, either));
    recall += static_cast<double>(near_a) / static_cast<double>(std::max<std::size_t>(1, in_a));
    precision += static_cast<double>(near_b) / static_cast<double>(std::max<std::size_t>(1, in_b));
  }
  const auto n = static_cast<double>(views.views.size());
  score.iou = iou / n;
  score.near_precision = precision / n;
  score.near_recall = recall / n;
}

}  // namespace

PhotoScore score_tree(const Tree& model, const Tree& truth, const ViewSet& views) {
  PhotoScore score;
  const Vec3 shift = truth.origin_shift;
  const AxisIndex true_axes(truth, shift), model_axes(model, shift);
  double hit = 0, all = 0;
  const Samples ours = sample_axes(model, shift, 0.005);
  for (std::size_t s = 0; s < ours.at.size(); ++s) {
    const auto [d, node] = true_axes.nearest(ours.at[s]);
    all += ours.weight[s];
    hit += d <= 0.02 + truth.radius[node] ? ours.weight[s] : 0;
  }
  score.precision = all > 0 ? hit / all : 0;
  hit = all = 0;
  const Samples theirs = sample_axes(truth, shift, 0.005);
  const std::size_t axis_count = static_cast<std::size_t>(truth.axis_count());
  std::vector<double> covered(axis_count, 0), length(axis_count, 0), radius_errors;
  for (std::size_t s = 0; s < theirs.at.size(); ++s) {
    const auto [d, node] = model_axes.nearest(theirs.at[s]);
    const double r = truth.radius[theirs.node[s]];
    const bool found = d <= 0.02 + r;
    const auto axis = static_cast<std::size_t>(truth.axis[theirs.node[s]]);
    all += theirs.weight[s];
    length[axis] += theirs.weight[s];
    if (!found) continue;
    hit += theirs.weight[s];
    covered[axis] += theirs.weight[s];
    if (r >= 0.01) radius_errors.push_back(model.radius[node] / r - 1);
  }
  score.recall = all > 0 ? hit / all : 0;
  if (score.precision + score.recall > 0)
    score.f = 2 * score.precision * score.recall / (score.precision + score.recall);
  for (std::size_t a = 0; a < axis_count; ++a) covered[a] /= std::max(1e-12, length[a]);
  if (!radius_errors.empty()) {
    const auto middle = radius_errors.begin() + static_cast<std::ptrdiff_t>(radius_errors.size() / 2);
    std::nth_element(radius_errors.begin(), middle, radius_errors.end());
    score.radius_bias = *middle;
  }
  score_parents(model, truth, true_axes, shift, covered, score);
  const TreeMetrics got = measure(model), want = measure(truth);
  score.height_error = got.height_m / want.height_m - 1;
  score.true_dbh_m = want.dbh_m.value_or(0);
  if (got.dbh_m && want.dbh_m) score.dbh_error_m = *got.dbh_m - *want.dbh_m;
  if (!views.views.empty()) score_reprojection(model, views, score);
  return score;
}

}  // namespace dendrofit::bench
