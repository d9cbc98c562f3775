// SPDX-License-Identifier: GPL-3.0-or-later
#include "recon/sections.h"

#include "recon/cylinder_fit.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <numbers>
#include <queue>
#include <span>

#include <Eigen/Dense>

namespace dendrofit {
namespace {

constexpr double kSurface = 3;  // radii in noises: thinner wood shows no surface

struct Settings {
  double shortest_m;  // of a section: a few point spacings
  double noise_m;     // half the width within which a cluster of points is as good as a line
};

/// Children of each point along the paths, in compressed rows.
struct PathChildren {
  std::vector<std::uint32_t> first, child;
  explicit PathChildren(const Paths& paths) : first(paths.parent.size() + 1, 0) {
    for (const std::uint32_t p : paths.parent)
      if (p != Paths::kNone) ++first[p + 1];
    for (std::size_t i = 1; i < first.size(); ++i) first[i] += first[i - 1];
    child.resize(first.back());
    std::vector<std::uint32_t> fill(first.begin(), first.end() - 1);
    for (const std::uint32_t i : paths.order)
      if (paths.parent[i] != Paths::kNone) child[fill[paths.parent[i]]++] = i;
  }
  std::span<const std::uint32_t> of(std::uint32_t i) const {
    return {child.data() + first[i], first[i + 1] - first[i]};
  }
};

class Cutter {
 public:
  Cutter(const std::vector<Vec3>& points, const PointGraph& graph, const Paths& paths)
      : points_(points), graph_(graph), paths_(paths), children_(paths), group_(points.size(), Paths::kNone) {
    settings_.shortest_m = std::max(0.02, 2.5 * graph.typical_spacing_m);
    settings_.noise_m = std::max(0.004, 0.5 * graph.typical_spacing_m);
  }

  std::vector<Section> cut(const std::vector<Foot>& feet, Progress& progress) {
    for (const Foot& foot : feet) plant(foot);
    // Thick wood first: it takes what lies on its surface before a branch that borders on it can.
    for (std::size_t done = 0; !next_.empty(); ++done) {
      if (done % 1024 == 0) progress.check();
      const std::size_t s = next_.top().index;
      next_.pop();
      grow(s);
    }
    return std::move(sections_);
  }

 private:
  struct Group {
    std::vector<std::uint32_t> points;
    Vec3 mean = Vec3::Zero();
    bool main = false;  // goes on where the parent's cylinder would
  };

  struct Next {
    double radius_m;
    std::size_t index;
    bool operator<(const Next& other) const {
      return radius_m != other.radius_m ? radius_m < other.radius_m : index > other.index;
    }
  };

  void plant(const Foot& foot) {
    Section root;
    for (const std::uint32_t p : foot.points)
      if (paths_.parent[p] == Paths::kNone && std::isfinite(paths_.length[p])) root.points.push_back(p);
    root.direction = Vec3(foot.slope.x(), foot.slope.y(), 1).normalized();
    root.radius_m = 0.5 * foot.diameter_m;
    root.centre = foot.position;
    for (const std::uint32_t p : root.points)
      root.centre.z() += (points_[p].z() - foot.position.z()) / static_cast<double>(root.points.size());
    root.centre.head<2>() += foot.slope * (root.centre.z() - foot.position.z());
    if (root.points.empty()) return;
    for (const std::uint32_t p : root.points) group_[p] = next_group_;
    ++next_group_;
    next_.push({root.radius_m, sections_.size()});
    sections_.push_back(std::move(root));
    end_.push_back(0);
  }

  double step(const Section& s) const {
    return std::clamp(0.7 * s.radius_m, settings_.shortest_m, std::max(0.08, settings_.shortest_m));
  }

