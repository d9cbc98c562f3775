// SPDX-License-Identifier: GPL-3.0-or-later
#include "recon/image/lift.h"

#include "core/errors.h"
#include "core/random.h"
#include "core/tree_topology.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>

namespace dendrofit {
namespace {

/// A place in the frame's plane and behind it: metres to the right, up, and away from the camera.
struct PlaneAxes {
  Vec3 right, away;
  explicit PlaneAxes(const Vec3& away_from_camera)
      : right(away_from_camera.cross(Vec3::UnitZ())), away(away_from_camera) {}
  Eigen::Vector2d flat(const Vec3& v) const { return {v.dot(right), v.z()}; }
};

class Lifter {
 public:
  Lifter(const PlaneSkeleton& skeleton, const PictureFrame& frame, const LiftOptions& options)
      : skeleton_(skeleton), frame_(frame), options_(options), axes_(frame.away) {}

  Tree run() {
    lay_flat();
    axis_list_ = axes_of(tree_);
    measure_silhouette();
    measure_opening();
    place_axes();
    return finish();
  }

 private:
  Vec3 on_ray(std::size_t node, double depth) const {
    const auto p = frame_.point(skeleton_.px[node], depth);
    if (!p)
      throw SolverError("the tree's rays do not meet the plane it stands in: the camera is turned away");
    return *p;
  }

  /// The tree with every depth 0.
  void lay_flat() {
    tree_.reserve(skeleton_.size());
    const Vec3 root = on_ray(0, 0);
    std::int32_t axes = 0;
    for (std::size_t i = 1; i < skeleton_.size(); ++i) {
      const std::int32_t parent = skeleton_.parent[i] - 1;
      const Vec3 end = on_ray(i, 0);
      const bool continues = parent >= 0 && skeleton_.continues[i];
      const auto bearer = static_cast<std::size_t>(std::max(parent, 0));
      tree_.add({.start = parent < 0 ? root : tree_.end[bearer],
                 .end = end,
                 .parent = parent,
                 .radius = skeleton_.radius_px[i] * frame_.metres_per_pixel(end),
                 .axis = continues ? tree_.axis[bearer] : axes++,
                 .order = parent < 0 ? 0 : (continues ? tree_.order[bearer] : tree_.order[bearer] + 1)});
    }
  }

  Eigen::Vector2d flat_direction(std::size_t from, std::size_t to) const {
    const Eigen::Vector2d d = axes_.flat(tree_.end[to] - tree_.start[from]);
    return d.norm() > 0 ? Eigen::Vector2d(d.normalized()) : Eigen::Vector2d(0, 1);
  }

  /// The direction, in the plane, of an axis over its first quarter; of its bearer where it leaves.
  Eigen::Vector2d leaving_direction(const Axis& axis) const {
    const std::size_t n = axis.nodes.size();
    const std::size_t last = std::max(std::min<std::size_t>(n - 1, 4), n / 4);
    return flat_direction(static_cast<std::size_t>(axis.nodes[0]),
                          static_cast<std::size_t>(axis.nodes[last]));
  }
  Eigen::Vector2d bearer_direction(const Axis& axis) const {
    std::size_t from = static_cast<std::size_t>(axis.parent_node);
    const std::size_t to = from;
    for (int k = 0; k < 3; ++k) {
      const std::int32_t p = tree_.parent[from];
      if (p < 0 || tree_.axis[static_cast<std::size_t>(p)] != tree_.axis[to]) break;
      from = static_cast<std::size_t>(p);
    }
    return flat_direction(from, to);
  }

