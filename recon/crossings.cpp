// SPDX-License-Identifier: GPL-3.0-or-later
#include "recon/crossings.h"

#include "core/neighbors.h"

#include <algorithm>
#include <cmath>

namespace dendrofit {
namespace {

constexpr double kStraight = 0.85;     // cosine of a turn that still goes on
constexpr double kBack = 0.7;          // cosine of what leads straight back to an end
constexpr double kZone = 0.3;          // metres of the outer part that belong to the place of contact
constexpr double kStraighter = 0.3;    // by so much in cosine it must take up the end better than its bearer
constexpr double kShortestRun = 0.06;  // that has a direction, metres
constexpr double kShortestOuter = 0.12;
constexpr double kThickest = 0.024;  // spread of sections: thicker ends are mended, see mend.h

class Crossings {
 public:
  Crossings(const std::vector<Section>& sections, double spacing_m)
      : sections_(sections),
        heir_(sections.size(), -1),
        reach_(sections.size(), 0),
        near_(std::max(0.06, 4 * spacing_m)),
        index_(centres_of(sections)) {
    for (std::size_t i = sections.size(); i-- > 0;) {
      const std::int32_t p = sections[i].parent;
      if (p < 0) continue;
      const auto up = static_cast<std::size_t>(p);
      const double way = reach_[i] + (sections[i].centre - sections[up].centre).norm();
      if (way <= reach_[up] && heir_[up] >= 0) continue;
      reach_[up] = way;
      heir_[up] = static_cast<std::int32_t>(i);
    }
  }

  std::vector<Gate> find() const {
    std::vector<Gate> gates;
    std::vector<char> used(sections_.size(), 0);
    for (std::size_t e = 0; e < sections_.size(); ++e) {
      const Section& end = sections_[e];
      if (end.parent < 0 || end.points.empty() || reach_[e] > 0.5 * near_ || end.extent_m > kThickest)
        continue;
      const auto [outer, inner] = continuation(static_cast<std::int32_t>(e));
      if (outer < 0 || used[static_cast<std::size_t>(outer)]) continue;
      used[static_cast<std::size_t>(outer)] = 1;
      Gate gate;
      add_run(outer, kZone, gate.inside);
      if (inner >= 0) add_run(inner, 2 * kZone, gate.inside);
      std::int32_t at = static_cast<std::int32_t>(e);
      for (int k = 0; k < 3 && at >= 0; ++k, at = sections_[static_cast<std::size_t>(at)].parent) {
        const auto& points = sections_[static_cast<std::size_t>(at)].points;
        gate.door.insert(gate.door.end(), points.begin(), points.end());
      }
      gates.push_back(std::move(gate));
    }
    return gates;
  }

 private:
  static std::vector<Vec3> centres_of(const std::vector<Section>& sections) {
    std::vector<Vec3> centres;
    centres.reserve(sections.size());
    for (const Section& s : sections) centres.push_back(s.centre);
    return centres;
  }

  const Section& at(std::int32_t i) const { return sections_[static_cast<std::size_t>(i)]; }

  double stretch(const Section& s) const { return std::max(6 * s.radius_m, 1.5 * kShortestRun); }

  /// Direction of the run that leads to a section, and of the one that leads on from it; zero where too
  /// short.
  Vec3 behind(std::int32_t i) const {
    std::int32_t k = i;
    while (at(k).parent >= 0 && (at(i).centre - at(k).centre).norm() < stretch(at(i))) k = at(k).parent;
    return unit(at(i).centre - at(k).centre);
  }
  Vec3 ahead(std::int32_t i) const {
    std::int32_t k = i;
    while (heir_[static_cast<std::size_t>(k)] >= 0 && (at(i).centre - at(k).centre).norm() < stretch(at(i)))
      k = heir_[static_cast<std::size_t>(k)];
    return unit(at(k).centre - at(i).centre);
  }
  static Vec3 unit(const Vec3& run) {
    const double length = run.norm();
    return length < kShortestRun ? Vec3::Zero() : Vec3(run / length);
  }

  /// Whether a section's run leaves its bearer sideways.
  bool leaves(std::int32_t s) const {
    return at(s).parent >= 0 && ahead(s).dot(behind(at(s).parent)) < kStraight;
  }