  /// The points next on the paths that no section has yet, up to one step beyond the section's end (or beyond
  /// the nearest of them, across a gap).
  std::vector<std::uint32_t> next_points(std::size_t index, float& end) const {
    std::vector<std::uint32_t> front, reached;
    float begin = std::numeric_limits<float>::infinity();
    for (const std::uint32_t p : sections_[index].points)
      for (const std::uint32_t c : children_.of(p))
        if (group_[c] == Paths::kNone) {
          front.push_back(c);
          begin = std::min(begin, paths_.length[c]);
        }
    end = std::max(begin, end_[index]) + static_cast<float>(step(sections_[index]));
    for (const std::uint32_t c : front)
      if (paths_.length[c] < end) reached.push_back(c);
    for (std::size_t i = 0; i < reached.size(); ++i)
      for (const std::uint32_t c : children_.of(reached[i]))
        if (paths_.length[c] < end) reached.push_back(c);
    return reached;
  }

  std::vector<Group> groups_of(const std::vector<std::uint32_t>& reached, const Section& s) {
    std::vector<Group> groups;
    const std::uint32_t open = next_group_++;
    for (const std::uint32_t p : reached) group_[p] = open;
    const double reach = std::max(2.5 * graph_.typical_spacing_m, 0.5 * s.radius_m);
    for (const std::uint32_t seed : reached) {
      if (group_[seed] != open) continue;
      const std::uint32_t id = next_group_++;
      Group group;
      group.points.push_back(seed);
      group_[seed] = id;
      for (std::size_t m = 0; m < group.points.size(); ++m)
        for (const std::uint32_t v : graph_.of(group.points[m]))
          if (group_[v] == open && (points_[v] - points_[group.points[m]]).norm() <= reach) {
            group_[v] = id;
            group.points.push_back(v);
          }
      set_mean(group);
      groups.push_back(std::move(group));
    }
    return groups;
  }

  /// Share of a group's points that lie within the section's cylinder, prolonged.
  double share_within(const Group& group, const Section& s) const {
    const double reach = 1.15 * s.radius_m + settings_.noise_m;
    std::size_t inside = 0;
    for (const std::uint32_t p : group.points) {
      const Vec3 d = points_[p] - s.centre;
      inside += (d - s.direction * d.dot(s.direction)).norm() <= reach;
    }
    return static_cast<double>(inside) / static_cast<double>(group.points.size());
  }

  void grow(std::size_t index) {
    float end = 0;
    std::size_t heir = 0;  // the section in which thick wood goes on from here, once it has one
    for (std::vector<std::uint32_t> reached = next_points(index, end); !reached.empty();
         reached = next_points(index, end)) {
      Section parent;  // without its points: sections_ grows below
      parent.centre = sections_[index].centre;
      parent.direction = sections_[index].direction;
      parent.radius_m = sections_[index].radius_m;
      parent.coasted_m = sections_[index].coasted_m;
      std::vector<Group> groups = groups_of(reached, parent);
      merge_within(groups, parent);
      gather_course(groups, parent);
      for (Group& group : groups) {
        const bool round = group.main && parent.radius_m > kSurface * settings_.noise_m;
        if (round && heir != 0 && joins(group, parent, sections_[heir])) continue;
        if (round && heir == 0) heir = sections_.size();
        add(static_cast<std::int32_t>(index), parent, group);
        end_.push_back(end);
      }
    }
  }

  /// Paths up one side of thick wood may be longer than those up the other: what lies beside the heir is the
  /// rest of its surface, not a second piece of wood in the same place.
  bool joins(const Group& group, const Section& parent, Section& heir) {
    const double ahead = (group.mean - parent.centre).dot(parent.direction);
    if (ahead > 2 * step(parent)) return false;
    Group both;
    both.points = heir.points;
    both.points.insert(both.points.end(), group.points.begin(), group.points.end());
    set_mean(both);
    const std::uint32_t id = group_[heir.points.front()];
    for (const std::uint32_t p : group.points) group_[p] = id;
    continue_cylinder(parent, both, heir);
    heir.extent_m = extent(both, heir.direction);
    heir.points = std::move(both.points);
    return true;
  }

  /// Number of 24 sectors of the section's prolonged surface in which a group has points.
  int sectors_of(const Group& group, const Section& s) const {
    Vec3 u, v;
    plane_frame(s.direction, u, v);
    const double reach = std::max(2 * settings_.noise_m, 0.2 * s.radius_m);
    std::uint32_t seen = 0;
    for (const std::uint32_t p : group.points) {
      const Vec3 d = points_[p] - s.centre;
      const double x = d.dot(u), y = d.dot(v);
      if (std::abs(std::hypot(x, y) - s.radius_m) > reach) continue;
      seen |= 1U << static_cast<int>(std::min(23.0, 12 * (std::atan2(y, x) / std::numbers::pi + 1)));
    }
    return std::popcount(seen);
  }

