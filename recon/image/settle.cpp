// SPDX-License-Identifier: GPL-3.0-or-later
#include "recon/image/settle.h"

#include "core/tree_topology.h"
#include "recon/taper.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>

namespace dendrofit {
namespace {

constexpr double kOffScale = 1.0;       // pixels: offsets beyond this lose weight
constexpr double kPriorShift = 0.5;     // pixels: how far off a carved axis is expected to lie
constexpr double kThinnest = 0.7;       // pixels: half widths below are the mask's threshold, not the wood
constexpr double kEdgeDoubt = 0.25;     // pixels: of one view's half width
constexpr double kTwigRadius = 0.0015;  // metres: of broadleaves' last shoots

struct Shift {
  Vec3 by = Vec3::Zero();
  double weight = 0;  // 0: nothing seen
};

Shift shift_of(const Vec3& axis, const std::vector<Sighting>& sightings, double radius) {
  Shift shift;
  const Vec3 e = axis.unitOrthogonal(), f = axis.cross(e);
  std::vector<const Sighting*> used;
  for (const bool alone : {true, false}) {
    for (const Sighting& s : sightings)
      if (s.alone == alone && (alone || std::abs(s.half_width_px / s.px_per_m - radius) < 0.35 * radius))
        used.push_back(&s);
    if (used.size() >= 3) break;
  }
  if (used.size() < 2) return shift;
  Eigen::Vector2d at(0, 0);
  Eigen::Matrix2d normal;
  for (int round = 0; round < 8; ++round) {
    normal.setZero();
    Eigen::Vector2d right(0, 0);
    double scale = 0;
    for (const Sighting* s : used) {
      const Eigen::Vector2d row = s->px_per_m * Eigen::Vector2d(s->across.dot(e), s->across.dot(f));
      const double off = (s->offset_px - row.dot(at)) / kOffScale;
      const double weight = 1 / (1 + off * off);
      normal += weight * row * row.transpose();
      right += weight * s->offset_px * row;
      scale = std::max(scale, s->px_per_m);
    }
    normal += Eigen::Matrix2d::Identity() * (scale * scale * kPriorShift * kPriorShift * 0.1);
    at = normal.ldlt().solve(right);
  }
  shift.by = at.x() * e + at.y() * f;
  shift.weight = static_cast<double>(used.size());
  return shift;
}

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// radius = scale * beyond^exponent through the measured cylinders, in logarithms.
struct Relation {
  double scale = 0, exponent = 0.5;
  double at(double beyond) const {
    return std::max(kTwigRadius, scale * std::pow(std::max(beyond, 0.01), exponent));
  }
};

Relation relation(const Tree& tree, const std::vector<double>& beyond) {
  Relation result;
  double sw = 0, sx = 0, sy = 0, sxx = 0, sxy = 0;
  const auto add = [&](double x, double y, double w) {
    sw += w, sx += w * x, sy += w * y, sxx += w * x * x, sxy += w * x * y;
  };
  for (std::size_t i = 0; i < tree.size(); ++i)
    if (tree.quality[i] == RadiusQuality::measured)
      add(std::log(std::max(beyond[i], 0.01)), std::log(tree.radius[i]), tree.length(i));
  if (sw == 0) {
    for (std::size_t i = 0; i < tree.size(); ++i)
      add(std::log(std::max(beyond[i], 0.01)), std::log(tree.radius[i]), tree.length(i));
  }
  add(std::log(0.02), std::log(kTwigRadius), 0.02 * sw);
  const double det = sw * sxx - sx * sx;
  if (det > 1e-9 * sw * sw) result.exponent = std::clamp((sw * sxy - sx * sy) / det, 0.25, 1.0);
  result.scale = std::exp((sy - result.exponent * sx) / sw);
  return result;
}

/// Cylinders where two arms of like thickness part: pictures show them as one, wider than either.
std::vector<char> in_forks(const Tree& tree) {
  constexpr double kLike = 0.5;  // of the thicker arm's radius
  constexpr double kReach = 2;   // radii of the bearer from the fork to a cylinder's middle
  const TreeChildren children(tree);
  std::vector<char> in_fork(tree.size(), 0);
  std::vector<std::pair<double, double>> radii(tree.size(), {0, 0});  // of the two thickest arms
  for (std::size_t i = 0; i < tree.size(); ++i)
    for (const std::int32_t c : children.of(i)) {
      const double r = tree.radius[static_cast<std::size_t>(c)];
      auto& [first, second] = radii[i];
      second = std::max(second, std::min(first, r));
      first = std::max(first, r);
    }
  std::vector<double> reach(tree.size(), 0);  // left of the fork's, at a cylinder's end
  for (std::size_t i = 0; i < tree.size(); ++i) {
    if (tree.parent[i] < 0) continue;
    const auto p = static_cast<std::size_t>(tree.parent[i]);
    const auto& [first, second] = radii[p];
    const bool arm = second > kLike * first && tree.radius[i] > kLike * first;
    const double left = arm ? kReach * tree.radius[p] : reach[p];
    in_fork[i] = 0.5 * tree.length(i) < left;
    reach[i] = left - tree.length(i);
  }
  return in_fork;
}

/// An axis' first cylinders follow from the first radius measured on it, as the tree tapers.
void carry_down(Tree& tree, const std::vector<Axis>& axes, const std::vector<double>& beyond, double exponent,
                std::vector<double>& weight) {
  for (const Axis& axis : axes) {
    const auto first = std::find_if(axis.nodes.begin(), axis.nodes.end(), [&](std::int32_t n) {
      return tree.quality[static_cast<std::size_t>(n)] == RadiusQuality::measured;
    });
    if (first == axis.nodes.end() || axis.parent_node < 0) continue;
    const auto from = static_cast<std::size_t>(*first);
    for (auto n = axis.nodes.begin(); n != first; ++n) {
      const auto i = static_cast<std::size_t>(*n);
      tree.radius[i] = tree.radius[from] * std::pow(beyond[i] / beyond[from], exponent);
      tree.quality[i] = RadiusQuality::interpolated;
      tree.radius_se[i] = 3 * tree.radius_se[from];
      weight[i] = 0.1 * weight[from];
    }
  }
}

void interpolate(Tree& tree, const std::vector<Axis>& axes, std::vector<double>& weight) {
  for (const Axis& axis : axes) {
    std::ptrdiff_t before = -1;
    for (std::ptrdiff_t k = 0; k < static_cast<std::ptrdiff_t>(axis.nodes.size()); ++k) {
      const auto here = static_cast<std::size_t>(axis.nodes[static_cast<std::size_t>(k)]);
      if (tree.quality[here] != RadiusQuality::measured) continue;
      if (before >= 0)
        for (std::ptrdiff_t m = before + 1; m < k; ++m) {
          const auto between = static_cast<std::size_t>(axis.nodes[static_cast<std::size_t>(m)]);
          const auto from = static_cast<std::size_t>(axis.nodes[static_cast<std::size_t>(before)]);
          const double t = static_cast<double>(m - before) / static_cast<double>(k - before);
          tree.radius[between] = (1 - t) * tree.radius[from] + t * tree.radius[here];
          tree.quality[between] = RadiusQuality::interpolated;
          tree.radius_se[between] = 2 * std::max(tree.radius_se[from], tree.radius_se[here]);
          weight[between] = 0.25 * std::min(weight[from], weight[here]);
        }
      before = k;
    }
  }
}

}  // namespace

std::vector<char> supported(const Tree& tree, const Sightings& sightings, int least_views) {
  std::vector<char> keep(tree.size(), 0);
  // A supported cylinder carries the way down from it.
  for (std::size_t i = tree.size(); i-- > 0;) {
    if (!keep[i]) keep[i] = support_of(sightings[i]) >= least_views;
    if (keep[i] && tree.parent[i] >= 0) keep[static_cast<std::size_t>(tree.parent[i])] = 1;
  }
  for (std::size_t i = 0; i < tree.size(); ++i)
    if (tree.parent[i] < 0) keep[i] = 1;
  return keep;
}

void centre_on_views(Tree& tree, const Sightings& sightings) {
  std::vector<Shift> shifts(tree.size());
  for (std::size_t i = 0; i < tree.size(); ++i)
    shifts[i] = shift_of(tree.direction(i), sightings[i], tree.radius[i]);
  const std::vector<Axis> axes = axes_of(tree);
  std::vector<Vec3> moved(tree.size(), Vec3::Zero());  // of each cylinder's middle
  for (const Axis& axis : axes) {
    const auto n = static_cast<std::ptrdiff_t>(axis.nodes.size());
    for (std::ptrdiff_t k = 0; k < n; ++k) {
      Vec3 sum = Vec3::Zero();
      double weight = 0.5;
      for (std::ptrdiff_t m = std::max<std::ptrdiff_t>(0, k - 2); m <= std::min(n - 1, k + 2); ++m) {
        const Shift& s = shifts[static_cast<std::size_t>(axis.nodes[static_cast<std::size_t>(m)])];
        const double w = s.weight * (m == k ? 1.0 : std::abs(m - k) == 1 ? 0.5 : 0.2);
        sum += w * s.by;
        weight += w;
      }
      moved[static_cast<std::size_t>(axis.nodes[static_cast<std::size_t>(k)])] = sum / weight;
    }
  }
  std::vector<Vec3> end_shift(tree.size());
  for (const Axis& axis : axes)
    for (std::size_t k = 0; k < axis.nodes.size(); ++k) {
      const auto i = static_cast<std::size_t>(axis.nodes[k]);
      end_shift[i] = k + 1 < axis.nodes.size()
                         ? Vec3(0.5 * (moved[i] + moved[static_cast<std::size_t>(axis.nodes[k + 1])]))
                         : moved[i];
    }
  const Tree before = tree;
  for (std::size_t i = 0; i < tree.size(); ++i) {
    tree.end[i] = before.end[i] + end_shift[i];
    const std::int32_t p = tree.parent[i];
    if (p < 0)
      tree.start[i] += moved[i];
    else if (before.start[i] == before.end[static_cast<std::size_t>(p)])
      tree.start[i] = tree.end[static_cast<std::size_t>(p)];
    else
      tree.start[i] += end_shift[static_cast<std::size_t>(p)];
    if ((tree.end[i] - tree.start[i]).norm() < 1e-4) tree.end[i] = tree.start[i] + 1e-3 * before.direction(i);
  }
}

void settle_radii_from_views(Tree& tree, const Sightings& sightings) {
  std::vector<double> weight(tree.size(), 0), radii;
  const std::vector<char> in_fork = in_forks(tree);
  for (std::size_t i = 0; i < tree.size(); ++i) {
    radii.clear();
    double px_per_m = 0;
    for (const Sighting& s : sightings[i])
      if (s.alone && s.half_width_px >= kThinnest) {
        radii.push_back(s.half_width_px / s.px_per_m);
        px_per_m = std::max(px_per_m, s.px_per_m);
      }
    tree.quality[i] = RadiusQuality::extrapolated;
    if (radii.size() < 2 || in_fork[i]) continue;
    const double middle = median(radii);
    for (double& r : radii) r = std::abs(r - middle);
    const double spread = std::hypot(1.4826 * median(radii), kEdgeDoubt / px_per_m);
    tree.radius[i] = middle;
    tree.radius_se[i] =
        std::hypot(1.25 * spread / std::sqrt(static_cast<double>(radii.size())), 0.01 * middle);
    tree.quality[i] = RadiusQuality::measured;
    weight[i] = 1 / (tree.radius_se[i] * tree.radius_se[i]);
  }
  const std::vector<double> beyond = length_beyond(tree);
  const Relation own = relation(tree, beyond);
  const std::vector<Axis> axes = axes_of(tree);
  interpolate(tree, axes, weight);
  carry_down(tree, axes, beyond, own.exponent, weight);
  for (std::size_t i = 0; i < tree.size(); ++i) {
    if (weight[i] > 0) continue;
    tree.radius[i] = own.at(beyond[i]);
    tree.radius_se[i] = 0.4 * tree.radius[i];
    weight[i] = 1 / (tree.radius_se[i] * tree.radius_se[i]);
  }
  tree.radius = falling_towards_tips(tree.radius, weight, tree.parent);
}

}  // namespace dendrofit
