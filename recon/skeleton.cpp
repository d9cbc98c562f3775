// SPDX-License-Identifier: GPL-3.0-or-later
#include "recon/skeleton.h"

#include "core/errors.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace dendrofit {
namespace {

struct SectionTree {
  std::vector<std::vector<std::int32_t>> children;
  std::vector<double> reach;   // longest way beyond a section's centre
  std::vector<double> beyond;  // all wood beyond it
  std::vector<std::int32_t> merged_into;
};

double gap_between(const std::vector<Section>& sections, std::int32_t child) {
  const Section& s = sections[static_cast<std::size_t>(child)];
  return s.parent < 0 ? 0 : (s.centre - sections[static_cast<std::size_t>(s.parent)].centre).norm();
}

/// How far a group of points reaches beyond its centre.
double half_length(const std::vector<Vec3>& points, const Section& s) {
  double far = 0;
  for (const std::uint32_t p : s.points) far = std::max(far, (points[p] - s.centre).dot(s.direction));
  return far;
}

SectionTree prune(const std::vector<Vec3>& points, const std::vector<Section>& sections, double shortest) {
  const std::size_t n = sections.size();
  SectionTree tree{std::vector<std::vector<std::int32_t>>(n), std::vector<double>(n, 0),
                   std::vector<double>(n, 0), std::vector<std::int32_t>(n, -1)};
  for (std::size_t i = n; i-- > 0;) {
    auto& children = tree.children[i];
    std::reverse(children.begin(), children.end());  // were added last first
    if (children.empty()) {
      tree.reach[i] = half_length(points, sections[i]);
    } else {
      const auto way = [&](std::int32_t c) {
        return gap_between(sections, c) + tree.reach[static_cast<std::size_t>(c)];
      };
      const std::int32_t longest = *std::max_element(children.begin(), children.end(),
                                                     [&](auto a, auto b) { return way(a) < way(b); });
      std::vector<std::int32_t> kept;
      for (const std::int32_t c : children) {
        // What a side shoot reaches beyond its bearer's surface must exceed noise and the bearer's own
        // roughness.
        const double out = way(c) - sections[i].radius_m;
        if (c == longest || out >= shortest + 0.15 * sections[i].radius_m)
          kept.push_back(c);
        else
          tree.merged_into[static_cast<std::size_t>(c)] = static_cast<std::int32_t>(i);
      }
      children = kept;
      for (const std::int32_t c : children) {
        tree.reach[i] = std::max(tree.reach[i], way(c));
        tree.beyond[i] += gap_between(sections, c) + tree.beyond[static_cast<std::size_t>(c)];
      }
    }
    if (sections[i].parent >= 0)
      tree.children[static_cast<std::size_t>(sections[i].parent)].push_back(static_cast<std::int32_t>(i));
  }
  return tree;
}

/// Mean extent of the next few sections on the longest way from a section.
double thickness_ahead(const std::vector<Section>& sections, const SectionTree& tree, std::int32_t from) {
  constexpr int kSections = 4;
  double sum = 0;
  int count = 0;
  for (std::int32_t at = from; at >= 0 && count < kSections; ++count) {
    const auto i = static_cast<std::size_t>(at);
    sum += std::max(sections[i].extent_m, sections[i].radius_m);
    at = -1;
    double longest = -1;
    for (const std::int32_t c : tree.children[i])
      if (tree.reach[static_cast<std::size_t>(c)] > longest) {
        longest = tree.reach[static_cast<std::size_t>(c)];
        at = c;
      }
  }
  return sum / count;
}

/// Weighted running mean over the neighbours within `reach` along the line; the ends stay where they are.
void smooth(Limb& limb) {
  const std::size_t n = limb.nodes.size();
  if (n < 3) return;
  std::vector<Vec3> next(n);
  for (int pass = 0; pass < 2; ++pass) {
    for (std::size_t i = 0; i < n; ++i) next[i] = limb.nodes[i].centre;
    for (std::size_t i = 1; i + 1 < n; ++i) {
      const Vec3 &a = limb.nodes[i - 1].centre, &b = limb.nodes[i].centre, &c = limb.nodes[i + 1].centre;
      const double before = (b - a).norm(), after = (c - b).norm();
      if (before + after <= 0) continue;
      const Vec3 chord = a + (c - a) * (before / (before + after));
      next[i] = 0.5 * b + 0.5 * chord;
    }
    for (std::size_t i = 0; i < n; ++i) limb.nodes[i].centre = next[i];
  }
}

}  // namespace

