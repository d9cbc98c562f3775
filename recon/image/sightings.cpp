// SPDX-License-Identifier: GPL-3.0-or-later
#include "recon/image/sightings.h"

#include "core/parallel.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include <Eigen/Geometry>

namespace dendrofit {
namespace {

constexpr double kProfileStep = 0.5;  // pixels
constexpr std::array<double, 3> kStations{0.25, 0.5, 0.75};
constexpr std::int32_t kNobody = -1, kSeveral = -2;

/// Which axis covers each pixel of a view.
class Cover {
 public:
  Cover(const Tree& tree, const Camera& camera)
      : width_(camera.width),
        height_(camera.height),
        axis_(static_cast<std::size_t>(camera.width) * static_cast<std::size_t>(camera.height), kNobody) {
    for (std::size_t i = 0; i < tree.size(); ++i) {
      const auto a = camera.project(tree.start[i]), b = camera.project(tree.end[i]);
      if (!a || !b) continue;
      const double depth = camera.depth(0.5 * (tree.start[i] + tree.end[i]));
      stamp(*a, *b, tree.radius[i] * camera.fx / depth + 0.5, tree.axis[i]);
    }
  }
  /// Whether nobody but `axis` covers the line from -reach to +reach along `normal` about a pixel.
  bool only(std::int32_t axis, const Eigen::Vector2d& at, const Eigen::Vector2d& normal, double reach) const {
    for (double t = -reach; t <= reach; t += 0.7) {
      const Eigen::Vector2d p = at + t * normal;
      const int x = static_cast<int>(std::floor(p.x())), y = static_cast<int>(std::floor(p.y()));
      if (x < 0 || y < 0 || x >= width_ || y >= height_) return false;
      const std::int32_t who = axis_[index(x, y)];
      if (who != kNobody && who != axis) return false;
    }
    return true;
  }

