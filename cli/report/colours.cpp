// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/report/colours.h"

#include <algorithm>
#include <cmath>

namespace dendrofit {

Rgb order_colour(int order) {
  return kOrderColours[static_cast<std::size_t>(
      std::clamp(order, 0, static_cast<int>(kOrderColours.size()) - 1))];
}

Rgb quality_colour(RadiusQuality quality) {
  switch (quality) {
    case RadiusQuality::measured:
      return {0, 90, 160};
    case RadiusQuality::interpolated:
      return {86, 180, 233};
    case RadiusQuality::allometric:
      return {230, 159, 0};
    case RadiusQuality::extrapolated:
      return {204, 121, 167};
  }
  return {110, 110, 110};
}

Rgb scale_colour(double share) {
  constexpr std::array<std::array<double, 3>, 6> kStops = {
      {{68, 1, 84}, {65, 68, 135}, {42, 120, 142}, {34, 168, 132}, {122, 209, 81}, {240, 225, 40}}};
  const double at = std::isfinite(share) ? std::clamp(share, 0.0, 1.0) * (kStops.size() - 1) : 0.0;
  const auto below = std::min(static_cast<std::size_t>(at), kStops.size() - 2);
  const double t = at - static_cast<double>(below);
  const auto mix = [&](std::size_t c) {
    return static_cast<std::uint8_t>(
        std::lround(kStops[below][c] + t * (kStops[below + 1][c] - kStops[below][c])));
  };
  return {mix(0), mix(1), mix(2)};
}

std::vector<Rgb> tree_colours(const Tree& tree, TreeColour colour) {
  std::vector<Rgb> colours(tree.size(), kBark);
  if (tree.empty()) return colours;
  if (colour == TreeColour::order)
    for (std::size_t i = 0; i < tree.size(); ++i) colours[i] = order_colour(tree.order[i]);
  if (colour == TreeColour::quality)
    for (std::size_t i = 0; i < tree.size(); ++i) colours[i] = quality_colour(tree.quality[i]);
  if (colour == TreeColour::radius) {
    std::vector<double> sorted = tree.radius;
    std::sort(sorted.begin(), sorted.end());
    const auto at = [&](double share) {
      return std::log(sorted[static_cast<std::size_t>(share * static_cast<double>(sorted.size() - 1))]);
    };
    const double lo = at(0.02);
    const double span = std::max(at(0.98) - lo, 1e-9);
    for (std::size_t i = 0; i < tree.size(); ++i)
      colours[i] = scale_colour((std::log(tree.radius[i]) - lo) / span);
  }
  if (colour == TreeColour::birth_cycle) {
    int first = -1;
    int last = -1;
    for (int cycle : tree.birth_cycle)
      if (cycle >= 0) {
        first = first < 0 ? cycle : std::min(first, cycle);
        last = std::max(last, cycle);
      }
    for (std::size_t i = 0; i < tree.size(); ++i)
      if (tree.birth_cycle[i] >= 0)
        colours[i] =
            scale_colour(static_cast<double>(tree.birth_cycle[i] - first) / std::max(1, last - first));
  }
  return colours;
}

std::string hex(Rgb colour) {
  constexpr char kDigits[] = "0123456789abcdef";
  std::string text = "#";
  for (std::uint8_t c : {colour.r, colour.g, colour.b}) {
    text += kDigits[c >> 4];
    text += kDigits[c & 15];
  }
  return text;
}

}  // namespace dendrofit