  /// First section of the run that a section is part of, at most `farthest` back; -1 where it is farther.
  std::int32_t run_start(std::int32_t j, double farthest) const {
    for (std::int32_t s = j; at(s).parent >= 0; s = at(s).parent) {
      if ((at(s).centre - at(j).centre).norm() > farthest) return -1;
      if (leaves(s)) return s;
    }
    return -1;
  }

  bool is_ancestor(std::int32_t a, std::int32_t of) const {
    for (std::int32_t k = of; k >= a; k = at(k).parent)
      if (k == a) return true;
    return false;
  }

  /// Whether a place lies on the line on from an end.
  bool in_line(const Section& end, const Vec3& direction, const Section& other) const {
    const Vec3 d = other.centre - end.centre;
    const double along = d.dot(direction);
    const double aside = (d - along * direction).norm();
    return along > -0.01 && aside < std::max({end.extent_m, other.extent_m, 0.006}) + 0.2 * along;
  }

  /// Whether the run that starts at `s` takes up the end `e` better than it takes up its own bearer.
  bool takes_up(std::int32_t e, const Vec3& direction, std::int32_t s) const {
    const Section& start = at(s);
    if (start.parent < 0 || start.extent_m > kThickest ||
        reach_[static_cast<std::size_t>(s)] < kShortestOuter || !in_line(at(e), direction, start))
      return false;
    const double straight = ahead(s).dot(direction);
    return straight > kStraight && straight > ahead(s).dot(behind(start.parent)) + kStraighter &&
           !is_ancestor(start.parent, e) && !is_ancestor(e, s);
  }

  /// Start of the run in which the end `e` goes on beyond a contact (-1: none), and of the run that leads
  /// from the contact back to the end (-1: none).
  std::pair<std::int32_t, std::int32_t> continuation(std::int32_t e) const {
    const Section& end = at(e);
    const Vec3 direction = behind(e);
    if (direction.isZero()) return {-1, -1};
    std::pair<std::int32_t, std::int32_t> best(-1, -1);
    double straightest = 0;
    const auto consider = [&](std::int32_t outer, std::int32_t inner) {
      const double straight = ahead(outer).dot(direction);
      if (straight <= straightest) return;
      straightest = straight;
      best = {outer, inner};
    };
    std::vector<Neighbor> found, about;
    index_.within(end.centre, near_ + end.radius_m, found);
    for (const Neighbor& f : found) {
      const auto j = static_cast<std::int32_t>(f.index);
      if (!in_line(end, direction, at(j)) || is_ancestor(j, e) || is_ancestor(e, j)) continue;
      if (takes_up(e, direction, j)) consider(j, -1);
      if (at(j).direction.dot(direction) > -kBack) continue;
      const std::int32_t back = run_start(j, 2 * kZone);
      if (back < 0) continue;
      const Section& bearer = at(at(back).parent);
      index_.within(bearer.centre, 2 * bearer.radius_m + near_, about);
      for (const Neighbor& a : about) {
        const auto s = static_cast<std::int32_t>(a.index);
        if (s != back && !is_ancestor(back, s) && leaves(s) && takes_up(e, direction, s)) consider(s, back);
      }
    }
    return best;
  }

  void add_run(std::int32_t start, double length, std::vector<std::uint32_t>& points) const {
    for (std::int32_t k = start; k >= 0; k = heir_[static_cast<std::size_t>(k)]) {
      if ((at(k).centre - at(start).centre).norm() > length) break;
      points.insert(points.end(), at(k).points.begin(), at(k).points.end());
    }
  }

  const std::vector<Section>& sections_;
  std::vector<std::int32_t> heir_;  // the child with the longest way beyond
  std::vector<double> reach_;       // longest way beyond a section's centre
  double near_;                     // within which wood touches
  Neighbors index_;
};

}  // namespace

std::vector<Gate> gates_at_crossings(const std::vector<Section>& sections, double spacing_m) {
  if (sections.empty()) return {};
  return Crossings(sections, spacing_m).find();
}

}  // namespace dendrofit