  /// Thick wood has one successor: all groups within its prolonged cylinder are one, and a group that a
  /// crotch joins to the wood is part of it where it holds most of the surface.
  void merge_within(std::vector<Group>& groups, const Section& parent) const {
    if (parent.radius_m < 2 * settings_.noise_m) return;
    std::vector<Group*> within, joined;
    int sectors = 0;
    for (Group& g : groups) {
      const double share = share_within(g, parent);
      if (share >= 0.5) {
        within.push_back(&g);
        sectors += sectors_of(g, parent);
      } else if (share >= 0.2) {
        joined.push_back(&g);
      }
    }
    for (Group* g : joined) {
      const int theirs = sectors_of(*g, parent);
      const bool holds_surface = theirs >= 8 && theirs >= 2 * sectors;
      if (groups.size() == 1 || (!within.empty() && holds_surface)) within.push_back(g);
    }
    if (within.empty()) return;
    Group& main = *within.front();
    main.main = true;
    for (std::size_t k = 1; k < within.size(); ++k) {
      Group& g = *within[k];
      const auto a = static_cast<double>(main.points.size()), b = static_cast<double>(g.points.size());
      main.mean = (a * main.mean + b * g.mean) / (a + b);
      main.points.insert(main.points.end(), g.points.begin(), g.points.end());
      g.points.clear();
    }
    std::erase_if(groups, [](const Group& g) { return g.points.empty(); });
  }

  /// In a crotch the wood's surface and the branch that leaves are one connected group: thick wood takes what
  /// lies on its course from all groups, where that shows twice as much of its surface as its own group does.
  void gather_course(std::vector<Group>& groups, const Section& parent) {
    constexpr int kFewestSectors = 10;
    const auto main = std::find_if(groups.begin(), groups.end(), [](const Group& g) { return g.main; });
    if (groups.size() < 2 || main == groups.end() || parent.radius_m < kSurface * settings_.noise_m) return;
    Group all;
    for (const Group& g : groups) all.points.insert(all.points.end(), g.points.begin(), g.points.end());
    Section course;
    if (!continue_cylinder(parent, all, course)) return;
    const int sectors = sectors_of(all, course);
    if (sectors < kFewestSectors || sectors < 2 * sectors_of(*main, course)) return;
    const double reach = course.radius_m + std::max(settings_.noise_m, 0.1 * course.radius_m);
    Group taken;
    taken.main = true;
    const std::uint32_t id = next_group_++;
    for (Group& g : groups) {
      std::vector<std::uint32_t> left;
      for (const std::uint32_t p : g.points) {
        const Vec3 d = points_[p] - course.centre;
        const bool on = g.main || (d - course.direction * d.dot(course.direction)).norm() <= reach;
        (on ? taken.points : left).push_back(p);
      }
      g.points = std::move(left);
      set_mean(g);
    }
    std::erase_if(groups, [](const Group& g) { return g.points.empty(); });
    for (const std::uint32_t p : taken.points) group_[p] = id;
    set_mean(taken);
    groups.insert(groups.begin(), std::move(taken));
  }

  void set_mean(Group& group) const {
    group.mean.setZero();
    for (const std::uint32_t p : group.points)
      group.mean += points_[p] / static_cast<double>(group.points.size());
  }

