// SPDX-License-Identifier: GPL-3.0-or-later
#include "recon/mend.h"

#include "core/neighbors.h"

#include <algorithm>
#include <cmath>

namespace dendrofit {
namespace {

/// Mean direction of the run that ends in a section, over a few radii.
Vec3 run_direction(const std::vector<Section>& sections, std::size_t end) {
  const double stretch = std::max(6 * sections[end].radius_m, 0.06);
  std::size_t at = end;
  while (sections[at].parent >= 0 && (sections[end].centre - sections[at].centre).norm() < stretch)
    at = static_cast<std::size_t>(sections[at].parent);
  const Vec3 run = sections[end].centre - sections[at].centre;
  const double length = run.norm();
  return length > 0 ? Vec3(run / length) : sections[end].direction;
}

/// Direction of the run on from every section, over a few radii: of wood that was entered from the side its
/// own direction is the way in.
std::vector<Vec3> directions_on(const std::vector<Section>& sections) {
  std::vector<std::int32_t> heir(sections.size(), -1);
  std::vector<double> reach(sections.size(), 0);  // longest way beyond
  for (std::size_t i = sections.size(); i-- > 0;) {
    if (sections[i].parent < 0) continue;
    const auto p = static_cast<std::size_t>(sections[i].parent);
    const double way = reach[i] + (sections[i].centre - sections[p].centre).norm();
    if (heir[p] >= 0 && way <= reach[p]) continue;
    reach[p] = way;
    heir[p] = static_cast<std::int32_t>(i);
  }
  std::vector<Vec3> direction(sections.size());
  for (std::size_t i = 0; i < sections.size(); ++i) {
    const double stretch = std::max(6 * sections[i].extent_m, 0.06);
    std::size_t at = i;
    while (heir[at] >= 0 && (sections[at].centre - sections[i].centre).norm() < stretch)
      at = static_cast<std::size_t>(heir[at]);
    const Vec3 run = sections[at].centre - sections[i].centre;
    direction[i] = run.norm() > 0 ? Vec3(run.normalized()) : sections[i].direction;
  }
  return direction;
}

/// The point of `members` farthest along `direction`.
std::uint32_t foremost(const std::vector<Vec3>& points, const std::vector<std::uint32_t>& members,
                       const Vec3& direction) {
  return *std::max_element(members.begin(), members.end(), [&](std::uint32_t a, std::uint32_t b) {
    return points[a].dot(direction) < points[b].dot(direction);
  });
}

}  // namespace

std::vector<Bridge> mend_cut_branches(const std::vector<Vec3>& points, const std::vector<Section>& sections,
                                      double spacing_m, double max_gap_m) {
  constexpr double kThick = 0.012;   // thinner ends may be real ones
  constexpr double kStraight = 0.8;  // cosine of a turn that still goes on
  constexpr double kStem = 0.4;      // of the thickest section's radius: a stem's end
  constexpr double kAhead = 0.9;     // cosine of a turn that is none
  constexpr int kBridgesPerEnd = 3;
  constexpr double kFarthestRadii = 12;  // ahead of the end
  constexpr std::size_t kFewestPoints = 8;
  std::vector<Bridge> bridges;
  const double thick = std::max(kThick, 0.5 * spacing_m);
  std::vector<char> goes_on(sections.size(), 0);
  for (const Section& s : sections) {
    if (s.parent < 0) continue;
    const auto p = static_cast<std::size_t>(s.parent);
    if (s.radius_m > 0.6 * sections[p].radius_m && s.direction.dot(sections[p].direction) > kStraight)
      goes_on[p] = 1;
  }
  std::vector<Vec3> centres;
  std::vector<std::size_t> which;
  for (std::size_t i = 0; i < sections.size(); ++i) {
    if (sections[i].extent_m < 0.4 * thick || sections[i].points.size() < kFewestPoints) continue;
    centres.push_back(sections[i].centre);
    which.push_back(i);
  }
  const std::vector<Vec3> on = directions_on(sections);
  double thickest = 0;
  for (const Section& s : sections) thickest = std::max(thickest, s.radius_m);
  const Neighbors index(centres);
  std::vector<Neighbor> found;
  for (std::size_t i = 0; i < sections.size(); ++i) {
    const Section& end = sections[i];
    if (goes_on[i] || end.parent < 0 || end.radius_m < thick) continue;
    const Vec3 direction = run_direction(sections, i);
    const double farthest = std::min(max_gap_m, kFarthestRadii * end.radius_m + 4 * spacing_m);
    index.within(end.centre, farthest, found);
    int made = 0;
    for (const Neighbor& f : found) {
      const std::size_t j = which[f.index];
      const Section& other = sections[j];
      if (j == i || other.parent == static_cast<std::int32_t>(i) ||
          static_cast<std::int32_t>(j) == end.parent)
        continue;
      const Vec3 ahead = other.centre - end.centre;
      const double along = ahead.dot(direction);
      const double aside = (ahead - along * direction).norm();
      // The same branch again beyond a gap (or beside its end, which may have coasted past the place), ...
      const bool goes_on_there = along > -end.radius_m &&
                                 aside < 0.7 * end.radius_m + 0.12 * std::abs(along) &&
                                 std::abs(other.direction.dot(direction)) > 0.75 &&
                                 other.extent_m > 0.35 * end.radius_m && other.extent_m < 1.4 * end.radius_m;
      // ... or what a cut stem leads to, though the way in came from the side; its course is as sure as
      // points lie close, ...
      const bool stem_goes_on_there =
          end.radius_m > kStem * thickest && along > 2 * end.radius_m &&
          aside < 0.7 * end.radius_m + 0.12 * along + 0.5 * spacing_m && on[j].dot(direction) > kAhead &&
          std::abs(other.direction.dot(direction)) < kAhead && other.extent_m > 0.35 * end.radius_m &&
          other.extent_m < 1.4 * end.radius_m;
      // ... or thicker wood, of which this end is then the base: branches end thin in the open, not thick
      // before a stem.
      const bool bears_it = along > 0 && other.radius_m > end.radius_m &&
                            aside < other.radius_m + 0.5 * end.radius_m &&
                            along - other.radius_m < 8 * end.radius_m;
      if (!goes_on_there && !stem_goes_on_there && !bears_it) continue;
      const std::uint32_t a = foremost(points, end.points, direction);
      const std::uint32_t b = foremost(points, other.points, -direction);
      const double gap = (points[a] - points[b]).norm();
      bridges.push_back({a, b, gap, gap});
      if (++made == kBridgesPerEnd) break;
    }
  }
  return bridges;
}

}  // namespace dendrofit
