// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/report/overlay.h"

#include "cli/report/colours.h"

#include <algorithm>
#include <cmath>

namespace dendrofit {
namespace {

/// Halved `halvings` times by means of blocks, and two fifths of the way to white.
Image pale(const Photograph& photo, int halvings) {
  const int block = 1 << halvings;
  Image image((photo.width + block - 1) / block, (photo.height + block - 1) / block, {255, 255, 255});
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) {
      int sum[3] = {}, n = 0;
      for (int py = y * block; py < std::min(photo.height, (y + 1) * block); ++py)
        for (int px = x * block; px < std::min(photo.width, (x + 1) * block); ++px, ++n)
          for (std::size_t c = 0; c < 3; ++c) sum[c] += photo.rgb[3 * photo.pixel(px, py) + c];
      const auto mean = [&](int s) { return static_cast<std::uint8_t>(255 - (255 - s / n) * 3 / 5); };
      image.blend(x, y, {mean(sum[0]), mean(sum[1]), mean(sum[2])}, 1);
    }
  return image;
}

void ring(Image& image, double x, double y, double radius, Rgb colour) {
  constexpr int sides = 40;
  for (int k = 0; k < sides; ++k) {
    const double a = 2 * M_PI * k / sides, b = 2 * M_PI * (k + 1) / sides;
    draw_line(image, x + radius * std::cos(a), y + radius * std::sin(a), x + radius * std::cos(b),
              y + radius * std::sin(b), 2, colour);
  }
}

int halvings_to(const Photograph& photo, int longest_side_px) {
  photo.validate();
  int halvings = 0;
  while (std::max(photo.width, photo.height) >> halvings > longest_side_px) ++halvings;
  return halvings;
}

}  // namespace

Image draw_overlay(const Photograph& photo, const Camera& camera, const Tree& tree, const Vec3& shift,
                   int longest_side_px) {
  const int halvings = halvings_to(photo, longest_side_px);
  Image image = pale(photo, halvings);
  const double scale = std::ldexp(1.0, -halvings);
  std::int32_t most = 0;
  for (const std::int32_t order : tree.order) most = std::max(most, order);
  // Thick orders last, so that the stem lies on top.
  for (std::int32_t order = most; order >= 0; --order)
    for (std::size_t i = 0; i < tree.size(); ++i) {
      if (tree.order[i] != order) continue;
      const auto a = camera.project(tree.start[i] + shift), b = camera.project(tree.end[i] + shift);
      if (!a || !b) continue;
      draw_line(image, scale * a->x(), scale * a->y(), scale * b->x(), scale * b->y(), order == 0 ? 2.5 : 1.5,
                order_colour(order));
    }
  for (std::size_t i = 0; i < tree.size(); ++i) {
    if (tree.parent[i] >= 0) continue;
    if (const auto foot = camera.project(tree.start[i] + shift))
      ring(image, scale * foot->x(), scale * foot->y(), 12, order_colour(1));
  }
  return image;
}

Image draw_outline(const Photograph& photo, const Silhouette& silhouette, int longest_side_px) {
  Image image = pale(photo, halvings_to(photo, longest_side_px));
  const auto inside = [&](int x, int y) {
    const auto place = [](int i, int count, int of) {
      return std::clamp(static_cast<int>((i + 0.5) * count / of), 0, count - 1);
    };
    return x >= 0 && y >= 0 && x < image.width && y < image.height &&
           silhouette.tree[silhouette.pixel(place(x, silhouette.width, image.width),
                                            place(y, silhouette.height, image.height))] != 0;
  };
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x)
      if (inside(x, y) && !(inside(x - 1, y) && inside(x + 1, y) && inside(x, y - 1) && inside(x, y + 1)))
        image.blend(x, y, order_colour(0), 1);
  return image;
}

}  // namespace dendrofit
