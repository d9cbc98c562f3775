// SPDX-License-Identifier: GPL-3.0-or-later
#include "recon/radii.h"

#include "core/errors.h"
#include "core/parallel.h"
#include "recon/cylinder_fit.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

namespace dendrofit {
namespace {

constexpr double kShortestWindow = 0.03;  // half the length along which points are seen together, metres
constexpr double kLongestWindow = 0.10;
constexpr std::size_t kEnoughPoints = 14;
constexpr std::size_t kFewestPoints = 6;
constexpr double kNoiseDoubt = 0.15;          // relative, of the noise's variance
constexpr double kUsualTwigDiameter = 0.003;  // of broadleaves' last shoots

/// The points about one node, seen along the centre line.
struct View {
  std::vector<Eigen::Vector2d> flat;
  Vec3 u, v;
};

void look(const std::vector<Vec3>& points, const Limb& limb, std::size_t node, double half_window,
          View& view) {
  view.flat.clear();
  plane_frame(direction_at(limb, node), view.u, view.v);
  const double here = limb.nodes[node].along_m;
  const auto add = [&](std::size_t j) {
    const LimbNode& n = limb.nodes[j];
    const Vec3 direction = direction_at(limb, j);
    for (const std::uint32_t p : n.points) {
      Vec3 d = points[p] - n.centre;
      d -= direction * d.dot(direction);  // the line's own bends do not widen the wood
      view.flat.emplace_back(d.dot(view.u), d.dot(view.v));
    }
  };
  add(node);
  for (std::size_t j = node; j-- > 0 && here - limb.nodes[j].along_m <= half_window;) add(j);
  for (std::size_t j = node + 1; j < limb.nodes.size() && limb.nodes[j].along_m - here <= half_window; ++j)
    add(j);
}

/// Where the points' middle lies and how far from it they are. Medians, because side twigs cross every view.
struct Spread {
  Eigen::Vector2d middle{0, 0};
  double square = 0;  // median squared distance from the middle, corrected for the middle being their own
  std::size_t count = 0;
};

Spread spread_of(const std::vector<Eigen::Vector2d>& flat, std::vector<double>& scratch) {
  Spread spread;
  if (flat.size() < 4) return spread;
  double limit = 1e300;
  for (int pass = 0; pass < 3; ++pass) {
    Eigen::Vector2d sum(0, 0);
    std::size_t count = 0;
    for (const auto& p : flat)
      if ((p - spread.middle).squaredNorm() <= limit) {
        sum += p;
        ++count;
      }
    if (count < 3) break;
    spread.middle = sum / static_cast<double>(count);
    spread.count = count;
    scratch.clear();
    for (const auto& p : flat) scratch.push_back((p - spread.middle).squaredNorm());
    const auto half = scratch.begin() + static_cast<std::ptrdiff_t>(scratch.size() / 2);
    std::nth_element(scratch.begin(), half, scratch.end());
    limit = 5 * *half;
    spread.square = *half;
  }
  const auto n = static_cast<double>(spread.count);
  spread.square *= n / (n - 1);
  return spread;
}

double median(std::vector<double> values) {
  if (values.empty()) return 0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// Wood length beyond every node.
std::vector<std::vector<double>> beyond_nodes(const std::vector<Limb>& limbs) {
  std::vector<std::vector<double>> beyond(limbs.size());
  for (std::size_t l = 0; l < limbs.size(); ++l) beyond[l].assign(limbs[l].nodes.size(), 0);
  for (std::size_t l = limbs.size(); l-- > 0;) {
    const Limb& limb = limbs[l];
    for (std::size_t i = limb.nodes.size(); i-- > 1;)
      beyond[l][i - 1] += beyond[l][i] + limb.nodes[i].along_m - limb.nodes[i - 1].along_m;
    if (limb.parent >= 0)
      beyond[static_cast<std::size_t>(limb.parent)][static_cast<std::size_t>(limb.parent_node)] +=
          beyond[l].front();
  }
  return beyond;
}

/// Pool-adjacent-violators: the non-increasing sequence nearest to `value` (weighted squares).
void make_falling(std::vector<double>& value, const std::vector<double>& weight) {
  struct Block {
    double sum, weight;
    std::size_t count;
  };
  std::vector<Block> blocks;
  for (std::size_t i = 0; i < value.size(); ++i) {
    blocks.push_back({value[i] * weight[i], weight[i], 1});
    while (blocks.size() > 1) {
      const Block& b = blocks.back();
      Block& a = blocks[blocks.size() - 2];
      if (a.sum / a.weight >= b.sum / b.weight) break;
      a.sum += b.sum;
      a.weight += b.weight;
      a.count += b.count;
      blocks.pop_back();
    }
  }
  std::size_t i = 0;
  for (const Block& b : blocks)
    for (std::size_t k = 0; k < b.count; ++k) value[i++] = b.sum / b.weight;
}

/// The radius squared that a median spread means, once noise is taken off (Rayleigh: the median of a squared
/// distance under isotropic noise alone is 2 ln 2 variances), with its standard error.
struct Square {
  double value = 0, se = 0;
};

Square radius_squared(const Spread& spread, double noise) {
  const double variance = noise * noise;
  const double value = spread.square - 2 * std::numbers::ln2 * variance;
  const double r2 = std::max(value, 0.0);
  const double scatter =
      std::sqrt((4 * r2 * variance + 4 * variance * variance) / static_cast<double>(spread.count));
  return {value, std::hypot(1.25 * scatter, kNoiseDoubt * 2 * std::numbers::ln2 * variance)};
}

/// How a place is seen: its circle if there is one, its spread in any case.
struct Sight {
  Spread spread;
  CircleFit circle;
};

using NodeValues = std::vector<std::vector<double>>;

/// Looks at every place; half windows grow until enough points are seen.
void see_all(const std::vector<Vec3>& points, std::vector<Limb>& limbs, double noise, int threads, bool move,
             std::vector<std::vector<Sight>>& sights, Progress& progress) {
  parallel_blocks(limbs.size(), 64, threads, [&](std::size_t first, std::size_t last) {
    progress.check();
    View view;
    std::vector<double> scratch;
    std::vector<Vec3> moved;
    for (std::size_t l = first; l < last; ++l) {
      Limb& limb = limbs[l];
      sights[l].assign(limb.nodes.size(), {});
      moved.clear();
      for (std::size_t i = 0; i < limb.nodes.size(); ++i) {
        const LimbNode& node = limb.nodes[i];
        moved.push_back(node.centre);
        double window = std::max(kShortestWindow, 0.6 * node.rough_radius_m);
        look(points, limb, i, window, view);
        for (; view.flat.size() < kEnoughPoints && window < kLongestWindow; window *= 1.5)
          look(points, limb, i, 1.5 * window, view);
        if (view.flat.size() < kFewestPoints) continue;
        Sight& sight = sights[l][i];
        sight.spread = spread_of(view.flat, scratch);
        const double apparent = std::sqrt(sight.spread.square);
        Eigen::Vector2d centre = sight.spread.middle;
        if (node.rough_radius_m > 2 * noise && view.flat.size() >= kEnoughPoints) {
          CircleFit fit = algebraic_circle(view.flat);
          if (fit.ok && fit.radius < 2.5 * std::max(apparent, node.rough_radius_m)) {
            fit = robust_circle(view.flat, fit, noise);
            const bool sound = fit.ok && fit.coverage >= 0.3 && fit.radius > 2.5 * noise &&
                               fit.rms < 0.5 * fit.radius && 2 * fit.inliers >= view.flat.size() &&
                               fit.radius < 2.2 * node.rough_radius_m + noise;
            if (sound) {
              sight.circle = fit;
              centre = fit.centre;
            }
          }
        }
        moved.back() = node.centre + centre.x() * view.u + centre.y() * view.v;
      }
      if (move)
        for (std::size_t i = 0; i + 1 < limb.nodes.size(); ++i) limb.nodes[i].centre = moved[i];  // tips stay
    }
  });
}

/// Noise and footprint from the thinnest twigs, where nearly all spread is theirs; thick wood, where the
/// scatter about the circles is range noise alone, bounds it.
double find_noise(const std::vector<Limb>& limbs, const NodeValues& beyond,
                  const std::vector<std::vector<Sight>>& sights, double tip_radius, double fallback) {
  std::vector<double> twigs, stems;
  for (std::size_t l = 0; l < limbs.size(); ++l)
    for (std::size_t i = 0; i < limbs[l].nodes.size(); ++i) {
      const Sight& s = sights[l][i];
      if (s.circle.ok && s.circle.radius > 0.03 && s.circle.coverage > 0.5) stems.push_back(s.circle.rms);
      if (s.spread.count >= kFewestPoints && beyond[l][i] > 0.04 && beyond[l][i] < 0.4 && !s.circle.ok)
        twigs.push_back(s.spread.square);
    }
  double noise = fallback;
  if (twigs.size() >= 20)
    noise = std::sqrt(std::max(0.0, median(twigs) - 1.5 * tip_radius * tip_radius) / (2 * std::numbers::ln2));
  else if (stems.size() >= 10)
    noise = median(stems);
  if (stems.size() >= 10) noise = std::min(noise, 1.7 * median(stems));
  return std::clamp(noise, 0.0005, 0.05);
}

/// The tree's own radius for a given wood length beyond: medians in classes of length (so that noise in
/// single places averages out and none is selected by its size), then a line through them in logarithms.
Allometry fit_allometry(const std::vector<Limb>& limbs, const NodeValues& beyond,
                        const std::vector<std::vector<Sight>>& sights, double noise, double tip_radius) {
  constexpr double kClass = 0.5;  // in natural logarithms of length
  Allometry allometry;
  allometry.tip_radius_m = tip_radius;
  std::map<int, std::vector<double>> classes;
  const auto square_of = [&](const Sight& s) {
    return s.circle.ok ? s.circle.radius * s.circle.radius - noise * noise
                       : radius_squared(s.spread, noise).value;
  };
  for (std::size_t l = 0; l < limbs.size(); ++l)
    for (std::size_t i = 0; i < limbs[l].nodes.size(); ++i)
      if (sights[l][i].spread.count >= kFewestPoints && beyond[l][i] > 0.05)
        classes[static_cast<int>(std::floor(std::log(beyond[l][i]) / kClass))].push_back(
            square_of(sights[l][i]));
  double sw = 0, sx = 0, sy = 0, sxx = 0, sxy = 0;
  const auto add = [&](double w, double x, double y) {
    sw += w;
    sx += w * x;
    sy += w * y;
    sxx += w * x * x;
    sxy += w * x * y;
  };
  for (auto& [index, squares] : classes) {
    if (squares.size() < 5) continue;
    const double r2 = median(squares);
    if (r2 < 0.5 * noise * noise) continue;  // noise alone
    allometry.places += squares.size();
    add(std::sqrt(static_cast<double>(std::min<std::size_t>(squares.size(), 100))), (index + 0.5) * kClass,
        0.5 * std::log(r2));
  }
  if (allometry.places < 20) return allometry;
  add(5, std::log(0.05), std::log(tip_radius));  // a twig's last five centimetres
  const double det = sw * sxx - sx * sx;
  if (!(det > 1e-9 * sw * sw)) return allometry;
  allometry.exponent = std::clamp((sw * sxy - sx * sy) / det, 0.25, 1.0);
  allometry.scale = std::exp((sy - allometry.exponent * sx) / sw);
  std::vector<double> off;
  for (std::size_t l = 0; l < limbs.size(); ++l)
    for (std::size_t i = 0; i < limbs[l].nodes.size(); ++i) {
      const double expected = allometry.radius_at(beyond[l][i]);
      if (sights[l][i].spread.count < kFewestPoints || expected < 1.5 * noise) continue;
      off.push_back(std::abs(0.5 * std::log(std::max(square_of(sights[l][i]), 1e-8)) - std::log(expected)));
    }
  if (off.size() >= 20) allometry.spread = std::clamp(1.4826 * median(off), 0.15, 0.6);
  return allometry;
}

/// One limb's radii from what was seen and what the tree's allometry expects, falling towards the tip.
void settle(Limb& limb, const std::vector<double>& beyond, const std::vector<Sight>& sights,
            const Allometry& allometry, double noise, double bearer_radius) {
  const std::size_t n = limb.nodes.size();
  std::vector<double> radius(n), weight(n);
  std::vector<char> seen(n, 0);
  std::size_t first = n, last = 0;
  for (std::size_t i = 0; i < n; ++i) {
    LimbNode& node = limb.nodes[i];
    const double expected = allometry.scale > 0 ? allometry.radius_at(beyond[i])
                                                : std::max(allometry.tip_radius_m, node.rough_radius_m);
    const double doubt = std::max(allometry.spread, 0.1) * expected;
    const Sight& s = sights[i];
    radius[i] = expected;
    weight[i] = 1 / (doubt * doubt);
    node.measured = false;
    if (s.circle.ok) {
      const double r = s.circle.radius - noise * noise / (2 * s.circle.radius);
      const double se = std::hypot(s.circle.radius_se, 0.1 * noise) / std::sqrt(s.circle.coverage);
      const double w = 1 / (se * se);
      radius[i] = (w * r + 0.2 * weight[i] * expected) / (w + 0.2 * weight[i]);
      weight[i] = w + 0.2 * weight[i];
      node.coverage = s.circle.coverage;
      seen[i] = 1;
    } else if (s.spread.count >= kFewestPoints) {
      const Square square = radius_squared(s.spread, noise);
      const double doubt2 = 2 * doubt * expected;  // of the expected square
      const double a = 1 / (square.se * square.se), b = 1 / (doubt2 * doubt2);
      const double r2 = std::max((a * square.value + b * expected * expected) / (a + b),
                                 allometry.tip_radius_m * allometry.tip_radius_m);
      radius[i] = std::sqrt(r2);
      const double se = 1 / std::sqrt(a + b) / (2 * radius[i]);
      weight[i] = 1 / (se * se);
      seen[i] = a > b;  // the points say more than the expectation
    }
    if (seen[i]) {
      first = std::min(first, i);
      last = i;
    }
    node.measured = seen[i] != 0;
  }
  for (std::size_t i = 0; i < n; ++i) {
    if (seen[i])
      limb.nodes[i].quality = RadiusQuality::measured;
    else
      limb.nodes[i].quality = i > first && i < last ? RadiusQuality::interpolated : RadiusQuality::allometric;
  }
  for (std::size_t i = first; i < last; ++i) {  // between measured places: along the line between them
    if (!seen[i]) continue;
    std::size_t j = i + 1;
    while (!seen[j]) ++j;
    for (std::size_t k = i + 1; k < j; ++k) {
      const double t = (limb.nodes[k].along_m - limb.nodes[i].along_m) /
                       std::max(1e-9, limb.nodes[j].along_m - limb.nodes[i].along_m);
      radius[k] = (1 - t) * radius[i] + t * radius[j];
      weight[k] = 0.25 * std::min(weight[i], weight[j]);
    }
    i = j - 1;
  }
  make_falling(radius, weight);
  const double least = std::min(allometry.tip_radius_m, bearer_radius);
  for (std::size_t i = 0; i < n; ++i) {
    limb.nodes[i].radius_m = std::clamp(radius[i], least, std::max(bearer_radius, 1e-4));
    limb.nodes[i].radius_se_m = 1 / std::sqrt(weight[i]);
  }
}

}  // namespace

void RadiusOptions::validate() const {
  if (twig_diameter_m)
    require(std::isfinite(*twig_diameter_m) && *twig_diameter_m > 0 && *twig_diameter_m < 0.1,
            "twig_diameter_m", *twig_diameter_m, "must lie between 0 and 0.1 m");
}

double Allometry::radius_at(double beyond_m) const {
  return std::max(tip_radius_m, scale * std::pow(std::max(beyond_m, 1e-3), exponent));
}

RadiusReport measure_radii(const std::vector<Vec3>& points, std::vector<Limb>& limbs, double spacing_m,
                           const RadiusOptions& options, Progress& progress) {
  options.validate();
  RadiusReport report;
  const double tip_radius = 0.5 * options.twig_diameter_m.value_or(kUsualTwigDiameter);
  progress.begin("radii", static_cast<double>(limbs.size()), "limbs");
  std::vector<std::vector<Sight>> sights(limbs.size());
  report.noise_m = std::clamp(0.25 * spacing_m, 0.001, 0.02);
  for (const bool move : {true, false}) {
    see_all(points, limbs, report.noise_m, options.threads, move, sights, progress);
    if (move) {
      smooth_limbs(limbs);
      measure_lengths(limbs);
    }
    report.noise_m = find_noise(limbs, beyond_nodes(limbs), sights, tip_radius, report.noise_m);
  }
  const NodeValues beyond = beyond_nodes(limbs);
  report.allometry = fit_allometry(limbs, beyond, sights, report.noise_m, tip_radius);
  for (std::size_t l = 0; l < limbs.size(); ++l) {
    const Limb& limb = limbs[l];
    const double bearer = limb.parent < 0 ? 1e300
                                          : limbs[static_cast<std::size_t>(limb.parent)]
                                                .nodes[static_cast<std::size_t>(limb.parent_node)]
                                                .radius_m;
    settle(limbs[l], beyond[l], sights[l], report.allometry, report.noise_m, bearer);
  }
  progress.end();
  return report;
}

}  // namespace dendrofit