  /// Thick wood goes on as the parent's cylinder foretells: the circle that its points and that forecast make
  /// most likely. A strip of the surface is enough to keep the course, since the radius hardly changes from
  /// one section to the next; branches that leave within the group get no weight (Tukey).
  bool continue_cylinder(const Section& parent, const Group& group, Section& s) const {
    constexpr double kShift = 0.06, kChange = 0.06;  // standard deviations a section, in radii
    constexpr std::size_t kFewest = 5;
    constexpr double kTukey = 4.685;
    // What points scatter about the surface: bark and noise, never as much as the radius itself.
    const double noise =
        std::min(std::max(0.25 * graph_.typical_spacing_m, 0.05 * parent.radius_m), 0.12 * parent.radius_m);
    if (parent.radius_m < 2.5 * settings_.noise_m) return false;
    Vec3 u, v;
    plane_frame(parent.direction, u, v);
    std::vector<Eigen::Vector2d> flat;
    double along = 0, near = 0;
    for (const std::uint32_t p : group.points) {
      const Vec3 d = points_[p] - parent.centre;
      flat.emplace_back(d.dot(u), d.dot(v));
      if (std::abs(flat.back().norm() - parent.radius_m) > 3 * noise) continue;
      along += d.dot(parent.direction);
      near += 1;
    }
    if (near < static_cast<double>(kFewest) || along <= 0) return false;
    along /= near;
    const double shift_weight = std::pow(noise / (kShift * parent.radius_m), 2);
    const double change_weight = std::pow(noise / (kChange * parent.radius_m), 2);
    Eigen::Vector3d circle(0, 0, parent.radius_m);  // centre and radius
    std::size_t inliers = 0;
    for (int iteration = 0; iteration < 8; ++iteration) {
      Eigen::Matrix3d normal = Eigen::Vector3d(shift_weight, shift_weight, change_weight).asDiagonal();
      Eigen::Vector3d gradient(shift_weight * circle.x(), shift_weight * circle.y(),
                               change_weight * (circle.z() - parent.radius_m));
      inliers = 0;
      for (const Eigen::Vector2d& p : flat) {
        const Eigen::Vector2d d = p - circle.head<2>();
        const double distance = d.norm();
        const double residual = distance - circle.z();
        const double off = residual / (kTukey * noise);
        if (std::abs(off) >= 1 || distance <= 0) continue;
        const double w = (1 - off * off) * (1 - off * off);
        const Eigen::Vector3d row(-d.x() / distance, -d.y() / distance, -1);
        normal += w * row * row.transpose();
        gradient += w * residual * row;
        inliers += std::abs(residual) < 2 * noise;
      }
      const Eigen::Vector3d change = normal.ldlt().solve(gradient);
      circle -= change;
      if (change.norm() < 1e-6) break;
    }
    if (inliers < kFewest || circle.z() < 0.65 * parent.radius_m || circle.z() > 1.12 * parent.radius_m ||
        circle.head<2>().norm() > 0.4 * parent.radius_m)
      return false;
    s.centre = parent.centre + along * parent.direction + circle.x() * u + circle.y() * v;
    s.radius_m = circle.z();
    const Vec3 ahead = s.centre - parent.centre;
    const double share = ahead.norm() / (ahead.norm() + 2 * parent.radius_m);
    s.direction = ((1 - share) * parent.direction + share * ahead.normalized()).normalized();
    return true;
  }

  double extent(const Group& group, const Vec3& direction) const {
    double square = 0;
    for (const std::uint32_t p : group.points) {
      const Vec3 d = points_[p] - group.mean;
      square += (d - direction * d.dot(direction)).squaredNorm();
    }
    return std::sqrt(square / static_cast<double>(group.points.size()));
  }

  void add(std::int32_t index, const Section& parent, Group& group) {
    Section s = successor(index, parent, group);
    s.extent_m = extent(group, s.direction);
    s.points = std::move(group.points);
    if (group.main && s.radius_m > kSurface * settings_.noise_m) gather_surface(s);
    next_.push({s.radius_m, sections_.size()});
    sections_.push_back(std::move(s));
  }

  /// Adds the points on thick wood's own surface whose paths came up a branch that borders on it.
  void gather_surface(Section& s) {
    const double tolerance = std::max(1.5 * settings_.noise_m, 0.15 * s.radius_m);
    const double half = 0.6 * step(s);
    const std::uint32_t id = group_[s.points.front()];
    for (std::size_t m = 0; m < s.points.size(); ++m)
      for (const std::uint32_t v : graph_.of(s.points[m])) {
        if (group_[v] != Paths::kNone || !std::isfinite(paths_.length[v])) continue;
        const Vec3 d = points_[v] - s.centre;
        const double along = d.dot(s.direction);
        if (std::abs(along) > half || std::abs((d - along * s.direction).norm() - s.radius_m) > tolerance)
          continue;
        group_[v] = id;
        s.points.push_back(v);
      }
  }

