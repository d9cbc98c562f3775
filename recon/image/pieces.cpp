// SPDX-License-Identifier: GPL-3.0-or-later
#include "recon/image/pieces.h"

#include "core/errors.h"
#include "recon/image/distance.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numeric>

#include <opencv2/imgproc.hpp>

namespace dendrofit {
namespace {

constexpr double kSolid = 0.6;       ///< share of a crown without sky between, above which it is in leaf
constexpr double kLeafWidth = 0.06;  ///< solid parts of a leafy crown are wider than this share of the height

cv::Mat view(const std::vector<std::uint8_t>& pixels, int width, int height) {
  return cv::Mat(height, width, CV_8U, const_cast<std::uint8_t*>(pixels.data()));
}

std::string at(const Eigen::Vector2d& p) {
  char text[48];
  std::snprintf(text, sizeof text, "%.0f,%.0f", p.x(), p.y());
  return text;
}

}  // namespace

std::vector<TreeGroup> group_pieces(const std::vector<std::uint8_t>& tree, int width, int height,
                                    double gap_px, std::vector<std::int32_t>& group) {
  const std::vector<float> outside = distance_outside(tree, width, height);
  std::vector<std::uint8_t> wide(tree.size());
  for (std::size_t i = 0; i < tree.size(); ++i) wide[i] = outside[i] <= 0.5 * gap_px ? 1 : 0;
  cv::Mat labels;
  const int count = cv::connectedComponents(view(wide, width, height), labels, 8, CV_32S);
  std::vector<TreeGroup> groups(static_cast<std::size_t>(count));
  for (TreeGroup& g : groups) g.top = height, g.left = width, g.bottom = g.right = -1;
  std::vector<double> foot_sum(groups.size(), 0);
  std::vector<int> foot_count(groups.size(), 0);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const std::size_t p =
          static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x);
      if (!tree[p]) continue;
      const auto id = static_cast<std::size_t>(labels.at<int>(y, x));
      TreeGroup& g = groups[id];
      if (y != g.bottom) foot_sum[id] = 0, foot_count[id] = 0;
      foot_sum[id] += x + 0.5;
      ++foot_count[id];
      ++g.pixels;
      g.top = std::min(g.top, y);
      g.bottom = y;
      g.left = std::min(g.left, x);
      g.right = std::max(g.right, x);
      g.foot = {foot_sum[id] / foot_count[id], y + 0.5};
    }
  std::vector<std::size_t> order(groups.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t l, std::size_t r) { return groups[l].pixels > groups[r].pixels; });
  std::vector<std::int32_t> rank(groups.size(), -1);
  std::vector<TreeGroup> sorted;
  for (const std::size_t id : order) {
    if (groups[id].pixels == 0) break;
    rank[id] = static_cast<std::int32_t>(sorted.size());
    sorted.push_back(groups[id]);
  }
  group.assign(tree.size(), -1);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const std::size_t p =
          static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x);
      if (tree[p]) group[p] = rank[static_cast<std::size_t>(labels.at<int>(y, x))];
    }
  return sorted;
}

