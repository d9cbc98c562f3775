// SPDX-License-Identifier: GPL-3.0-or-later
#include "recon/image/tips.h"

#include "core/parallel.h"
#include "core/tree_topology.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

namespace dendrofit {
namespace {

constexpr double kOnMask = 0.7;     // pixels
constexpr double kFaint = 0.25;     // of a pixel covered: wood too thin for the mask
constexpr double kBeside = 1;       // pixels about a cylinder that it explains
constexpr int kSamples = 5;         // a step, a pixel apart
constexpr double kStretch = 0.6;    // of a step's samples that must be wood, for the view to show it
constexpr double kViews = 1.0 / 3;  // that must show a step
constexpr double kSolid = 0.75;     // that show wood of a pixel or more
constexpr double kFarthest = 0.3;   // metres
constexpr double kShortest = 3;     // pixels: less is no news
constexpr double kTwigPx = 0.3;     // radius of wood that shows as dots
constexpr int kRings = 3;           // of directions about straight ahead
constexpr double kRing = 13 * std::numbers::pi / 180;

/// Wood in one view's picture that no cylinder explains.
class LooseWood {
 public:
  LooseWood(const Tree& tree, const Camera& camera, const Outline& outline)
      : camera_(camera),
        outline_(outline),
        explained_(static_cast<std::size_t>(outline.width()) * static_cast<std::size_t>(outline.height()),
                   0) {
    for (std::size_t i = 0; i < tree.size(); ++i) explain(tree.start[i], tree.end[i], tree.radius[i]);
  }
  enum class Answer { unknown, no, yes };
  Answer at(const Vec3& place) const {
    const auto pixel = camera_.project(place);
    if (!pixel) return Answer::no;
    if (outline_.unknown(*pixel)) return Answer::unknown;
    if (!outline_.holds(*pixel)) return Answer::no;
    const int x = std::min(outline_.width() - 1, static_cast<int>(pixel->x()));
    const int y = std::min(outline_.height() - 1, static_cast<int>(pixel->y()));
    if (explained_[index(x, y)]) return Answer::no;
    const bool wood =
        outline_.at(*pixel) <= kOnMask || (outline_.knows_cover() && outline_.cover_at(*pixel) >= kFaint);
    return wood ? Answer::yes : Answer::no;
  }

