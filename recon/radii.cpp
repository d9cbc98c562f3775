// SPDX-License-Identifier: GPL-3.0-or-later
#include "recon/radii.h"

#include "core/errors.h"
#include "core/parallel.h"
#include "recon/cylinder_fit.h"

#include <algorithm>
#include <cmath>

namespace dendrofit {
namespace {

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

struct Moments {
  Eigen::Vector2d mean{0, 0};
  double square = 0;  // mean squared distance from the mean, unbiased
  std::size_t count = 0;
};

Moments robust_moments(const std::vector<Eigen::Vector2d>& flat) {
  Moments m;
  if (flat.size() < 3) return m;
  std::vector<double> distance(flat.size());
  double limit = 1e300;
  for (int pass = 0; pass < 3; ++pass) {
    Eigen::Vector2d sum(0, 0);
    std::size_t count = 0;
    for (const auto& p : flat)
      if ((p - m.mean).norm() <= limit) {
        sum += p;
        ++count;
      }
    if (count < 3) break;
    m.mean = sum / static_cast<double>(count);
    m.count = count;
    for (std::size_t i = 0; i < flat.size(); ++i) distance[i] = (flat[i] - m.mean).norm();
    std::vector<double> sorted = distance;
    std::nth_element(sorted.begin(), sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2),
                     sorted.end());
    limit = 2.5 * sorted[sorted.size() / 2];
  }
  double sum = 0;
  std::size_t count = 0;
  for (const double d : distance)
    if (d <= limit) {
      sum += d * d;
      ++count;
    }
  if (count >= 3) m.square = sum / static_cast<double>(count - 1);
  m.count = count;
  return m;
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

}  // namespace

void RadiusOptions::validate() const {
  if (twig_diameter_m)
    require(std::isfinite(*twig_diameter_m) && *twig_diameter_m > 0 && *twig_diameter_m < 0.1,
            "twig_diameter_m", *twig_diameter_m, "must lie between 0 and 0.1 m");
}

double Allometry::radius_at(double beyond_m) const {
  return std::max(tip_radius_m, scale * std::pow(std::max(beyond_m, 1e-3), exponent));
}

RadiusReport measure_radii(const std::vector<Vec3>& points, std::vector<Limb>& limbs,
                           const RadiusOptions& options, Progress& progress) {
  options.validate();
  RadiusReport report;
  const double tip_radius = options.twig_diameter_m ? 0.5 * *options.twig_diameter_m : 0.0015;
  report.allometry.tip_radius_m = tip_radius;
  progress.begin("radii", static_cast<double>(limbs.size()), "limbs");

  // 1. Noise and footprint: on the thinnest twigs the spread of points is theirs alone.
  {
    std::vector<double> spread;
    View view;
    for (const Limb& limb : limbs) {
      if (limb.nodes.size() < 3) continue;
      const std::size_t tip = limb.nodes.size() - 2;
      look(points, limb, tip, 0.03, view);
      const Moments m = robust_moments(view.flat);
      if (m.count >= 6) spread.push_back(std::sqrt(m.square));
    }
    if (spread.size() >= 10) {
      const double typical = median(spread);
      report.noise_m = std::sqrt(std::max(0.0, typical * typical - tip_radius * tip_radius) / 2);
    }
    report.noise_m = std::clamp(report.noise_m, 0.0005, 0.02);
  }
  const double noise = report.noise_m;

  // 2. Circles, twice: the first moves the centre lines, the second measures about them.
  for (int round = 0; round < 2; ++round) {
    parallel_blocks(limbs.size(), 64, options.threads, [&](std::size_t first, std::size_t last) {
      progress.check();
      View view;
      std::vector<Vec3> moved;
      for (std::size_t l = first; l < last; ++l) {
        Limb& limb = limbs[l];
        moved.clear();
        for (std::size_t i = 0; i < limb.nodes.size(); ++i) {
          LimbNode& node = limb.nodes[i];
          moved.push_back(node.centre);
          node.measured = false;
          look(points, limb, i, std::max(0.03, 0.6 * node.rough_radius_m), view);
          if (view.flat.size() < 8) continue;
          const Moments m = robust_moments(view.flat);
          const double plain = std::sqrt(std::max(0.0, m.square - 2 * noise * noise));
          CircleFit fit = algebraic_circle(view.flat);
          const bool ring =
              fit.ok && fit.radius < 1.5 * std::sqrt(m.square) + noise && fit.radius > 2.5 * noise;
          if (ring) fit = robust_circle(view.flat, fit, noise);
          if (ring && fit.ok && fit.coverage >= 0.3 && fit.radius > 2.5 * noise &&
              fit.radius < 2.2 * std::max(node.rough_radius_m, noise) + noise) {
            node.radius_m = fit.radius - noise * noise / (2 * fit.radius);
            node.radius_se_m = std::hypot(fit.radius_se, 0.15 * noise);
            node.coverage = fit.coverage;
            node.measured = true;
            moved.back() = node.centre + fit.centre.x() * view.u + fit.centre.y() * view.v;
          } else if (m.count >= 8 && std::sqrt(m.square) < 6 * noise) {
            node.radius_m = std::max(plain, tip_radius);
            node.radius_se_m = std::max(
                0.2 * noise, m.square / (std::sqrt(static_cast<double>(m.count)) * 2 * node.radius_m));
            node.coverage = 1;
            node.measured = true;
            moved.back() = node.centre + m.mean.x() * view.u + m.mean.y() * view.v;
          }
        }
        if (round == 0)
          for (std::size_t i = 0; i < limb.nodes.size(); ++i) {
            if (i + 1 == limb.nodes.size()) break;  // tips stay
            limb.nodes[i].centre = moved[i];
          }
      }
    });
    measure_lengths(limbs);
  }

  // 3. The tree's own allometry from the measured radii that are thick enough to be sure of.
  const auto beyond = beyond_nodes(limbs);
  {
    double sw = 0, sx = 0, sy = 0, sxx = 0, sxy = 0;
    for (int pass = 0; pass < 3; ++pass) {
      const Allometry before = report.allometry;
      sw = sx = sy = sxx = sxy = 0;
      double squares = 0;
      report.allometry.places = 0;
      for (std::size_t l = 0; l < limbs.size(); ++l)
        for (std::size_t i = 0; i < limbs[l].nodes.size(); ++i) {
          const LimbNode& n = limbs[l].nodes[i];
          if (!n.measured || n.radius_m < 1.5 * noise || beyond[l][i] < 0.05) continue;
          const double x = std::log(beyond[l][i]), y = std::log(n.radius_m);
          const double residual = pass == 0 ? 0 : y - std::log(before.radius_at(beyond[l][i]));
          if (std::abs(residual) > 3 * before.spread) continue;
          const double w = 1 / (0.05 + std::pow(n.radius_se_m / n.radius_m, 2));
          sw += w;
          sx += w * x;
          sy += w * y;
          sxx += w * x * x;
          sxy += w * x * y;
          squares += w * residual * residual;
          ++report.allometry.places;
        }
      const double det = sw * sxx - sx * sx;
      if (report.allometry.places < 10 || !(det > 1e-9 * sw * sw)) break;
      report.allometry.exponent = std::clamp((sw * sxy - sx * sy) / det, 0.25, 1.2);
      report.allometry.scale = std::exp((sy - report.allometry.exponent * sx) / sw);
      if (pass > 0) report.allometry.spread = std::clamp(std::sqrt(squares / sw), 0.1, 0.8);
    }
    if (report.allometry.places < 10) report.allometry.scale = 0;
  }

  // 4. Every place: what was measured, weighed against the allometry, falling towards the tip.
  std::vector<double> radius, weight;
  for (std::size_t l = 0; l < limbs.size(); ++l) {
    Limb& limb = limbs[l];
    radius.clear();
    weight.clear();
    std::size_t last_measured = 0, first_measured = limb.nodes.size();
    for (std::size_t i = 0; i < limb.nodes.size(); ++i)
      if (limb.nodes[i].measured) {
        last_measured = i;
        first_measured = std::min(first_measured, i);
      }
    for (std::size_t i = 0; i < limb.nodes.size(); ++i) {
      LimbNode& n = limb.nodes[i];
      const double expected = report.allometry.scale > 0 ? report.allometry.radius_at(beyond[l][i])
                                                         : std::max(tip_radius, n.rough_radius_m);
      const double expected_se = report.allometry.spread * expected;
      if (n.measured) {
        const double a = 1 / (n.radius_se_m * n.radius_se_m), b = 0.25 / (expected_se * expected_se);
        radius.push_back((a * n.radius_m + b * expected) / (a + b));
        weight.push_back(a + b);
        n.quality = RadiusQuality::measured;
      } else {
        radius.push_back(expected);
        weight.push_back(0.01 / (expected_se * expected_se));
        n.quality =
            i > first_measured && i < last_measured ? RadiusQuality::interpolated : RadiusQuality::allometric;
      }
    }
    // Between measured places: along the line between them.
    for (std::size_t i = first_measured; i < last_measured; ++i) {
      if (!limb.nodes[i].measured) continue;
      std::size_t j = i + 1;
      while (!limb.nodes[j].measured) ++j;
      for (std::size_t k = i + 1; k < j; ++k) {
        const double t = (limb.nodes[k].along_m - limb.nodes[i].along_m) /
                         std::max(1e-9, limb.nodes[j].along_m - limb.nodes[i].along_m);
        radius[k] = (1 - t) * radius[i] + t * radius[j];
      }
      i = j - 1;
    }
    make_falling(radius, weight);
    double most = 1e300;
    if (limb.parent >= 0) {
      const auto& bearer =
          limbs[static_cast<std::size_t>(limb.parent)].nodes[static_cast<std::size_t>(limb.parent_node)];
      most = bearer.radius_m;
    }
    for (std::size_t i = 0; i < limb.nodes.size(); ++i) {
      LimbNode& n = limb.nodes[i];
      n.radius_m = std::clamp(radius[i], std::min(tip_radius, most), std::max(most, 1e-4));
      n.radius_se_m = 1 / std::sqrt(weight[i]);
    }
  }
  progress.end();
  return report;
}

}  // namespace dendrofit