  /// Half-width of the flat tree by height, in fiftieths of its height.
  void measure_silhouette() {
    foot_ = axes_.flat(tree_.start[0]);
    for (std::size_t i = 0; i < tree_.size(); ++i) top_ = std::max(top_, tree_.end[i].z() - foot_.y());
    top_ /= 1 + frame_.top_lead;
    half_width_.assign(kBands + 1, 0);
    for (std::size_t i = 0; i < tree_.size(); ++i) {
      double& width = half_width_[band(tree_.end[i].z() - foot_.y())];
      width = std::max(width, std::abs(axes_.flat(tree_.end[i]).x() - foot_.x()));
    }
    // A branch may lean over its neighbours' heights.
    std::vector<double> wide = half_width_;
    for (std::size_t b = 0; b <= kBands; ++b)
      for (std::size_t k = b > 2 ? b - 2 : 0; k <= std::min(kBands, b + 2); ++k)
        wide[b] = std::max(wide[b], half_width_[k]);
    half_width_ = wide;
  }
  std::size_t band(double height) const {
    return static_cast<std::size_t>(std::clamp(height / std::max(top_, 1e-9), 0.0, 1.0) * kBands);
  }

  /// cos of the opening angle by order: the 90th percentile, by length, of the angles seen. Axes of a few
  /// nodes only tell the pixel grid's directions; beyond 80 degrees lie branches that turn away, not
  /// openings.
  void measure_opening() {
    struct Seen {
      double angle, length;
      bool operator<(const Seen& o) const { return angle < o.angle; }
    };
    constexpr std::size_t shortest = 8, fewest = 8;
    constexpr double degree = std::numbers::pi / 180;
    std::map<std::int32_t, std::vector<Seen>> seen;
    for (const Axis& axis : axis_list_) {
      if (axis.parent_node < 0) continue;
      auto& list = seen[axis.order];
      if (axis.nodes.size() < shortest) continue;
      const double cosine = leaving_direction(axis).dot(bearer_direction(axis));
      list.push_back({std::acos(std::clamp(cosine, -1.0, 1.0)), axis.length});
    }
    for (auto& [order, list] : seen) {
      double angle = options_.opening_angle_deg * degree;
      if (list.size() >= fewest) {
        std::sort(list.begin(), list.end());
        double total = 0, below = 0;
        for (const Seen& s : list) total += s.length;
        std::size_t k = 0;
        while (k + 1 < list.size() && (below += list[k].length) < 0.9 * total) ++k;
        angle = std::clamp(list[k].angle, 15 * degree, 80 * degree);
      }
      cosine_[order] = std::cos(angle);
    }
  }

  /// Slopes m into the picture under which direction (e, m) makes the angle with the bearer's direction a:
  /// (a.e + a_z m)^2 = cos^2 (1 + m^2).
  std::vector<double> slopes(const Eigen::Vector2d& e, const Vec3& a, double cosine) const {
    const double ae = a.x() * e.x() + a.y() * e.y(), az = a.z();
    const double qa = az * az - cosine * cosine, qb = 2 * ae * az, qc = ae * ae - cosine * cosine;
    std::vector<double> found;
    if (std::abs(qa) < 1e-12) {
      if (std::abs(qb) > 1e-12) found = {-qc / qb};
    } else if (const double d = qb * qb - 4 * qa * qc; d >= 0) {
      found = {(-qb - std::sqrt(d)) / (2 * qa), (-qb + std::sqrt(d)) / (2 * qa)};
    }
    std::erase_if(found, [&](double m) { return ae + az * m < 0; });  // the supplement of the angle
    if (found.empty()) found = {0};
    for (double& m : found) m = std::clamp(m, -options_.steepest_slope, options_.steepest_slope);
    return found;
  }

  /// The depth at which a node's ray is as high as the tree is.
  double depth_at_top(std::size_t cylinder) const {
    const double eye = frame_.camera.centre().z(), rise = tree_.end[cylinder].z() - eye;
    return ((top_ + foot_.y() - eye) / rise - 1) * frame_.distance_m;
  }

