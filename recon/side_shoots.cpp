// SPDX-License-Identifier: GPL-3.0-or-later
#include "recon/side_shoots.h"

#include <algorithm>
#include <cmath>

namespace dendrofit {
namespace {

constexpr std::int32_t kNobody = -1;

/// Which limb's node each point belongs to.
struct Owners {
  std::vector<std::int32_t> limb, node;

  Owners(std::size_t points, const std::vector<Limb>& limbs) : limb(points, kNobody), node(points, kNobody) {
    for (std::size_t l = 0; l < limbs.size(); ++l)
      for (std::size_t i = 0; i < limbs[l].nodes.size(); ++i)
        for (const std::uint32_t p : limbs[l].nodes[i].points) {
          limb[p] = static_cast<std::int32_t>(l);
          node[p] = static_cast<std::int32_t>(i);
        }
  }
};

/// The limb's line near one of its nodes.
LimbPlace place_near(const Limb& limb, const Vec3& point, std::int32_t node) {
  constexpr std::size_t kNodes = 2;  // to either side
  const auto at = static_cast<std::size_t>(node);
  const std::size_t first = at > kNodes ? at - kNodes : 0;
  const std::size_t last = std::min(at + kNodes, limb.nodes.size() - 1);
  return nearest_place(limb, point, first, last);
}

/// Calls visit(p, place) for every owned point with the place of its limb's line that it is nearest to: limb
/// by limb, so that a line's nodes are at hand for all its points.
template <class Visit>
void visit_places(const std::vector<Vec3>& points, const std::vector<Limb>& limbs, const Owners& owners,
                  const Visit& visit) {
  for (std::size_t l = 0; l < limbs.size(); ++l)
    for (std::size_t i = 0; i < limbs[l].nodes.size(); ++i)
      for (const std::uint32_t p : limbs[l].nodes[i].points)
        if (owners.limb[p] == static_cast<std::int32_t>(l) && owners.node[p] == static_cast<std::int32_t>(i))
          visit(p, place_near(limbs[l], points[p], owners.node[p]));
}

double off_surface(const LimbPlace& place) {
  return place.distance_m - place.radius_m;
}

/// How far points may lie off a surface by noise, bark and a shape that is not round.
double tolerance(double radius_m, double noise_m) {
  return std::max({3 * noise_m, 0.2 * radius_m, 0.004});
}

void take_away(std::vector<Limb>& limbs, const Owners& owners) {
  for (std::size_t l = 0; l < limbs.size(); ++l)
    for (std::size_t i = 0; i < limbs[l].nodes.size(); ++i)
      std::erase_if(limbs[l].nodes[i].points, [&](std::uint32_t p) {
        return owners.limb[p] != static_cast<std::int32_t>(l) ||
               owners.node[p] != static_cast<std::int32_t>(i);
      });
}

/// A limb from the first of `shoot` (in the order of their paths' lengths) through the middles of slices of
/// the others, a `step` of path each.
Limb lead_along_paths(const std::vector<Vec3>& points, const Paths& paths,
                      const std::vector<std::uint32_t>& shoot, double step) {
  Limb limb;
  limb.nodes.emplace_back();
  limb.nodes.front().centre = points[shoot.front()];
  const float begin = paths.length[shoot.front()], whole = paths.length[shoot.back()] - begin;
  const std::size_t slices =
      std::max<std::size_t>(1, static_cast<std::size_t>(whole / static_cast<float>(step) + 0.5F));
  const float slice = whole / static_cast<float>(slices);
  for (std::size_t k = 0, first = 0; k < slices && first < shoot.size(); ++k) {
    std::size_t last = first;
    const float end = begin + slice * static_cast<float>(k + 1);
    while (last < shoot.size() && (k + 1 == slices || paths.length[shoot[last]] < end)) ++last;
    if (last == first) continue;
    LimbNode node;
    node.points.assign(shoot.begin() + static_cast<std::ptrdiff_t>(first),
                       shoot.begin() + static_cast<std::ptrdiff_t>(last));
    for (const std::uint32_t p : node.points)
      node.centre += points[p] / static_cast<double>(node.points.size());
    first = last;
    limb.nodes.push_back(std::move(node));
  }
  // The tip reaches as far as its points do.
  LimbNode& tip = limb.nodes.back();
  const Vec3 run = tip.centre - limb.nodes[limb.nodes.size() - 2].centre;
  if (run.norm() > 0) {
    double far = 0;
    for (const std::uint32_t p : tip.points)
      far = std::max(far, (points[p] - tip.centre).dot(run.normalized()));
    tip.centre += 0.8 * far * run.normalized();
  }
  return limb;
}

/// Root mean square distance of a limb's points from its line.
double scatter_about(const Limb& limb, const std::vector<Vec3>& points) {
  double square = 0, count = 0;
  for (std::size_t k = 1; k < limb.nodes.size(); ++k)
    for (const std::uint32_t p : limb.nodes[k].points) {
      const LimbPlace place = nearest_place(limb, points[p], k - 1, std::min(k, limb.nodes.size() - 2));
      square += place.distance_m * place.distance_m;
      count += 1;
    }
  return std::sqrt(square / count);
}

}  // namespace

std::vector<char> hand_over_points(const std::vector<Vec3>& points, const PointGraph& graph,
                                   std::vector<Limb>& limbs, double noise_m) {
  constexpr int kPasses = 3;  // the way from a limb's edge to a point's own neighbours
  const Owners before(points.size(), limbs);
  Owners owners = before;
  std::vector<std::uint32_t> off;
  std::vector<double> least(points.size(), 0);
  visit_places(points, limbs, owners, [&](std::uint32_t p, const LimbPlace& place) {
    least[p] = std::abs(off_surface(place));
    if (least[p] > tolerance(place.radius_m, noise_m)) off.push_back(p);
  });
  std::sort(off.begin(), off.end());
  for (int pass = 0; pass < kPasses; ++pass) {
    const Owners last = owners;
    for (const std::uint32_t p : off)
      for (const std::uint32_t v : graph.of(p)) {
        if (last.limb[v] == kNobody || last.limb[v] == owners.limb[p]) continue;
        const Limb& other = limbs[static_cast<std::size_t>(last.limb[v])];
        const LimbPlace there = place_near(other, points[p], last.node[v]);
        const double distance = std::abs(off_surface(there));
        if (distance >= least[p] || distance > tolerance(there.radius_m, noise_m)) continue;
        least[p] = distance;
        owners.limb[p] = last.limb[v];
        owners.node[p] = static_cast<std::int32_t>(there.node);
      }
  }
  take_away(limbs, owners);
  std::vector<char> changed(limbs.size(), 0);
  for (const std::uint32_t p : off) {
    if (owners.limb[p] == before.limb[p] && owners.node[p] == before.node[p]) continue;
    const auto to = static_cast<std::size_t>(owners.limb[p]);
    limbs[to].nodes[static_cast<std::size_t>(owners.node[p])].points.push_back(p);
    changed[to] = changed[static_cast<std::size_t>(before.limb[p])] = 1;
  }
  return changed;
}

void grow_side_shoots(const std::vector<Vec3>& points, const PointGraph& graph, const Paths& paths,
                      std::vector<Limb>& limbs, double noise_m, const SkeletonOptions& options) {
  options.validate();
  constexpr std::size_t kFewest = 4;
  constexpr double kThick_m = 0.02, kSlim = 0.35;
  const double spacing = graph.typical_spacing_m;
  const double shortest = std::max({options.shortest_limb_m, 1.2 * spacing, 4 * noise_m});
  const double step = std::max(0.02, 2.5 * spacing);
  Owners owners(points.size(), limbs);
  std::vector<float> out(points.size(), 0);  // metres beyond the surface; 0: on it
  visit_places(points, limbs, owners, [&](std::uint32_t p, const LimbPlace& place) {
    if (off_surface(place) > tolerance(place.radius_m, noise_m))
      out[p] = static_cast<float>(off_surface(place));
  });
  std::vector<char> seen(points.size(), 0);
  std::vector<std::uint32_t> shoot;
  const std::size_t bearers = limbs.size();
  for (std::uint32_t seed = 0; seed < points.size(); ++seed) {
    if (seen[seed] || !(out[seed] > 0)) continue;
    shoot.assign(1, seed);
    seen[seed] = 1;
    for (std::size_t m = 0; m < shoot.size(); ++m)
      for (const std::uint32_t v : graph.of(shoot[m]))
        if (!seen[v] && out[v] > 0 && owners.limb[v] == owners.limb[seed]) {
          seen[v] = 1;
          shoot.push_back(v);
        }
    if (shoot.size() < kFewest) continue;
    std::sort(shoot.begin(), shoot.end(), [&](std::uint32_t a, std::uint32_t b) {
      return paths.length[a] != paths.length[b] ? paths.length[a] < paths.length[b] : a < b;
    });
    const auto bearer = static_cast<std::size_t>(owners.limb[seed]);
    double reach = 0;
    for (const std::uint32_t p : shoot) reach = std::max(reach, static_cast<double>(out[p]));
    const std::uint32_t base = shoot.front();
    const LimbPlace at = place_near(limbs[bearer], points[base], owners.node[base]);
    if (reach < shortest + 0.15 * at.radius_m) continue;

    Limb limb = lead_along_paths(points, paths, shoot, step);
    limb.parent = static_cast<std::int32_t>(bearer);
    limb.parent_node = static_cast<std::int32_t>(at.node);
    const double rough = scatter_about(limb, points);
    // What is wide beside thick wood is its own surface about a line that lies wrong.
    if (at.radius_m > std::max(kThick_m, 4 * noise_m) && rough > kSlim * at.radius_m) continue;
    for (LimbNode& node : limb.nodes) node.rough_radius_m = std::min(rough, at.radius_m);
    const auto id = static_cast<std::int32_t>(limbs.size());
    for (std::size_t k = 1; k < limb.nodes.size(); ++k)
      for (const std::uint32_t p : limb.nodes[k].points) {
        owners.limb[p] = id;
        owners.node[p] = static_cast<std::int32_t>(k);
      }
    limbs.push_back(std::move(limb));
  }
  if (limbs.size() == bearers) return;
  take_away(limbs, owners);
  measure_lengths(limbs);
}

}  // namespace dendrofit
