// SPDX-License-Identifier: GPL-3.0-or-later
#include "recon/image/cover.h"

#include "recon/image/distance.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <Eigen/Core>

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

using Light = Eigen::Vector3f;

/// The light of a picture's pixels, linear, by a table of its grey levels.
class PictureLight {
 public:
  explicit PictureLight(const Photograph& photo) : photo_(photo) {
    for (std::size_t grey = 0; grey < table_.size(); ++grey)
      table_[grey] = std::pow(static_cast<float>(grey) / 255, kGamma);
  }
  Light at(std::size_t p) const {
    return {table_[photo_.rgb[3 * p]], table_[photo_.rgb[3 * p + 1]], table_[photo_.rgb[3 * p + 2]]};
  }

 private:
  const Photograph& photo_;
  std::array<float, 256> table_{};
};

/// First row of a stem's foot, as far up as it is wide: where it meets the ground it has no edge to tell.
int foot_row(const Silhouette& s, const std::vector<float>& inside) {
  int bottom = s.height - 1;
  const auto widest = [&](int y) {
    const auto row = inside.begin() + static_cast<std::ptrdiff_t>(s.pixel(0, y));
    return *std::max_element(row, row + s.width);
  };
  while (bottom > 0 && widest(bottom) <= 0) --bottom;
  float half_width = 0;
  int row = bottom;
  for (; row > 0 && static_cast<float>(bottom - row) <= 2 * half_width + 2; --row)
    half_width = std::max(half_width, widest(row));
  return row;
}

/// Below the horizon there is no sky to compare with: an edge's pixels are told between the wood's light and
/// that of what is behind, both from nearby. `tree` gains the soft edges that stand out.
void soften_below_horizon(Silhouette& s, const SkyRatio& sky, const Photograph& photo) {
  constexpr int kNear = 6;          // pixels
  constexpr float kInside = 2;      // from the edge: wood without what is behind
  constexpr float kOutside = 2.5F;  // from the edge: what is behind without wood
  constexpr float kApart = 0.02F;   // of white: wood and what is behind must differ by
  constexpr float kSoft = 0.25F;    // covered: part of the tree, as above the horizon
  const std::vector<float> inside = distance_inside(s.tree, s.width, s.height);
  const std::vector<float> outside = distance_outside(s.tree, s.width, s.height);
  const PictureLight light(photo);
  const int top = *std::min_element(sky.horizon.begin(), sky.horizon.end());
  const int foot = foot_row(s, inside);
  for (int y = std::max(0, top); y < foot; ++y)
    for (int x = 0; x < s.width; ++x) {
      const std::size_t p = s.pixel(x, y);
      if (y < sky.horizon[static_cast<std::size_t>(x)] || inside[p] > kOutside || outside[p] > kInside)
        continue;
      Light wood = Light::Zero(), behind = Light::Zero();
      int woods = 0, behinds = 0;
      float deepest = 0;
      for (int ny = std::max(top, y - kNear); ny <= std::min(s.height - 1, y + kNear); ++ny)
        for (int nx = std::max(0, x - kNear); nx <= std::min(s.width - 1, x + kNear); ++nx) {
          const std::size_t q = s.pixel(nx, ny);
          if (outside[q] >= kOutside) {
            behind += light.at(q);
            ++behinds;
          } else if (inside[q] >= std::max(deepest, 1.0F)) {
            // Of thin wood, its middle.
            if (inside[q] > deepest && deepest < kInside)
              wood.setZero(), woods = 0, deepest = std::min(inside[q], kInside);
            wood += light.at(q);
            ++woods;
          }
        }
      if (woods == 0 || behinds == 0) continue;
      wood /= static_cast<float>(woods);
      behind /= static_cast<float>(behinds);
      const Light across = wood - behind;
      if (across.norm() < kApart) continue;
      s.cover[p] = std::clamp((light.at(p) - behind).dot(across) / across.squaredNorm(), 0.0F, 1.0F);
      if (outside[p] <= 1.5F && s.cover[p] >= kSoft) s.tree[p] = 1;
      if (!s.tree[p]) s.cover[p] = 0;
    }
}

}  // namespace

void set_cover(Silhouette& s, const SkyRatio& sky, const Photograph& photo) {
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
  soften_below_horizon(s, sky, photo);
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
