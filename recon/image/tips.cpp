// SPDX-License-Identifier: GPL-3.0-or-later
#include "recon/image/tips.h"

#include "core/tree_topology.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace dendrofit {
namespace {

constexpr double kOnMask = 0.7;    // pixels
constexpr double kViews = 0.75;    // share that must show the way
constexpr double kGap = 2;         // pixels
constexpr double kFarthest = 0.3;  // metres
constexpr double kShortest = 3;    // pixels: less is no news

/// Direction of an axis's last 10 cm (at least two cylinders, where it has them).
Vec3 last_direction(const Tree& tree, const Axis& axis) {
  const auto tip = static_cast<std::size_t>(axis.nodes.back());
  Vec3 from = tree.start[tip];
  for (std::size_t k = axis.nodes.size() - 1; k-- > 0;) {
    if ((tree.end[tip] - from).norm() > 0.1) break;
    from = tree.start[static_cast<std::size_t>(axis.nodes[k])];
  }
  const Vec3 run = tree.end[tip] - from;
  return run.norm() > 1e-9 ? Vec3(run.normalized()) : tree.direction(tip);
}

double shown(const Vec3& at, const std::vector<Camera>& cameras, const std::vector<Outline>& outlines) {
  double on = 0, asked = 0;
  for (std::size_t v = 0; v < cameras.size(); ++v) {
    const auto pixel = cameras[v].project(at);
    if (!pixel || outlines[v].unknown(*pixel)) continue;
    ++asked;
    on += outlines[v].at(*pixel) <= kOnMask;
  }
  return asked > 0 ? on / asked : 0;
}

}  // namespace

void extend_tips(Tree& tree, const std::vector<Camera>& cameras, const std::vector<Outline>& outlines) {
  for (const Axis& axis : axes_of(tree)) {
    const auto tip = static_cast<std::size_t>(axis.nodes.back());
    const Vec3 direction = last_direction(tree, axis), from = tree.end[tip];
    double pixel_m = std::numeric_limits<double>::infinity();
    for (const Camera& camera : cameras)
      if (camera.depth(from) > 0) pixel_m = std::min(pixel_m, camera.depth(from) / camera.fx);
    if (!std::isfinite(pixel_m)) continue;
    const double most = std::min(kFarthest, axis.length);
    double reached = 0;
    for (double s = 0.5 * pixel_m; s <= most && s - reached <= kGap * pixel_m; s += 0.5 * pixel_m)
      if (shown(from + s * direction, cameras, outlines) >= kViews) reached = s;
    if (reached < kShortest * pixel_m) continue;
    TreeNode node = tree.node(tip);
    node.start = from;
    node.end = from + reached * direction;
    node.parent = static_cast<std::int32_t>(tip);
    node.quality = RadiusQuality::extrapolated;
    tree.add(node);
  }
}

}  // namespace dendrofit
