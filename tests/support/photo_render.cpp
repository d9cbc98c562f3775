// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/support/photo_render.h"

#include "core/metrics.h"
#include "core/parallel.h"
#include "core/point_cloud.h"
#include "core/random.h"
#include "forward/virtual_scan/ray_scene.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <Eigen/Geometry>

namespace dendrofit::test {
namespace {

using Colour = Eigen::Vector3f;  // grey levels, 0..255

constexpr float kGamma = 2.2F;

/// Light, 0..1, of grey levels: what mixes in a pixel and in a lens.
Colour light_of(const Colour& grey) {
  return (grey / 255).array().max(0.0F).pow(kGamma);
}

/// Grey levels of light.
Colour grey_of(const Colour& light) {
  return 255 * light.array().max(0.0F).pow(1 / kGamma);
}

/// Smooth noise in 0..1 on a lattice.
double lattice(const Random& random, std::uint64_t layer, double x, double y) {
  const double fx = std::floor(x), fy = std::floor(y);
  const auto at = [&](double a, double b) {
    return random
        .child({layer, static_cast<std::uint64_t>(static_cast<std::int64_t>(a)),
                static_cast<std::uint64_t>(static_cast<std::int64_t>(b))})
        .uniform();
  };
  const double u = x - fx, v = y - fy;
  return (1 - v) * ((1 - u) * at(fx, fy) + u * at(fx + 1, fy)) +
         v * ((1 - u) * at(fx, fy + 1) + u * at(fx + 1, fy + 1));
}

/// What is behind the tree along a ray.
Colour background(const Random& random, const Vec3& eye, const Vec3& ray, double ground) {
  const double rise = std::asin(std::clamp(ray.z(), -1.0, 1.0));
  const double bearing = std::atan2(ray.y(), ray.x()) * 180 / std::numbers::pi;
  if (rise < 0) {
    const double far = (eye.z() - ground) / std::max(1e-6, -ray.z());
    const Vec3 at = eye + far * ray;
    const double tone = 0.8 + 0.25 * lattice(random, 1, at.x() * 0.7, at.y() * 0.7) +
                        0.2 * lattice(random, 2, at.x() * 6, at.y() * 6) * std::exp(-far / 30);
    const double haze = 1 - std::exp(-far / 150);
    return static_cast<float>((1 - haze) * tone) * Colour(108, 122, 78) +
           static_cast<float>(haze) * Colour(150, 160, 170);
  }
  const double crest =
      (1.6 + 0.9 * lattice(random, 3, bearing * 0.8, 0) + 0.5 * lattice(random, 4, bearing * 5, 0)) *
      std::numbers::pi / 180;
  if (rise < crest) {
    const auto tone = static_cast<float>(0.9 + 0.2 * lattice(random, 5, bearing * 6, rise * 300));
    return tone * Colour(88, 100, 96);
  }
  const auto t = static_cast<float>(std::min(1.0, rise / 0.9));
  return (1 - t) * Colour(236, 240, 248) + t * Colour(184, 208, 240);
}

/// Pixels a tree may touch, from its cylinders' outlines with a margin.
std::vector<char> candidates(const Tree& tree, const Camera& camera) {
  std::vector<char> mark(static_cast<std::size_t>(camera.width) * static_cast<std::size_t>(camera.height), 0);
  for (std::size_t i = 0; i < tree.size(); ++i) {
    const int steps =
        std::max(1, static_cast<int>(std::ceil(tree.length(i) / std::max(0.02, tree.radius[i]))));
    for (int k = 0; k <= steps; ++k) {
      const Vec3 p = tree.start[i] + (tree.end[i] - tree.start[i]) * (static_cast<double>(k) / steps);
      const auto at = camera.project(p);
      if (!at) continue;
      const double reach = 1.5 * camera.fx / camera.depth(p) * (1.3 * tree.radius[i] + 0.02) + 3;
      for (int y = std::max(0, static_cast<int>(at->y() - reach));
           y <= std::min(camera.height - 1, static_cast<int>(at->y() + reach)); ++y)
        for (int x = std::max(0, static_cast<int>(at->x() - reach));
             x <= std::min(camera.width - 1, static_cast<int>(at->x() + reach)); ++x)
          mark[static_cast<std::size_t>(y) * static_cast<std::size_t>(camera.width) +
               static_cast<std::size_t>(x)] = 1;
    }
  }
  return mark;
}

Colour bark(const Random& random, const Tree& tree, std::size_t i, const Vec3& at) {
  const Vec3 along = tree.direction(i);
  const Vec3 to = at - tree.start[i];
  const Vec3 normal = (to - to.dot(along) * along).normalized();
  const double light = 0.62 + 0.25 * normal.dot(Vec3(0.4, 0.3, 0.866)) +
                       0.12 * lattice(random, 6, at.x() * 90 + at.y() * 70, at.z() * 14);
  return static_cast<float>(std::clamp(light, 0.25, 1.0)) * Colour(118, 104, 94);
}

/// The picture's light as grey levels with a lens' blur and a sensor's grain.
void blur_and_grain(std::vector<Colour>& picture, int width, int height, const RenderOptions& options,
                    const Random& random, std::vector<std::uint8_t>& rgb) {
  const float side =
      std::exp(-0.5F / static_cast<float>(std::max(1e-6, options.blur_sigma_px * options.blur_sigma_px)));
  const float middle = 1 / (1 + 2 * side), wing = side / (1 + 2 * side);
  std::vector<Colour> across(picture.size());
  const auto w = static_cast<std::size_t>(width);
  parallel_blocks(
      static_cast<std::size_t>(height), 16, options.threads, [&](std::size_t first, std::size_t last) {
        for (std::size_t y = first; y < last; ++y)
          for (std::size_t x = 0; x < w; ++x)
            across[y * w + x] =
                middle * picture[y * w + x] +
                wing * (picture[y * w + (x > 0 ? x - 1 : 0)] + picture[y * w + std::min(w - 1, x + 1)]);
      });
  parallel_blocks(
      static_cast<std::size_t>(height), 16, options.threads, [&](std::size_t first, std::size_t last) {
        for (std::size_t y = first; y < last; ++y) {
          Random grain = random.child({7, y});
          const std::size_t up = y > 0 ? y - 1 : 0,
                            down = std::min(static_cast<std::size_t>(height) - 1, y + 1);
          for (std::size_t x = 0; x < w; ++x) {
            const Colour c =
                grey_of(middle * across[y * w + x] + wing * (across[up * w + x] + across[down * w + x]));
            for (int k = 0; k < 3; ++k)
              rgb[3 * (y * w + x) + static_cast<std::size_t>(k)] = static_cast<std::uint8_t>(
                  std::clamp(std::lround(c[k] + options.noise_sigma * grain.normal()), 0L, 255L));
          }
        }
      });
}

}  // namespace

Camera camera_at(const Vec3& eye, const Vec3& target, int width, int height, double focal_px, double k1) {
  Camera camera;
  camera.width = width;
  camera.height = height;
  camera.fx = camera.fy = focal_px;
  camera.cx = 0.5 * width;
  camera.cy = 0.5 * height;
  camera.k1 = k1;
  const Vec3 forward = (target - eye).normalized();
  const Vec3 right = forward.cross(Vec3::UnitZ()).normalized();
  camera.rotation.row(0) = right;
  camera.rotation.row(1) = forward.cross(right);
  camera.rotation.row(2) = forward;
  camera.translation = -(camera.rotation * eye);
  return camera;
}

View render_view(const Tree& tree, const Camera& camera, const RenderOptions& options) {
  View view;
  view.camera = camera;
  Photograph& photo = view.photo;
  photo.width = camera.width;
  photo.height = camera.height;
  const auto w = static_cast<std::size_t>(camera.width), h = static_cast<std::size_t>(camera.height);
  photo.rgb.assign(3 * w * h, 255);
  photo.mask.assign(w * h, 0);
  const double ground = foot_height(tree);
  const Vec3 eye = camera.centre();
  const Bounds bounds = [&] {
    Bounds b;
    for (const Vec3& p : tree.end) b.add(p);
    return b;
  }();
  const RayScene scene(tree, nullptr, true, 0.5 * (bounds.lo + bounds.hi), std::nullopt);
  const std::vector<char> candidate = candidates(tree, camera);
  const Random random(options.seed);
  std::vector<Colour> picture(options.photograph ? w * h : 0);
  const int n = options.samples;
  parallel_blocks(h, 4, options.threads, [&](std::size_t first, std::size_t last) {
    for (std::size_t y = first; y < last; ++y)
      for (std::size_t x = 0; x < w; ++x) {
        const Eigen::Vector2d corner(static_cast<double>(x), static_cast<double>(y));
        int covered = 0;
        Colour wood = Colour::Zero();
        for (int k = 0; candidate[y * w + x] && k < n * n; ++k) {
          const Vec3 ray = camera.ray(corner + Eigen::Vector2d((k % n + 0.5) / n, (k / n + 0.5) / n));
          const RayHit hit = scene.cast(eye, ray, 1000);
          if (hit.what != RayHit::What::wood) continue;
          ++covered;
          if (options.photograph)
            wood += light_of(bark(random, tree, static_cast<std::size_t>(hit.id), eye + hit.range_m * ray));
        }
        photo.mask[y * w + x] = 2 * covered >= n * n ? 255 : 0;
        if (!options.photograph) continue;
        const Colour behind =
            covered == n * n
                ? Colour(Colour::Zero())
                : light_of(background(random, eye, camera.ray(corner + Eigen::Vector2d(0.5, 0.5)), ground));
        picture[y * w + x] =
            (wood + static_cast<float>(n * n - covered) * behind) / static_cast<float>(n * n);
      }
  });
  if (options.photograph) blur_and_grain(picture, camera.width, camera.height, options, random, photo.rgb);
  return view;
}

ViewSet photograph_ring(const Tree& tree, const RingOptions& options) {
  ViewSet set;
  set.origin_shift = tree.origin_shift;
  Bounds bounds;
  for (std::size_t i = 0; i < tree.size(); ++i) {
    bounds.add(tree.start[i]);
    bounds.add(tree.end[i]);
  }
  const Vec3 middle = 0.5 * (bounds.lo + bounds.hi);
  const double ground = foot_height(tree);
  const double half_width = 0.5 * bounds.size().head<2>().norm();
  const double distance =
      half_width + options.focal_px * std::max(bounds.size().z() / (options.fill * options.height),
                                               2 * half_width / (options.fill * options.width) * 0.8);
  const Random random = Random(options.render.seed).child({0x72696e67});
  for (int v = 0; v < options.views; ++v) {
    Random draw = random.child({static_cast<std::uint64_t>(v)});
    const double bearing =
        2 * std::numbers::pi * (v + options.wobble * (draw.uniform() - 0.5)) / options.views + 0.4;
    const double away = distance * (1 + options.wobble * (draw.uniform() - 0.3));
    const double up = options.eye_height_m * (1 + options.wobble * (draw.uniform() - 0.5));
    const Vec3 eye(middle.x() + away * std::cos(bearing), middle.y() + away * std::sin(bearing), ground + up);
    const Vec3 target = middle + 0.04 * bounds.size().z() * draw.direction();
    Camera camera = camera_at(eye, target, options.width, options.height, options.focal_px, options.k1);
    RenderOptions render = options.render;
    render.seed = options.render.seed * 1000 + static_cast<std::uint64_t>(v);
    View view = render_view(tree, camera, render);
    view.photo.name = "view_" + std::string(v < 10 ? "0" : "") + std::to_string(v);
    const Vec3 axis = draw.direction(), off(draw.normal(), draw.normal(), draw.normal());
    const double turn = options.turn_error_deg * std::numbers::pi / 180 * draw.normal();
    const Vec3 told = camera.centre() + options.shift_error_m * off;
    view.camera.rotation = Eigen::AngleAxisd(turn, axis).toRotationMatrix() * camera.rotation;
    view.camera.translation = -(view.camera.rotation * told);
    set.views.push_back(std::move(view));
  }
  return set;
}

}  // namespace dendrofit::test
