// SPDX-License-Identifier: GPL-3.0-or-later
#include "recon/radii.h"

#include "core/errors.h"
#include "recon/taper.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

namespace dendrofit {
namespace {

constexpr double kBestShare = 0.05;
constexpr double kNoiseDoubt = 0.15;          // relative, of the noise's variance
constexpr double kUsualTwigDiameter = 0.003;  // of broadleaves' last shoots

double median(std::vector<double> values) {
  if (values.empty()) return 0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// Wood length beyond every node.
using NodeValues = std::vector<std::vector<double>>;

NodeValues beyond_nodes(const std::vector<Limb>& limbs) {
  NodeValues beyond(limbs.size());
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

/// Mean square distances of the points about thin twigs from their middles.
std::vector<double> twig_squares(const std::vector<Limb>& limbs, const NodeValues& beyond,
                                 const Sights& sights) {
  constexpr double kTip = 0.04, kTwig = 0.4;  // metres of wood beyond
  std::vector<double> squares;
  for (std::size_t l = 0; l < limbs.size(); ++l)
    for (std::size_t i = 0; i < limbs[l].nodes.size(); ++i) {
      const Sight& s = sights[l][i];
      if (s.spread.count > 0 && beyond[l][i] > kTip && beyond[l][i] < kTwig && !s.circle.ok)
        squares.push_back(s.spread.square);
    }
  return squares;
}

constexpr double kThinnest = 3.5, kThickest = 8;  // branches whose circles tell of noise, radii in noises

/// Radius of the scanner's beams where they meet wood; 0 where nothing tells. Of the beams that meet wood of
/// radius R, w / (R + w) graze it and are recorded up to their radius w beside it, w^2 / 3 in mean square:
/// circles' scatter grows towards thin wood by w^3 / 3 over the radius, where range noise alone stays the
/// same. Twigs must tell of much the same beam (`twigs`: their median mean square distance): where they
/// spread farther, wood is not round or sections hold more than one limb.
double beam_radius(const Sights& sights, double noise, double twigs) {
  constexpr std::size_t kFewest = 50;
  constexpr double kMuchTheSame = 2;
  constexpr double kBranch = 3 * kThickest;  // thicker stems are no circles to the millimetre
  std::array<std::vector<double>, 2> square, curvature;
  for (const auto& limb : sights)
    for (const Sight& s : limb) {
      if (!s.circle.ok || s.circle.radius < kThinnest * noise || s.circle.radius > kBranch * noise) continue;
      const std::size_t k = s.circle.radius > kThickest * noise;
      square[k].push_back(s.circle.rms * s.circle.rms);
      curvature[k].push_back(1 / s.circle.radius);
    }
  if (std::min(square[0].size(), square[1].size()) < kFewest) return 0;
  const double slope =
      (median(square[0]) - median(square[1])) / (median(curvature[0]) - median(curvature[1]));
  const double beam = std::cbrt(3 * std::max(0.0, slope));
  return 0.5 * twigs > kMuchTheSame * (median(square[1]) + beam * beam / 3) ? 0 : beam;
}

/// By how much circles through noisy points are too wide, times twice their radius. Noise across the beam
/// leads points out of the wood, by half its variance over the radius on average; and beams that graze wood
/// are recorded at their own middle, beside it, which adds about half as much again (1.5 times the first in
/// median over the drawn trees' scans). Beams far wider than the noise do so by up to half their radius
/// squared.
double swell_of(const std::vector<Limb>& limbs, const NodeValues& beyond, const Sights& sights,
                double noise) {
  constexpr double kGrazing = 1.5;
  const double beam = beam_radius(sights, noise, median(twig_squares(limbs, beyond, sights)));
  return std::max(kGrazing * noise * noise, beam * beam);
}

/// The radius of the wood in a circle through noisy points.
double circle_radius(const CircleFit& circle, double swell) {
  return circle.radius - swell / (2 * circle.radius);
}

/// What a thin twig's points tell of its radius squared. Their mean square distance from the axis is the
/// radius squared and two variances of the noise (one for each direction across), whichever sides are seen;
/// about their own middle it is less by the middle's distance from the axis squared, more so the fewer sides
/// are seen.
struct Square {
  double value = 0, se = 0;
};

Square radius_squared(const Spread& spread, double noise, double seen) {
  const double variance = noise * noise;
  const double value = (spread.square - 2 * variance) / seen;
  const double r2 = std::max(value, 0.0);
  const double scatter =
      std::sqrt((4 * r2 * variance + 4 * variance * variance) / static_cast<double>(spread.count));
  return {value, std::hypot(scatter, kNoiseDoubt * 2 * variance) / seen};
}

/// The share of the radius squared that is left in thin twigs' spread about their own middle: 1 where wood is
/// seen from all sides, 0.38 from one. The same stations see thick and thin wood, so it is that of circles
/// thick enough to be fitted without bias, and no thicker than branches; but never more than thicker wood
/// shows, which clusters of twigs taken for circles might.
double seen_share(const std::vector<Limb>& limbs, const Sights& sights, double noise, double swell) {
  constexpr double kOneSide = 0.38;
  constexpr std::size_t kFewest = 20;
  std::vector<double> branches, thicker;
  for (std::size_t l = 0; l < limbs.size(); ++l)
    for (const Sight& s : sights[l]) {
      if (!s.circle.ok || s.spread.count == 0 || s.circle.radius < kThinnest * noise) continue;
      (s.circle.radius > kThickest * noise ? thicker : branches)
          .push_back((s.spread.square - 2 * noise * noise) / std::pow(circle_radius(s.circle, swell), 2));
    }
  double share = 1;
  for (const std::vector<double>* shares : {&branches, &thicker})
    if (shares->size() >= kFewest) share = std::min(share, median(*shares));
  return std::max(share, kOneSide);
}

/// The pipe relation that the stems' circles tell (Shinozaki et al. 1964): cross-sections in proportion to
/// the wood length beyond. Returns the radius that bears one metre; 0 where no stem shows a circle.
double pipe_scale(const std::vector<Limb>& limbs, const NodeValues& beyond, const Sights& sights,
                  double swell) {
  std::vector<double> scales;
  for (std::size_t l = 0; l < limbs.size(); ++l)
    for (std::size_t i = 0; limbs[l].parent < 0 && i < limbs[l].nodes.size(); ++i)
      if (sights[l][i].circle.ok && beyond[l][i] > 1)
        scales.push_back(circle_radius(sights[l][i].circle, swell) / std::sqrt(beyond[l][i]));
  return median(scales);
}

/// The tree's own radius for a given wood length beyond: medians in classes of length (so that noise in
/// single places averages out and none is selected by its size), then a line through them in logarithms.
Allometry fit_allometry(const std::vector<Limb>& limbs, const NodeValues& beyond, const Sights& sights,
                        double noise, double swell, double seen, double tip_radius) {
  constexpr double kClass = 0.5;  // in natural logarithms of length
  Allometry allometry;
  allometry.tip_radius_m = tip_radius;
  std::map<int, std::vector<double>> classes;
  const auto square_of = [&](const Sight& s) {
    return s.circle.ok ? std::pow(circle_radius(s.circle, swell), 2)
                       : radius_squared(s.spread, noise, seen).value;
  };
  for (std::size_t l = 0; l < limbs.size(); ++l)
    for (std::size_t i = 0; i < limbs[l].nodes.size(); ++i)
      if (sights[l][i].spread.count > 0 && beyond[l][i] > 0.05)
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
  // Where a scan is too sparse to tell twigs apart they seem many times as thick as the stem could feed.
  constexpr double kMostOfPipe = 3;
  const double pipe = pipe_scale(limbs, beyond, sights, swell);
  allometry.scale = pipe;
  if (allometry.places < 20) return allometry;
  add(5, std::log(0.05), std::log(tip_radius));  // a twig's last five centimetres
  const double det = sw * sxx - sx * sx;
  if (!(det > 1e-9 * sw * sw)) return allometry;
  const double exponent = std::clamp((sw * sxy - sx * sy) / det, 0.25, 1.0);
  const double scale = std::exp((sy - exponent * sx) / sw);
  if (pipe > 0 && scale > kMostOfPipe * pipe) return allometry;
  allometry.exponent = exponent;
  allometry.scale = scale;
  std::vector<double> off;
  for (std::size_t l = 0; l < limbs.size(); ++l)
    for (std::size_t i = 0; i < limbs[l].nodes.size(); ++i) {
      const double expected = allometry.radius_at(beyond[l][i]);
      if (sights[l][i].spread.count == 0 || expected < 1.5 * noise) continue;
      off.push_back(std::abs(0.5 * std::log(std::max(square_of(sights[l][i]), 1e-8)) - std::log(expected)));
    }
  if (off.size() >= 20) allometry.spread = std::clamp(1.4826 * median(off), 0.15, 0.6);
  return allometry;
}

/// One limb's radii and their weights from what was seen and what the tree's allometry expects.
void weigh(Limb& limb, const std::vector<double>& beyond, const std::vector<Sight>& sights,
           const Allometry& allometry, double noise, double swell, double seen_share,
           std::vector<double>& radius, std::vector<double>& weight) {
  const std::size_t n = limb.nodes.size();
  radius.assign(n, 0);
  weight.assign(n, 0);
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
      const double r = circle_radius(s.circle, swell);
      const double se = std::hypot(s.circle.radius_se, 0.1 * noise) / std::sqrt(s.circle.coverage);
      const double w = 1 / (se * se);
      radius[i] = (w * r + 0.2 * weight[i] * expected) / (w + 0.2 * weight[i]);
      weight[i] = w + 0.2 * weight[i];
      node.coverage = s.circle.coverage;
      seen[i] = 1;
    } else if (s.spread.count > 0) {
      const Square square = radius_squared(s.spread, noise, seen_share);
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

/// Noise and footprint from the thinnest twigs, where nearly all spread is theirs; thick wood, where the
/// scatter about the circles is range noise alone, bounds it. In leaf, what twigs show beyond thick wood is
/// the beams' width or the leaves left about them: half of it is taken for either.
double scan_noise(const std::vector<Limb>& limbs, const Sights& sights, double fallback_m,
                  const RadiusOptions& options) {
  const double tip_radius = 0.5 * options.twig_diameter_m.value_or(kUsualTwigDiameter);
  constexpr double kHalf = 0.5;  // of the girth: more is never seen from one station
  constexpr std::size_t kFewest = 5;
  const std::vector<double> twigs = twig_squares(limbs, beyond_nodes(limbs), sights);
  std::vector<double> stems, arcs;
  for (const std::vector<Sight>& limb : sights)
    for (const Sight& s : limb)
      if (s.circle.ok && s.circle.radius > 0.03)
        (s.circle.coverage > kHalf ? stems : arcs).push_back(s.circle.rms);
  if (stems.size() < kFewest) stems.insert(stems.end(), arcs.begin(), arcs.end());
  double noise = fallback_m;
  if (twigs.size() >= 20)
    noise = std::sqrt(0.5 * std::max(0.0, median(twigs) - 1.5 * tip_radius * tip_radius));
  else if (stems.size() >= kFewest)
    noise = median(stems);
  if (stems.size() >= kFewest) {
    const double thick = median(stems);
    noise = std::min(noise, 1.7 * thick);
    if (options.in_leaf && noise > thick) noise = std::sqrt(0.5 * (noise * noise + thick * thick));
  }
  return std::clamp(noise, 0.0005, 0.05);
}

RadiusReport settle_radii(std::vector<Limb>& limbs, const Sights& sights, double noise_m,
                          const RadiusOptions& options) {
  options.validate();
  RadiusReport report;
  report.noise_m = noise_m;
  const NodeValues beyond = beyond_nodes(limbs);
  const double tip_radius = 0.5 * options.twig_diameter_m.value_or(kUsualTwigDiameter);
  const double swell = swell_of(limbs, beyond, sights, noise_m);
  const double seen = seen_share(limbs, sights, noise_m, swell);
  report.allometry = fit_allometry(limbs, beyond, sights, noise_m, swell, seen, tip_radius);
  std::vector<double> value, weight, limb_radius, limb_weight;
  std::vector<std::int32_t> parent;
  std::vector<std::size_t> first(limbs.size());
  for (std::size_t l = 0; l < limbs.size(); ++l) {
    weigh(limbs[l], beyond[l], sights[l], report.allometry, noise_m, swell, seen, limb_radius, limb_weight);
    first[l] = value.size();
    for (std::size_t i = 0; i < limb_radius.size(); ++i) {
      const auto here = static_cast<std::int32_t>(value.size());
      if (i > 0)
        parent.push_back(here - 1);
      else
        parent.push_back(limbs[l].parent < 0
                             ? -1
                             : static_cast<std::int32_t>(first[static_cast<std::size_t>(limbs[l].parent)]) +
                                   limbs[l].parent_node);
      // No single place is believed to better than a twentieth: bark, burls and crotches.
      const double doubt = kBestShare * limb_radius[i];
      value.push_back(limb_radius[i]);
      limbs[l].nodes[i].seen_radius_m = limb_radius[i];
      weight.push_back(1 / (1 / limb_weight[i] + doubt * doubt));
    }
  }
  const std::vector<double> fitted = falling_towards_tips(value, weight, parent);
  for (std::size_t l = 0; l < limbs.size(); ++l)
    for (std::size_t i = 0; i < limbs[l].nodes.size(); ++i) {
      LimbNode& node = limbs[l].nodes[i];
      node.radius_m = fitted[first[l] + i];
      node.radius_se_m = 1 / std::sqrt(weight[first[l] + i]);
    }
  return report;
}

}  // namespace dendrofit