  /// Depths of an axis' nodes for a slope, less steep where the crown is too narrow for it, and turned so
  /// that it stays below the top.
  std::vector<double> depths(const Axis& axis, double slope) const {
    const double start = axis.parent_node >= 0 ? depth_[static_cast<std::size_t>(axis.parent_node)] : 0;
    std::vector<double> run(axis.nodes.size());
    double sum = 0;
    for (std::size_t k = 0; k < axis.nodes.size(); ++k)
      run[k] = sum += tree_.length(static_cast<std::size_t>(axis.nodes[k]));
    for (std::size_t k = 0; k < axis.nodes.size(); ++k) {
      const auto cylinder = static_cast<std::size_t>(axis.nodes[k]);
      const double rise = tree_.end[cylinder].z() - frame_.camera.centre().z();
      const double height = tree_.end[cylinder].z() - foot_.y();
      const double room = std::max(half_width_[band(height)], std::abs(start));
      double depth = start + slope * run[k];
      if (std::abs(depth) > room) depth = std::copysign(room, depth);
      if (std::abs(rise) > 1e-9) {
        const double limit = depth_at_top(cylinder);
        depth = rise > 0 ? std::min(depth, limit) : std::max(depth, limit);
      }
      slope = (depth - start) / run[k];
    }
    for (double& r : run) r = start + slope * r;
    return run;
  }

  /// Depths of the stem: in the plane, but where its top would stand above the tree it bends to the camera.
  std::vector<double> stem_depths(const Axis& axis) const {
    const double eye = frame_.camera.centre().z();
    double bend = 0;
    std::vector<double> share;
    for (const std::int32_t node : axis.nodes) {
      const double z = tree_.end[static_cast<std::size_t>(node)].z(), height = z - foot_.y();
      share.push_back(std::pow(std::max(0.0, height / top_), 2));
      if (z > eye && height > top_)
        bend = std::min(bend, depth_at_top(static_cast<std::size_t>(node)) / share.back());
    }
    for (double& s : share) s *= bend;
    return share;
  }

  /// Distance from the middle and the tip of an axis, so placed, to the nearest branch already there.
  double clearance(const Axis& axis, const std::vector<double>& depth) const {
    double least = std::numeric_limits<double>::max(), sum = 0;
    for (const std::size_t k : {axis.nodes.size() / 2, axis.nodes.size() - 1}) {
      least = std::numeric_limits<double>::max();
      const Vec3 p = on_ray(static_cast<std::size_t>(axis.nodes[k]) + 1, depth[k]);
      for (const Vec3& other : placed_) least = std::min(least, (p - other).squaredNorm());
      sum += std::sqrt(least);
    }
    return sum;
  }

  void place(const Axis& axis, const std::vector<double>& depth) {
    for (std::size_t k = 0; k < axis.nodes.size(); ++k)
      depth_[static_cast<std::size_t>(axis.nodes[k])] = depth[k];
    const std::size_t step = std::max<std::size_t>(1, axis.nodes.size() / 4);
    for (std::size_t k = step - 1; k < axis.nodes.size(); k += step)
      placed_.push_back(on_ray(static_cast<std::size_t>(axis.nodes[k]) + 1, depth[k]));
  }

  /// Direction of the bearer in the frame's axes (right, up, away), depths included.
  Vec3 bearer_in_space(const Axis& axis) const {
    const auto at = static_cast<std::size_t>(axis.parent_node);
    std::size_t from = at;
    for (int k = 0; k < 4 && tree_.parent[from] >= 0; ++k)
      from = static_cast<std::size_t>(tree_.parent[from]);
    const double start = tree_.parent[from] >= 0 ? depth_[static_cast<std::size_t>(tree_.parent[from])] : 0;
    const Eigen::Vector2d flat = axes_.flat(tree_.end[at] - tree_.start[from]);
    const Vec3 d(flat.x(), flat.y(), depth_[at] - start);
    return d.norm() > 0 ? Vec3(d.normalized()) : Vec3(0, 1, 0);
  }

