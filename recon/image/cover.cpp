// SPDX-License-Identifier: GPL-3.0-or-later
#include "recon/image/cover.h"

#include "recon/image/distance.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace dendrofit {
namespace {

constexpr float kGamma = 2.2F;       // of pictures' grey levels, near enough sRGB's curve
constexpr float kUsualBark = 0.1F;   // of the sky's light
constexpr float kBrightest = 0.6F;   // bark, of the sky's light
constexpr std::size_t kEnough = 50;  // pixels that tell the bark's light

/// Light over the sky's, from grey levels over the sky's: in a pixel that wood covers in part, light mixes,
/// not grey levels.
std::vector<float> light_of(const SkyRatio& sky) {
  std::vector<float> light(sky.ratio.size());
  for (std::size_t p = 0; p < light.size(); ++p) light[p] = std::pow(std::max(0.0F, sky.ratio[p]), kGamma);
  return light;
}

/// Mean light of the pixels well inside wood within three pixels of (x, y); `otherwise` where there is none.
float bark_near(const Silhouette& s, const std::vector<float>& light, const std::vector<float>& inside, int x,
                int y, float otherwise) {
  float sum = 0;
  int count = 0;
  for (int ny = std::max(0, y - 3); ny <= std::min(s.height - 1, y + 3); ++ny)
    for (int nx = std::max(0, x - 3); nx <= std::min(s.width - 1, x + 3); ++nx)
      if (inside[s.pixel(nx, ny)] >= 2.5f) {
        sum += light[s.pixel(nx, ny)];
        ++count;
      }
  return count > 0 ? std::min(sum / static_cast<float>(count), kBrightest) : otherwise;
}

}  // namespace

void set_cover(Silhouette& s, const SkyRatio& sky) {
  const std::vector<float> light = light_of(sky);
  const std::vector<float> inside = distance_inside(s.tree, s.width, s.height);
  std::vector<float> bark;
  for (std::size_t p = 0; p < inside.size(); ++p)
    if (inside[p] >= 2.5f) bark.push_back(light[p]);
  float dark = kUsualBark;
  if (bark.size() > kEnough) {
    auto middle = bark.begin() + static_cast<std::ptrdiff_t>(bark.size() / 2);
    std::nth_element(bark.begin(), middle, bark.end());
    dark = std::min(*middle, kBrightest);
  }
  s.cover.assign(s.tree.size(), 0);
  for (int y = 0; y < s.height; ++y)
    for (int x = 0; x < s.width; ++x) {
      const std::size_t p = s.pixel(x, y);
      if (y >= sky.horizon[static_cast<std::size_t>(x)]) {
        s.cover[p] = s.tree[p];
        continue;
      }
      const float own = s.tree[p] ? bark_near(s, light, inside, x, y, dark) : dark;
      s.cover[p] = std::clamp((1 - light[p]) / (1 - own), 0.0f, 1.0f);
    }
}

std::vector<std::uint8_t> sharpened(const Silhouette& s) {
  constexpr float kSolid = 0.6F;
  constexpr std::array<std::array<int, 2>, 4> kWays{{{1, 0}, {0, 1}, {1, 1}, {1, -1}}};
  std::vector<std::uint8_t> sharp = s.tree;
  for (int y = 1; y + 1 < s.height; ++y)
    for (int x = 1; x + 1 < s.width; ++x) {
      const std::size_t p = s.pixel(x, y);
      if (!sharp[p] || s.cover[p] >= kSolid) continue;
      float bend = 0;
      for (const auto& [dx, dy] : kWays) {
        const float here =
            (s.cover[s.pixel(x + dx, y + dy)] + s.cover[s.pixel(x - dx, y - dy)] - 2 * s.cover[p]) /
            static_cast<float>(dx * dx + dy * dy);
        if (std::abs(here) > std::abs(bend)) bend = here;
      }
      if (bend > 0) sharp[p] = 0;
    }
  return sharp;
}

}  // namespace dendrofit