void SkeletonOptions::validate() const {
  require(std::isfinite(shortest_limb_m) && shortest_limb_m >= 0 && shortest_limb_m < 5, "shortest_limb_m",
          shortest_limb_m, "must lie between 0 and 5 m");
}

LimbPlace nearest_place(const Limb& limb, const Vec3& point, std::size_t first, std::size_t last) {
  LimbPlace best;
  double least = std::numeric_limits<double>::infinity();  // squared distance
  for (std::size_t i = first; i <= last; ++i) {
    const LimbNode& a = limb.nodes[i];
    const LimbNode& b = limb.nodes[std::min(i + 1, limb.nodes.size() - 1)];
    const Vec3 run = b.centre - a.centre;
    const double square = run.squaredNorm();
    const double t = square > 0 ? std::clamp((point - a.centre).dot(run) / square, 0.0, 1.0) : 0;
    const double squared = (a.centre + t * run - point).squaredNorm();
    if (!(squared < least)) continue;
    least = squared;
    if (const double distance = std::sqrt(squared); distance < best.distance_m)
      best = {i, (1 - t) * a.along_m + t * b.along_m, distance,
              (1 - t) * a.rough_radius_m + t * b.rough_radius_m};
  }
  return best;
}

Vec3 direction_at(const Limb& limb, std::size_t node) {
  const std::size_t n = limb.nodes.size();
  const std::size_t a = node > 0 ? node - 1 : 0, b = node + 1 < n ? node + 1 : n - 1;
  const Vec3 run = limb.nodes[b].centre - limb.nodes[a].centre;
  const double length = run.norm();
  return length > 0 ? Vec3(run / length) : Vec3::UnitZ();
}

void smooth_limbs(std::vector<Limb>& limbs) {
  for (Limb& limb : limbs) smooth(limb);
}

void measure_lengths(std::vector<Limb>& limbs) {
  for (Limb& limb : limbs) {
    double along = 0;
    for (std::size_t i = 0; i < limb.nodes.size(); ++i) {
      if (i > 0) along += (limb.nodes[i].centre - limb.nodes[i - 1].centre).norm();
      limb.nodes[i].along_m = along;
    }
    limb.beyond_m = along;
  }
  for (std::size_t l = limbs.size(); l-- > 0;)
    if (limbs[l].parent >= 0) limbs[static_cast<std::size_t>(limbs[l].parent)].beyond_m += limbs[l].beyond_m;
}

void divide_long_stretches(const std::vector<Vec3>& points, std::vector<Limb>& limbs, double spacing_m) {
  const double step = std::max(0.02, 1.3 * spacing_m);
  constexpr double kRadii = 1.5;  // thick wood needs no shorter ones
  std::vector<std::vector<std::int32_t>> moved(limbs.size());
  for (std::size_t l = 0; l < limbs.size(); ++l) {
    Limb& limb = limbs[l];
    if (limb.parent >= 0)
      limb.parent_node =
          moved[static_cast<std::size_t>(limb.parent)][static_cast<std::size_t>(limb.parent_node)];
    std::vector<LimbNode> nodes;
    for (std::size_t i = 0; i < limb.nodes.size(); ++i) {
      if (i > 0 && !limb.nodes[i].after_gap) {
        const LimbNode &a = limb.nodes[i - 1], &b = limb.nodes[i];
        const double length = (b.centre - a.centre).norm();
        const auto pieces = std::llround(length / std::max(step, kRadii * b.rough_radius_m));
        for (long long k = 1; k < pieces; ++k) {
          const double t = static_cast<double>(k) / static_cast<double>(pieces);
          LimbNode between;
          between.centre = (1 - t) * a.centre + t * b.centre;
          between.rough_radius_m = (1 - t) * a.rough_radius_m + t * b.rough_radius_m;
          nodes.push_back(std::move(between));
        }
      }
      moved[l].push_back(static_cast<std::int32_t>(nodes.size()));
      nodes.push_back(limb.nodes[i]);
    }
    if (nodes.size() == limb.nodes.size()) continue;
    for (LimbNode& node : nodes) node.points.clear();
    for (std::size_t i = 0; i < limb.nodes.size(); ++i) {
      const auto at = static_cast<std::size_t>(moved[l][i]);
      const std::size_t first = i > 0 ? static_cast<std::size_t>(moved[l][i - 1]) : at;
      const std::size_t last = i + 1 < limb.nodes.size() ? static_cast<std::size_t>(moved[l][i + 1]) : at;
      for (const std::uint32_t p : limb.nodes[i].points) {
        std::size_t nearest = at;
        for (std::size_t k = first; k <= last; ++k)
          if ((nodes[k].centre - points[p]).squaredNorm() < (nodes[nearest].centre - points[p]).squaredNorm())
            nearest = k;
        nodes[nearest].points.push_back(p);
      }
    }
    limb.nodes = std::move(nodes);
  }
  measure_lengths(limbs);
}