void choose_tree(Silhouette& s, const std::optional<Eigen::Vector2d>& root) {
  std::vector<std::int32_t> group;
  const double gap = std::max(6.0, 0.006 * s.height);
  const std::vector<TreeGroup> groups = group_pieces(s.tree, s.width, s.height, gap, group);
  if (groups.empty()) throw SolverError("no tree found: nothing darker than the sky");
  std::size_t chosen = 0;
  if (root) {
    double nearest = 1e300;
    for (int y = 0; y < s.height; ++y)
      for (int x = 0; x < s.width; ++x) {
        if (group[s.pixel(x, y)] < 0) continue;
        const double d = (Eigen::Vector2d(x + 0.5, y + 0.5) - *root).squaredNorm();
        if (d >= nearest) continue;
        nearest = d;
        chosen = static_cast<std::size_t>(group[s.pixel(x, y)]);
      }
  }
  // Another tree is a group nearly as tall that does not hang in the chosen one's crown.
  const TreeGroup& own = groups[chosen];
  std::vector<std::size_t> others;
  for (std::size_t g = 0; g < groups.size(); ++g)
    if (g != chosen && groups[g].height() > 0.4 * own.height() && groups[g].pixels > own.pixels / 20 &&
        groups[g].bottom > own.bottom - own.height() / 2)
      others.push_back(g);
  s.tree_count = static_cast<int>(others.size()) + 1;
  if (!others.empty())
    s.warnings.push_back(std::to_string(s.tree_count) + " trees: using the one at " + at(own.foot) +
                         "; choose with --root");
  // Loose pieces stay with the chosen tree unless they are nearer to another.
  std::vector<std::uint8_t> mine(s.tree.size(), 0), theirs(s.tree.size(), 0);
  for (std::size_t p = 0; p < group.size(); ++p) {
    if (group[p] < 0) continue;
    const auto g = static_cast<std::size_t>(group[p]);
    mine[p] = g == chosen;
    theirs[p] = std::find(others.begin(), others.end(), g) != others.end();
  }
  const std::vector<float> to_mine = distance_outside(mine, s.width, s.height);
  const std::vector<float> to_theirs =
      others.empty() ? std::vector<float>() : distance_outside(theirs, s.width, s.height);
  const float reach = static_cast<float>(0.05 * own.height());
  for (std::size_t p = 0; p < group.size(); ++p) {
    if (group[p] < 0) continue;
    const bool loose = !mine[p] && !theirs[p];
    if (theirs[p] || (loose && (to_mine[p] > reach || (!others.empty() && to_theirs[p] < to_mine[p])))) {
      s.tree[p] = 0;
      s.cover[p] = 0;
    }
  }
}

void describe_silhouette(Silhouette& s) {
  int top = s.height, bottom = -1;
  bool left = false, right = false;
  for (int y = 0; y < s.height; ++y)
    for (int x = 0; x < s.width; ++x) {
      if (!s.tree[s.pixel(x, y)]) continue;
      top = std::min(top, y);
      bottom = y;
      left = left || x == 0;
      right = right || x == s.width - 1;
    }
  if (bottom < 0) throw SolverError("no tree found: the silhouette is empty");
  s.touches_top = top <= 1;
  s.touches_side = left || right;
  if (s.touches_top) s.warnings.push_back("tree touches the top border: height is a lower bound");
  if (s.touches_side)
    s.warnings.push_back(std::string("tree touches the ") +
                         (left ? (right ? "left and right" : "left") : "right") +
                         " border: crown width is a lower bound");
  if (bottom >= s.height - 2)
    s.warnings.push_back("tree touches the bottom border: its foot is not in the picture");

  // Solid share: the upper part's pixels over the same with gaps of a few percent of the height closed.
  const int tall = bottom - top + 1, crown_bottom = top + tall * 7 / 10;
  const std::vector<float> outside = distance_outside(s.tree, s.width, s.height);
  std::vector<std::uint8_t> wide(s.tree.size());
  const double reach = 0.02 * tall;
  for (std::size_t p = 0; p < wide.size(); ++p) wide[p] = outside[p] <= reach ? 1 : 0;
  const std::vector<float> back = distance_inside(wide, s.width, s.height);
  const std::vector<float> inside = distance_inside(s.tree, s.width, s.height);
  std::size_t solid = 0, closed = 0;
  float widest = 0;
  for (int y = top; y < crown_bottom; ++y)
    for (int x = 0; x < s.width; ++x) {
      const std::size_t p = s.pixel(x, y);
      solid += s.tree[p];
      closed += s.tree[p] || back[p] > reach;
      widest = std::max(widest, inside[p]);
    }
  s.solid_share = closed > 0 ? static_cast<double>(solid) / static_cast<double>(closed) : 0;
  s.leafy = s.solid_share > kSolid && widest > kLeafWidth * tall;
  if (s.leafy)
    s.warnings.push_back("crown looks leafy (solid share " +
                         std::to_string(std::lround(100 * s.solid_share)) +
                         " % > 60 %): only outline metrics given");
}

}  // namespace dendrofit
