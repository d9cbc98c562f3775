// SPDX-License-Identifier: GPL-3.0-or-later
#include "recon/build_tree.h"

#include "recon/name_axes.h"

#include <algorithm>
#include <cmath>

namespace dendrofit {
namespace {

constexpr double kShortest = 1e-4;

/// Whether the line from `from` over the nodes first..last is a cylinder of its own: a few radii long, sooner
/// where it bends.
bool closes(const Limb& limb, const Vec3& from, std::size_t first, std::size_t last) {
  const LimbNode& end = limb.nodes[last];
  const Vec3 chord = end.centre - from;
  const double length = chord.norm(), few_radii = 3 * end.radius_m;
  if (length >= std::clamp(few_radii, 0.08, 0.15)) return true;
  constexpr double kThin = 0.01;  // thinner wood's line bends by noise too
  if (length < std::clamp(few_radii, 0.02, 0.15)) return false;
  const double bend = end.radius_m < kThin ? 0.003 : std::max(0.0015, 0.1 * end.radius_m);
  for (std::size_t k = first; k < last; ++k) {
    const Vec3 d = limb.nodes[k].centre - from;
    if ((d - chord * (d.dot(chord) / (length * length))).norm() > bend) return true;
  }
  return false;
}

/// The cylinder of `cylinders` whose axis passes nearest to `point`.
std::int32_t nearest_cylinder(const Tree& tree, const std::vector<std::int32_t>& cylinders,
                              const Vec3& point) {
  std::int32_t best = cylinders.front();
  double least = 1e300;
  for (const std::int32_t c : cylinders) {
    const auto i = static_cast<std::size_t>(c);
    const Vec3 run = tree.end[i] - tree.start[i];
    const double t = std::clamp((point - tree.start[i]).dot(run) / run.squaredNorm(), 0.0, 1.0);
    const double d = (tree.start[i] + t * run - point).squaredNorm();
    if (d < least) {
      least = d;
      best = c;
    }
  }
  return best;
}

/// Where a branch that begins at `first` comes out of the cylinder: on its surface towards `first`.
Vec3 leave_surface(const Tree& tree, std::size_t i, const Vec3& first) {
  const Vec3 run = tree.end[i] - tree.start[i];
  const double t = std::clamp((first - tree.start[i]).dot(run) / run.squaredNorm(), 0.0, 1.0);
  const Vec3 axis = tree.start[i] + t * run;
  const Vec3 out = first - axis;
  const double distance = out.norm();
  return distance <= tree.radius[i] ? first : Vec3(axis + out * (tree.radius[i] / distance));
}

/// Where the stem stands whose lowest node this is.
Vec3 nearest_foot(const std::vector<Foot>& feet, const Vec3& node) {
  if (feet.empty()) return node;
  const auto away = [&](const Foot& f) { return (f.position - node).squaredNorm(); };
  return std::min_element(feet.begin(), feet.end(),
                          [&](const Foot& a, const Foot& b) { return away(a) < away(b); })
      ->position;
}

}  // namespace

Tree build_tree(const std::vector<Limb>& limbs, const std::vector<Foot>& feet, const Vec3& origin_shift) {
  Tree tree;
  tree.origin_shift = origin_shift;
  std::vector<std::vector<std::vector<std::int32_t>>> cylinder_at(limbs.size());  // by limb, by node
  std::vector<double> seen_radius;                                                // of every cylinder
  for (std::size_t l = 0; l < limbs.size(); ++l) {
    const Limb& limb = limbs[l];
    cylinder_at[l].assign(limb.nodes.size(), {});
    std::int32_t parent = -1;
    Vec3 from = limb.nodes.front().centre;
    std::size_t next = 1;
    if (limb.parent < 0) {
      from = nearest_foot(feet, from);
      next = 0;
    } else {
      const auto& bearer = cylinder_at[static_cast<std::size_t>(limb.parent)];
      // Cylinders about the bearing node.
      std::vector<std::int32_t> near;
      const auto at = static_cast<std::size_t>(limb.parent_node);
      for (std::size_t k = at > 0 ? at - 1 : 0; k < std::min(bearer.size(), at + 3); ++k)
        near.insert(near.end(), bearer[k].begin(), bearer[k].end());
      for (std::size_t k = at; near.empty() && k-- > 0;) near = bearer[k];
      for (std::size_t k = at; near.empty() && k < bearer.size(); ++k) near = bearer[k];
      if (near.empty()) continue;
      parent = nearest_cylinder(tree, near, from);
      from = leave_surface(tree, static_cast<std::size_t>(parent), limb.nodes.front().centre);
      next = 0;
    }
    // Walk the nodes, closing a cylinder when it is long enough or the line ends.
    std::size_t first_node = next;
    for (std::size_t i = next; i < limb.nodes.size(); ++i) {
      const double length = (limb.nodes[i].centre - from).norm();
      const bool last = i + 1 == limb.nodes.size();
      const bool gap_next = !last && limb.nodes[i + 1].after_gap;
      const bool long_enough = closes(limb, from, first_node, i) || (gap_next && length > kShortest) ||
                               (limb.nodes[i].after_gap && length > kShortest);
      if (!last && !long_enough) continue;
      if (length < kShortest) continue;
      TreeNode node;
      node.start = from;
      node.end = limb.nodes[i].centre;
      node.parent = parent;
      double square = 0, seen = 0, se = 0, count = 0;
      RadiusQuality quality = RadiusQuality::measured;
      for (std::size_t k = first_node; k <= i; ++k) {
        square += limb.nodes[k].radius_m * limb.nodes[k].radius_m;
        seen += limb.nodes[k].seen_radius_m;
        se += limb.nodes[k].radius_se_m;
        count += 1;
        quality = std::max(quality, limb.nodes[k].quality);
      }
      node.radius = std::sqrt(square / count);
      node.radius_se = se / count;
      node.quality = limb.nodes[i].after_gap && quality == RadiusQuality::measured
                         ? RadiusQuality::interpolated
                         : quality;
      parent = tree.add(node);
      seen_radius.push_back(seen / count);
      for (std::size_t k = first_node; k <= i; ++k) cylinder_at[l][k].push_back(parent);
      from = limb.nodes[i].centre;
      first_node = i + 1;
    }
  }
  name_axes(tree, seen_radius);
  return tree;
}

}  // namespace dendrofit