  void place_axes() {
    depth_.assign(tree_.size(), 0);
    const std::vector<double> beyond = length_beyond(tree_);
    std::vector<std::size_t> order(axis_list_.size());
    for (std::size_t a = 0; a < order.size(); ++a) order[a] = a;
    // By order, so that bearers come first; within it the longest subtrees first.
    std::stable_sort(order.begin(), order.end(), [&](std::size_t l, std::size_t r) {
      const Axis &x = axis_list_[l], &y = axis_list_[r];
      if (x.order != y.order) return x.order < y.order;
      return beyond[static_cast<std::size_t>(x.nodes[0])] > beyond[static_cast<std::size_t>(y.nodes[0])];
    });
    for (const std::size_t a : order) {
      const Axis& axis = axis_list_[a];
      if (axis.parent_node < 0) {
        place(axis, stem_depths(axis));
        continue;
      }
      const std::vector<double> found =
          slopes(leaving_direction(axis), bearer_in_space(axis), cosine_[axis.order]);
      std::vector<double> best = depths(axis, found[0]);
      if (found.size() == 2) {
        const std::vector<double> other = depths(axis, found[1]);
        const double one = clearance(axis, best), two = clearance(axis, other);
        const bool tie = std::abs(one - two) <= 0.01 * std::max(one, two);
        const bool swap = tie ? Random(options_.seed).child({a}).uniform() < 0.5 : two > one;
        if (swap) best = other;
      }
      place(axis, best);
    }
  }

  Tree finish() {
    for (std::size_t i = 0; i < tree_.size(); ++i) {
      tree_.end[i] = on_ray(i + 1, depth_[i]);
      tree_.radius[i] = skeleton_.radius_px[i + 1] * frame_.metres_per_pixel(tree_.end[i]);
      const bool invented = tree_.order[i] > 0 || skeleton_.bridge[i + 1];
      tree_.quality[i] = invented ? RadiusQuality::extrapolated : RadiusQuality::measured;
    }
    for (std::size_t i = 0; i < tree_.size(); ++i) {
      const std::int32_t p = tree_.parent[i];
      if (p < 0) continue;
      const auto bearer = static_cast<std::size_t>(p);
      tree_.start[i] = tree_.end[bearer];
      if (tree_.axis[i] == tree_.axis[bearer]) continue;
      // A branch starts on its bearer's surface.
      const Vec3 d = tree_.end[i] - tree_.end[bearer];
      tree_.start[i] += d * std::min(0.8, tree_.radius[bearer] / std::max(d.norm(), 1e-12));
    }
    const Vec3 base = frame_.foot;
    for (std::size_t i = 0; i < tree_.size(); ++i) {
      tree_.start[i] -= base;
      tree_.end[i] -= base;
    }
    tree_.origin_shift = base;
    return std::move(tree_);
  }

  static constexpr std::size_t kBands = 50;
  const PlaneSkeleton& skeleton_;
  const PictureFrame& frame_;
  const LiftOptions& options_;
  PlaneAxes axes_;
  Tree tree_;
  std::vector<Axis> axis_list_;
  std::vector<double> depth_;
  std::vector<double> half_width_;
  std::map<std::int32_t, double> cosine_;
  std::vector<Vec3> placed_;
  Eigen::Vector2d foot_ = Eigen::Vector2d::Zero();
  double top_ = 0;
};

}  // namespace

void LiftOptions::validate() const {
  require(opening_angle_deg > 0 && opening_angle_deg < 180, "opening_angle_deg", opening_angle_deg,
          "must be between 0 and 180");
  require(std::isfinite(steepest_slope) && steepest_slope >= 0, "steepest_slope", steepest_slope,
          "must not be negative");
}

Tree lift(const PlaneSkeleton& skeleton, const PictureFrame& frame, const LiftOptions& options) {
  options.validate();
  if (skeleton.size() < 2) throw InputError("the skeleton has no line: nothing to lift");
  return Lifter(skeleton, frame, options).run();
}

}  // namespace dendrofit