 private:
  std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(outline_.width()) +
           static_cast<std::size_t>(x);
  }
  void explain(const Vec3& start, const Vec3& end, double radius) {
    const auto a = camera_.project(start), b = camera_.project(end);
    if (!a || !b) return;
    const double reach = radius * camera_.fx / camera_.depth(0.5 * (start + end)) + kBeside;
    const Eigen::Vector2d lo = a->cwiseMin(*b).array() - reach, hi = a->cwiseMax(*b).array() + reach;
    const Eigen::Vector2d run = *b - *a;
    const double square = std::max(1e-12, run.squaredNorm());
    // Square ends (what lies beyond the tip is not explained by it), seen as discs from below and above.
    const Vec3 along = end - start, look = 0.5 * (start + end) - camera_.centre();
    const double tilt = std::abs(along.normalized().dot(look.normalized()));
    const double disc = (tilt * reach + kBeside) / std::sqrt(square);
    for (int y = std::max(0, static_cast<int>(lo.y())); y <= std::min<double>(outline_.height() - 1, hi.y());
         ++y)
      for (int x = std::max(0, static_cast<int>(lo.x())); x <= std::min<double>(outline_.width() - 1, hi.x());
           ++x) {
        const Eigen::Vector2d p(x + 0.5, y + 0.5);
        const double t = (p - *a).dot(run) / square;
        if (t < -disc || t > 1 + disc) continue;
        if ((*a + t * run - p).squaredNorm() <= reach * reach) explained_[index(x, y)] = 1;
      }
  }
  const Camera& camera_;
  const Outline& outline_;
  std::vector<char> explained_;
};

struct Step {
  Vec3 direction;
  double score = 0;
  int reached = 0;     ///< samples
  bool solid = false;  ///< most views show it: no twig in dots
};

/// A point on the way on from a tip.
struct Mark {
  Vec3 at;
  bool solid = false;
};

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

/// What the views say of the way from `from` along `direction`; score 0 where too few show it.
Step look(const std::vector<LooseWood>& views, const Vec3& from, const Vec3& direction, double pixel_m) {
  Step step{direction};
  int asked = 0, shown = 0;
  double sum = 0;
  std::array<int, kSamples> seen{};
  for (const LooseWood& view : views) {
    std::array<bool, kSamples> here{};
    int wood = 0;
    bool known = true;
    for (int k = 0; k < kSamples && known; ++k) {
      const auto answer = view.at(from + (k + 1) * pixel_m * direction);
      known = answer != LooseWood::Answer::unknown;
      here[static_cast<std::size_t>(k)] = answer == LooseWood::Answer::yes;
      wood += answer == LooseWood::Answer::yes;
    }
    if (!known) continue;
    ++asked;
    if (wood < kStretch * kSamples) continue;
    ++shown;
    sum += static_cast<double>(wood) / kSamples;
    for (std::size_t k = 0; k < here.size(); ++k) seen[k] += here[k];
  }
  const int least = std::max(std::min(asked, 3), static_cast<int>(std::ceil(kViews * asked)));
  if (shown < 2 || shown < least) return step;
  step.score = sum;
  step.solid = shown >= kSolid * asked;
  for (int k = 0; k < kSamples; ++k)
    if (2 * seen[static_cast<std::size_t>(k)] >= shown) step.reached = k + 1;
  return step;
}

/// The best way on from a tip, straight ahead or bent.
Step best_step(const std::vector<LooseWood>& views, const Vec3& from, const Vec3& ahead, double pixel_m) {
  Step best = look(views, from, ahead, pixel_m);
  const Vec3 e = ahead.unitOrthogonal(), f = ahead.cross(e);
  for (int ring = 1; ring <= kRings; ++ring)
    for (int k = 0; k < 6 * ring; ++k) {
      const double turn = 2 * std::numbers::pi * k / (6 * ring), bend = ring * kRing;
      const Vec3 direction =
          std::cos(bend) * ahead + std::sin(bend) * (std::cos(turn) * e + std::sin(turn) * f);
      Step step = look(views, from, direction, pixel_m);
      step.score *= std::cos(0.5 * bend);
      if (step.score > best.score) best = step;
    }
  return best;
}

/// The way on from a tip: the points after it, one for each straight stretch.
std::vector<Mark> way_on(const std::vector<LooseWood>& views, Vec3 from, Vec3 ahead, double pixel_m,
                         double most) {
  std::vector<Mark> way;
  double gone = 0;
  while (gone < most) {
    const Step step = best_step(views, from, ahead, pixel_m);
    if (step.reached == 0) break;
    from += step.reached * pixel_m * step.direction;
    gone += step.reached * pixel_m;
    if (!way.empty() && step.direction == ahead && step.solid == way.back().solid)
      way.back().at = from;
    else
      way.push_back({from, step.solid});
    if (step.reached < kSamples) break;
    ahead = step.direction;
  }
  if (gone < kShortest * pixel_m) way.clear();
  return way;
}

}  // namespace

void extend_tips(Tree& tree, const std::vector<Camera>& cameras, const std::vector<Outline>& outlines,
                 int threads) {
  std::vector<LooseWood> views;
  for (std::size_t v = 0; v < cameras.size(); ++v) views.emplace_back(tree, cameras[v], outlines[v]);
  const std::vector<Axis> axes = axes_of(tree);
  std::vector<double> pixel(axes.size(), 0);
  std::vector<std::vector<Mark>> ways(axes.size());
  parallel_blocks(axes.size(), 8, threads, [&](std::size_t first, std::size_t end) {
    for (std::size_t a = first; a < end; ++a) {
      const Vec3 from = tree.end[static_cast<std::size_t>(axes[a].nodes.back())];
      pixel[a] = std::numeric_limits<double>::infinity();
      for (const Camera& camera : cameras)
        if (camera.depth(from) > 0) pixel[a] = std::min(pixel[a], camera.depth(from) / camera.fx);
      if (std::isfinite(pixel[a]))
        ways[a] =
            way_on(views, from, last_direction(tree, axes[a]), pixel[a], std::min(kFarthest, axes[a].length));
    }
  });
  for (std::size_t a = 0; a < axes.size(); ++a) {
    auto tip = static_cast<std::size_t>(axes[a].nodes.back());
    for (const Mark& mark : ways[a]) {
      TreeNode node = tree.node(tip);
      node.start = tree.end[tip];
      node.end = mark.at;
      node.parent = static_cast<std::int32_t>(tip);
      if (!mark.solid) node.radius = std::min(node.radius, kTwigPx * pixel[a]);
      node.quality = RadiusQuality::extrapolated;
      tip = static_cast<std::size_t>(tree.add(node));
    }
  }
}

}  // namespace dendrofit