std::vector<Limb> make_limbs(const std::vector<Vec3>& points, const std::vector<Section>& sections,
                             double spacing_m, const SkeletonOptions& options) {
  options.validate();
  const double shortest = std::max(options.shortest_limb_m, 1.5 * spacing_m);
  SectionTree tree = prune(points, sections, shortest);
  std::vector<Limb> limbs;
  struct Start {
    std::int32_t section, parent, parent_node;
  };
  std::vector<Start> starts;
  for (std::size_t i = 0; i < sections.size(); ++i)
    if (sections[i].parent < 0) starts.push_back({static_cast<std::int32_t>(i), -1, -1});
  std::vector<std::int32_t> limb_of(sections.size(), -1), node_of(sections.size(), -1);
  for (std::size_t s = 0; s < starts.size(); ++s) {
    Limb limb;
    limb.parent = starts[s].parent;
    limb.parent_node = starts[s].parent_node;
    const auto id = static_cast<std::int32_t>(limbs.size());
    for (std::int32_t at = starts[s].section; at >= 0;) {
      const auto i = static_cast<std::size_t>(at);
      LimbNode node;
      node.centre = sections[i].centre;
      node.rough_radius_m = sections[i].radius_m;
      node.after_gap = sections[i].after_gap;
      node.points = sections[i].points;
      limb_of[i] = id;
      node_of[i] = static_cast<std::int32_t>(limb.nodes.size());
      limb.nodes.push_back(std::move(node));
      const auto& children = tree.children[i];
      std::int32_t heir = -1;
      for (const std::int32_t c : children) {
        const auto weight = [&](std::int32_t k) {
          const auto j = static_cast<std::size_t>(k);
          return (tree.beyond[j] + tree.reach[j]) * std::pow(thickness_ahead(sections, tree, k), 2) *
                 (0.5 + std::max(0.0, sections[j].direction.dot(sections[i].direction)));
        };
        if (heir < 0 || weight(c) > weight(heir)) heir = c;
      }
      for (const std::int32_t c : children)
        if (c != heir) starts.push_back({c, id, node_of[i]});
      at = heir;
    }
    // Thickness grows nowhere along a limb but by error.
    for (std::size_t k = 1; k < limb.nodes.size(); ++k)
      limb.nodes[k].rough_radius_m =
          std::min(limb.nodes[k].rough_radius_m, 1.1 * limb.nodes[k - 1].rough_radius_m);
    // The tip reaches as far as its points do.
    LimbNode& tip = limb.nodes.back();
    const std::size_t k = limb.nodes.size() - 1;
    if (k > 0) {
      const Vec3 run = (tip.centre - limb.nodes[k - 1].centre).normalized();
      double far = 0;
      for (const std::uint32_t p : tip.points) far = std::max(far, (points[p] - tip.centre).dot(run));
      tip.centre += 0.8 * far * run;
    }
    limbs.push_back(std::move(limb));
  }
  // Points of pruned spurs belong to their bearer.
  for (std::size_t i = 0; i < sections.size(); ++i) {
    if (limb_of[i] >= 0) continue;
    const auto p = static_cast<std::size_t>(sections[i].parent);
    limb_of[i] = limb_of[p];
    node_of[i] = node_of[p];
  }
  smooth_limbs(limbs);
  measure_lengths(limbs);
  return limbs;
}

}  // namespace dendrofit