  Section successor(std::int32_t index, const Section& parent, const Group& group) const {
    Section s;
    s.parent = index;
    // Where the group touches its parent tells whether it goes on or leaves sideways.
    Vec3 from = Vec3::Zero();
    double links = 0, narrowest = 1e300;
    for (const std::uint32_t p : group.points) {
      const std::uint32_t q = paths_.parent[p];
      if (q == Paths::kNone || group_[q] == group_[p]) continue;
      from += points_[q];
      links += 1;
      narrowest = std::min(narrowest, (points_[p] - points_[q]).norm());
    }
    s.after_gap = links > 0 && narrowest > 4 * graph_.typical_spacing_m;
    if (group.main && continue_cylinder(parent, group, s)) return s;
    const Vec3 ahead = group.mean - parent.centre;
    const double along = ahead.dot(parent.direction);
    const double aside = (ahead - parent.direction * along).norm();
    const bool goes_on = aside <= 0.6 * parent.radius_m + settings_.noise_m && along > 0;
    // In a crotch the cross-section is no circle for a while, and behind others' wood too little is seen:
    // thick wood keeps its course.
    if (group.main && parent.radius_m > 4 * settings_.noise_m && along > 0 &&
        parent.coasted_m + along < 5 * parent.radius_m) {
      s.centre = parent.centre + along * parent.direction;
      s.direction = parent.direction;
      s.radius_m = 0.99 * parent.radius_m;
      s.coasted_m = parent.coasted_m + along;
      return s;
    }
    Vec3 direction;
    if (goes_on) {
      direction = parent.direction + 0.6 * ahead.normalized();
    } else {
      const Vec3 start = links > 0 ? Vec3(from / links) : parent.centre;
      const Vec3 run = group.mean - start;
      direction = run.norm() > 1e-9 ? Vec3(run.normalized() + 0.5 * ahead.normalized()) : ahead;
    }
    s.direction = direction.norm() > 1e-9 ? direction.normalized() : parent.direction;
    const SpaceCircle circle = circle_along(points_, group.points, group.mean, s.direction);
    const CircleFit& fit = circle.fit;
    const double most = (goes_on ? 1.6 : 1.0) * parent.radius_m + settings_.noise_m;
    if (fit.ok && group.points.size() >= 12 && fit.coverage > 0.4 && fit.radius < most) {
      s.centre = circle.centre;
      s.radius_m = fit.radius;
      if (goes_on)  // thickness changes slowly along a branch
        s.radius_m =
            0.5 * (fit.radius + std::clamp(fit.radius, 0.6 * parent.radius_m, 1.2 * parent.radius_m));
    } else {
      s.centre = group.mean;
      const double rms = extent(group, s.direction);
      s.radius_m = std::min(rms, parent.radius_m * 1.05);
      if (goes_on && parent.radius_m > 4 * settings_.noise_m) {
        // Too little is seen: the section before tells size and place.
        s.radius_m = std::max(s.radius_m, 0.97 * parent.radius_m);
        s.centre = parent.centre + parent.direction * along;
        s.direction = parent.direction;
      }
    }
    return s;
  }

  const std::vector<Vec3>& points_;
  const PointGraph& graph_;
  const Paths& paths_;
  PathChildren children_;
  std::vector<std::uint32_t> group_;
  std::vector<Section> sections_;
  std::priority_queue<Next> next_;
  std::vector<float> end_;  // path length at which each section ends
  std::uint32_t next_group_ = 0;
  Settings settings_{};
};

}  // namespace

std::vector<Section> cut_sections(const std::vector<Vec3>& points, const PointGraph& graph,
                                  const Paths& paths, const std::vector<Foot>& feet, Progress& progress) {
  progress.begin("sections", 0, "sections");
  std::vector<Section> sections = Cutter(points, graph, paths).cut(feet, progress);
  progress.end();
  return sections;
}

}  // namespace dendrofit