 private:
  std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(x);
  }
  void stamp(const Eigen::Vector2d& a, const Eigen::Vector2d& b, double reach, std::int32_t axis) {
    const Eigen::Vector2d lo = a.cwiseMin(b).array() - reach, hi = a.cwiseMax(b).array() + reach;
    const Eigen::Vector2d run = b - a;
    const double square = std::max(1e-12, run.squaredNorm());
    for (int y = std::max(0, static_cast<int>(lo.y())); y <= std::min<double>(height_ - 1, hi.y()); ++y)
      for (int x = std::max(0, static_cast<int>(lo.x())); x <= std::min<double>(width_ - 1, hi.x()); ++x) {
        const Eigen::Vector2d p(x + 0.5, y + 0.5);
        const double t = std::clamp((p - a).dot(run) / square, 0.0, 1.0);
        if ((a + t * run - p).squaredNorm() > reach * reach) continue;
        std::int32_t& who = axis_[index(x, y)];
        who = who == kNobody || who == axis ? axis : kSeveral;
      }
  }
  int width_, height_;
  std::vector<std::int32_t> axis_;
};

struct Stretch {
  double middle = 0, half_width = 0;
};

/// The stretch of mask along `normal` whose middle is nearest to `at`, with ends between samples where the
/// distance crosses zero; none where it runs on beyond `reach`.
std::optional<Stretch> stretch_across(const Outline& outline, const Eigen::Vector2d& at,
                                      const Eigen::Vector2d& normal, double reach) {
  std::optional<Stretch> best;
  double before = outline.at(at - reach * normal);
  double begin = std::numeric_limits<double>::quiet_NaN();
  for (double t = -reach + kProfileStep; t <= reach; t += kProfileStep) {
    const double here = outline.at(at + t * normal);
    const auto crossing = [&] { return t - kProfileStep * here / (here - before); };
    if (before >= 0 && here < 0) begin = crossing();
    if (before < 0 && here >= 0 && std::isfinite(begin)) {
      const double end = crossing();
      const Stretch found{0.5 * (begin + end), 0.5 * (end - begin)};
      if (!best || std::abs(found.middle) < std::abs(best->middle)) best = found;
      begin = std::numeric_limits<double>::quiet_NaN();
    }
    before = here;
  }
  return best;
}

/// Half the wood across a stretch: what its pixels are covered by, a soft edge of 2 pixels included.
double half_cover(const Outline& outline, const Eigen::Vector2d& at, const Eigen::Vector2d& normal,
                  const Stretch& stretch) {
  constexpr double kEdge = 2;
  double sum = 0;
  const double reach = stretch.half_width + kEdge;
  for (double t = -reach; t <= reach; t += 0.5 * kProfileStep)
    sum += outline.cover_at(at + (stretch.middle + t) * normal) * 0.5 * kProfileStep;
  return 0.5 * sum;
}

double median(std::vector<double>& values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

std::optional<Sighting> sight(const Tree& tree, std::size_t i, const Camera& camera, const Outline& outline,
                              const Cover& cover, double reach_px) {
  const Vec3 middle = 0.5 * (tree.start[i] + tree.end[i]);
  const Vec3 look = middle - camera.centre();
  Sighting found;
  found.across = tree.direction(i).cross(look);
  const double sine = found.across.norm() / look.norm();
  if (sine < 0.25) return std::nullopt;  // seen from its end
  found.across.normalize();
  std::vector<double> offsets, widths;
  int alone = 0;
  for (const double share : kStations) {
    const Vec3 p = tree.start[i] + share * (tree.end[i] - tree.start[i]);
    const auto at = camera.project(p), beside = camera.project(p + 1e-3 * found.across);
    if (!at || !beside || !outline.holds(*at)) continue;
    const double per_m = (*beside - *at).norm() / 1e-3;
    const Eigen::Vector2d normal = (*beside - *at).normalized();
    const double radius_px = tree.radius[i] * per_m;
    const auto stretch = stretch_across(outline, *at, normal, reach_px + 2.2 * radius_px);
    if (!stretch) continue;
    found.px_per_m = per_m;
    offsets.push_back(stretch->middle);
    widths.push_back(outline.knows_cover() ? half_cover(outline, *at, normal, *stretch)
                                           : stretch->half_width);
    alone += cover.only(tree.axis[i], *at + stretch->middle * normal, normal,
                        std::max(2 * stretch->half_width, stretch->half_width + 2));
  }
  if (offsets.size() < 2) return std::nullopt;
  found.offset_px = median(offsets);
  found.half_width_px = median(widths);
  found.alone = alone >= 2;
  return found;
}

}  // namespace

Sightings sight_cylinders(const Tree& tree, const std::vector<Camera>& cameras,
                          const std::vector<Outline>& outlines, double reach_px, int threads,
                          Progress& progress) {
  std::vector<std::vector<std::optional<Sighting>>> by_view(cameras.size());
  parallel_blocks(cameras.size(), 1, threads, [&](std::size_t first, std::size_t end) {
    for (std::size_t v = first; v < end; ++v) {
      progress.check();
      const Cover cover(tree, cameras[v]);
      by_view[v].resize(tree.size());
      for (std::size_t i = 0; i < tree.size(); ++i)
        by_view[v][i] = sight(tree, i, cameras[v], outlines[v], cover, reach_px);
    }
  });
  Sightings sightings(tree.size());
  for (std::size_t i = 0; i < tree.size(); ++i)
    for (std::size_t v = 0; v < cameras.size(); ++v)
      if (by_view[v][i]) {
        sightings[i].push_back(*by_view[v][i]);
        sightings[i].back().view = static_cast<std::int32_t>(v);
      }
  return sightings;
}

int support_of(const std::vector<Sighting>& sightings) {
  constexpr double kNear = 1.5, kAgree = 0.35;
  // Wood in the way only widens a stretch: the true width is among the narrower ones.
  std::vector<double> widths;
  for (const Sighting& s : sightings) widths.push_back(s.half_width_px / s.px_per_m);
  std::sort(widths.begin(), widths.end());
  int most = 0;
  for (const double radius : widths) {
    int count = 0;
    for (const Sighting& s : sightings) {
      const double r = s.half_width_px / s.px_per_m;
      count += std::abs(s.offset_px) <= kNear + 0.5 * radius * s.px_per_m &&
               std::abs(r - radius) <= kAgree * radius;
    }
    most = std::max(most, count);
  }
  return most;
}

}  // namespace dendrofit
