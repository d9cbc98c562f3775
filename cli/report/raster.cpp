// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/report/raster.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include <Eigen/Geometry>

namespace dendrofit {
namespace {

using Eigen::Vector3f;

constexpr float kFar = std::numeric_limits<float>::infinity();
constexpr std::uint32_t kNothing = 0xffffffffu;
constexpr std::uint32_t kPointBit = 0x80000000u;  // ids from here on are points

struct Buffer {
  int width, height;
  std::vector<float> depth;
  std::vector<std::uint32_t> id;              // triangle or point that is seen
  std::vector<std::array<float, 2>> weights;  // barycentric, of vertices 1 and 2

  Buffer(int w, int h, bool with_ids)
      : width(w), height(h), depth(static_cast<std::size_t>(w) * static_cast<std::size_t>(h), kFar) {
    if (with_ids) {
      id.assign(depth.size(), kNothing);
      weights.resize(depth.size());
    }
  }
  std::size_t at(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x);
  }
};

/// First and last pixel whose centre may lie in [lo, hi], within [0, size); none where either is not a
/// number.
std::array<int, 2> pixel_span(float lo, float hi, int size) {
  const float limit = static_cast<float>(size);
  if (!(lo <= hi)) return {0, -1};  // not a number: none
  return {static_cast<int>(std::clamp(std::ceil(lo - 0.5f), 0.0f, limit)),
          static_cast<int>(std::clamp(std::floor(hi - 0.5f), -1.0f, limit - 1))};
}

void draw_triangle(const std::array<Vector3f, 3>& p, std::uint32_t id, Buffer& buffer) {
  const Vector3f e1 = p[1] - p[0];
  const Vector3f e2 = p[2] - p[0];
  const float area = e1.x() * e2.y() - e1.y() * e2.x();
  if (area == 0 || !std::isfinite(area)) return;
  const auto [left, right] = pixel_span(std::min({p[0].x(), p[1].x(), p[2].x()}),
                                        std::max({p[0].x(), p[1].x(), p[2].x()}), buffer.width);
  const auto [top, bottom] = pixel_span(std::min({p[0].y(), p[1].y(), p[2].y()}),
                                        std::max({p[0].y(), p[1].y(), p[2].y()}), buffer.height);
  for (int y = top; y <= bottom; ++y)
    for (int x = left; x <= right; ++x) {
      const float dx = static_cast<float>(x) + 0.5f - p[0].x();
      const float dy = static_cast<float>(y) + 0.5f - p[0].y();
      const float w1 = (dx * e2.y() - dy * e2.x()) / area;
      const float w2 = (e1.x() * dy - e1.y() * dx) / area;
      if (w1 < 0 || w2 < 0 || w1 + w2 > 1) continue;
      const float depth = p[0].z() + w1 * e1.z() + w2 * e2.z();
      const std::size_t at = buffer.at(x, y);
      if (depth >= buffer.depth[at]) continue;
      buffer.depth[at] = depth;
      if (buffer.id.empty()) continue;
      buffer.id[at] = id;
      buffer.weights[at] = {w1, w2};
    }
}

void draw_point(const Vector3f& p, float radius_px, std::uint32_t id, Buffer& buffer) {
  const auto [left, right] = pixel_span(p.x() - radius_px, p.x() + radius_px, buffer.width);
  const auto [top, bottom] = pixel_span(p.y() - radius_px, p.y() + radius_px, buffer.height);
  for (int y = top; y <= bottom; ++y)
    for (int x = left; x <= right; ++x) {
      const float dx = static_cast<float>(x) + 0.5f - p.x();
      const float dy = static_cast<float>(y) + 0.5f - p.y();
      if (dx * dx + dy * dy > radius_px * radius_px) continue;
      const std::size_t at = buffer.at(x, y);
      if (p.z() >= buffer.depth[at]) continue;
      buffer.depth[at] = p.z();
      if (!buffer.id.empty()) buffer.id[at] = id;
    }
}

void draw_all(const Scene& scene, const PictureView& view, float point_size_m, bool ground, Buffer& buffer) {
  std::vector<Vector3f> pixels(scene.vertices.size());
  std::vector<char> seen(scene.vertices.size());
  for (std::size_t i = 0; i < pixels.size(); ++i) seen[i] = view.project(scene.vertices[i], pixels[i]);
  for (std::size_t t = 0; t < scene.triangles.size(); ++t) {
    const auto& [a, b, c] = scene.triangles[t];
    if (!ground && scene.surfaces[t] == Scene::Surface::ground) continue;
    if (seen[a] && seen[b] && seen[c])
      draw_triangle({pixels[a], pixels[b], pixels[c]}, static_cast<std::uint32_t>(t), buffer);
  }
  Vector3f pixel;
  for (std::size_t i = 0; i < scene.points.size(); ++i) {
    if (!view.project(scene.points[i], pixel)) continue;
    const float nearness = view.perspective ? view.distance / pixel.z() : 1.0f;
    const float radius = std::max(0.5f * point_size_m * view.scale * nearness, 0.71f);
    draw_point(pixel, radius, static_cast<std::uint32_t>(i) | kPointBit, buffer);
  }
}

/// What stands about a tree, seen through: it tints what lies behind it.
class Panes {
 public:
  Panes(const Scene& scene, const PictureView& view, int width, int height)
      : scene_(scene), buffer_(scene.panes.empty() ? 0 : width, scene.panes.empty() ? 0 : height, true) {
    for (std::size_t i = 0; i < scene.panes.size(); ++i) {
      std::array<Vector3f, 3> pixels;
      bool seen = true;
      for (std::size_t k = 0; k < 3; ++k) seen = view.project(scene.panes[i][k], pixels[k]) && seen;
      if (seen) draw_triangle(pixels, static_cast<std::uint32_t>(i), buffer_);
    }
  }
  /// `colour` as it looks through the panes before `depth`.
  Vector3f through(int x, int y, float depth, const Vector3f& sun, const Vector3f& colour) const {
    if (scene_.panes.empty()) return colour;
    const std::size_t at = buffer_.at(x, y);
    if (buffer_.id[at] == kNothing || buffer_.depth[at] >= depth) return colour;
    const auto& [a, b, c] = scene_.panes[buffer_.id[at]];
    const Vector3f normal = (b - a).cross(c - a).normalized();
    const Vector3f pane = Vector3f(140, 152, 172) * (0.8f + 0.25f * std::abs(normal.dot(sun)));
    constexpr float kCover = 0.45f;
    return colour + kCover * (pane - colour);
  }

 private:
  const Scene& scene_;
  Buffer buffer_;
};

/// How much of the light from one direction reaches a place.
struct ShadowMap {
  PictureView view;
  Buffer buffer{1, 1, false};
  float bias_m = 0;

  ShadowMap(const Scene& scene, const Vector3f& towards_light, int size, float point_size_m) {
    view.forward = -towards_light;
    view.right = std::abs(towards_light.z()) < 0.99f
                     ? Vector3f(Vector3f::UnitZ().cross(view.forward)).normalized()
                     : Vector3f(Vector3f::UnitX());
    view.right = (view.right - view.right.dot(view.forward) * view.forward).normalized();
    view.up = view.right.cross(view.forward);
    Vector3f lo = Vector3f::Constant(kFar);
    Vector3f hi = -lo;
    for (const auto* list : {&scene.vertices, &scene.points})
      for (const Vector3f& v : *list) {
        lo = lo.cwiseMin(v);
        hi = hi.cwiseMax(v);
      }
    view.centre = 0.5f * (lo + hi);
    const float reach = std::max(0.5f * (hi - lo).norm(), 1e-3f);
    view.distance = 2 * reach;
    view.centre_x = view.centre_y = 0.5f * static_cast<float>(size);
    view.scale = static_cast<float>(size) / (2 * reach);
    bias_m = 2.0f / view.scale;
    buffer = Buffer(size, size, false);
    draw_all(scene, view, point_size_m, false, buffer);
  }

  /// `normal` lifts the place off its own surface (zero for points).
  float lit(const Vector3f& place, const Vector3f& normal, int reach) const {
    Vector3f pixel;
    view.project(place + bias_m * normal, pixel);
    const int cx = static_cast<int>(pixel.x());
    const int cy = static_cast<int>(pixel.y());
    int open = 0;
    int asked = 0;
    for (int y = cy - reach; y <= cy + reach; ++y)
      for (int x = cx - reach; x <= cx + reach; ++x) {
        ++asked;
        open += x < 0 || y < 0 || x >= buffer.width || y >= buffer.height ||
                buffer.depth[buffer.at(x, y)] > pixel.z() - bias_m;
      }
    return static_cast<float>(open) / static_cast<float>(asked);
  }
};

/// The sun and an even sky of `kSkyMaps` directions, weighted by the cosine from the zenith.
class Light {
 public:
  Light(const Scene& scene, const Vector3f& sun, float point_size_m)
      : sun_direction_(sun), sun_(scene, sun, 2048, point_size_m) {
    for (int k = 0; k < kSkyMaps; ++k) {
      const double height = std::sqrt((k + 0.5) / kSkyMaps);
      const double around = 2 * std::numbers::pi * 0.6180339887 * k;
      const double across = std::sqrt(1 - height * height);
      const Vector3f towards(static_cast<float>(across * std::cos(around)),
                             static_cast<float>(across * std::sin(around)), static_cast<float>(height));
      sky_.emplace_back(scene, towards, 320, point_size_m);
    }
  }
  float sun(const Vector3f& place, const Vector3f& normal) const { return sun_.lit(place, normal, 1); }
  float sky(const Vector3f& place, const Vector3f& normal) const {
    float sum = 0;
    for (const ShadowMap& map : sky_) sum += map.lit(place, normal, 0);
    return sum / kSkyMaps;
  }
  const Vector3f& sun_direction() const { return sun_direction_; }

 private:
  static constexpr int kSkyMaps = 24;
  Vector3f sun_direction_;
  ShadowMap sun_;
  std::vector<ShadowMap> sky_;
};

/// Dark where neighbours stand before the pixel: shape for what has no normals.
float nearer_neighbours(const Buffer& buffer, int x, int y, int reach, float metre) {
  const float own = buffer.depth[buffer.at(x, y)];
  float sum = 0;
  for (int k = 0; k < 8; ++k) {
    constexpr std::array<int, 8> kX = {1, 1, 0, -1, -1, -1, 0, 1};
    constexpr std::array<int, 8> kY = {0, 1, 1, 1, 0, -1, -1, -1};
    const int nx = x + reach * kX[static_cast<std::size_t>(k)];
    const int ny = y + reach * kY[static_cast<std::size_t>(k)];
    if (nx < 0 || ny < 0 || nx >= buffer.width || ny >= buffer.height) continue;
    const float other = buffer.depth[buffer.at(nx, ny)];
    if (other < own) sum += std::min((own - other) / metre, 1.0f);
  }
  return sum / 8;
}

}  // namespace

bool PictureView::project(const Vector3f& world, Vector3f& pixel) const {
  const Vector3f d = world - centre;
  const float depth = forward.dot(d) + distance;
  if (perspective && depth < 0.02f * distance) return false;
  const float s = perspective ? scale * distance / depth : scale;
  pixel = {centre_x + s * right.dot(d), centre_y - s * up.dot(d), depth};
  return true;
}

Vector3f PictureView::unproject(float x, float y, float depth) const {
  const float s = perspective ? scale * distance / depth : scale;
  return centre + (x - centre_x) / s * right - (y - centre_y) / s * up + (depth - distance) * forward;
}

PictureView view_along(double azimuth_deg, double elevation_deg) {
  const double a = azimuth_deg * std::numbers::pi / 180;
  const double e = elevation_deg * std::numbers::pi / 180;
  PictureView view;
  view.right = Vec3(std::cos(a), std::sin(a), 0).cast<float>();
  view.forward = Vec3(-std::sin(a) * std::cos(e), std::cos(a) * std::cos(e), -std::sin(e)).cast<float>();
  view.up = view.right.cross(view.forward);
  return view;
}

Image draw_scene(const Scene& scene, const PictureView& view, int width_px, int height_px, int samples,
                 const Shading& shading) {
  PictureView fine = view;
  const auto factor = static_cast<float>(samples);
  fine.scale *= factor;
  fine.centre_x *= factor;
  fine.centre_y *= factor;
  Buffer buffer(width_px * samples, height_px * samples, true);
  Image image(width_px, height_px, shading.background);
  if (scene.vertices.empty() && scene.points.empty()) return image;
  draw_all(scene, fine, shading.point_size_m, true, buffer);

  // From behind the viewer's left shoulder, 50 degrees up.
  const Vector3f back(-view.forward.x(), -view.forward.y(), 0);
  const Vector3f behind =
      back.norm() > 1e-3f ? back.normalized() : Vector3f(-view.up.x(), -view.up.y(), 0).normalized();
  const Vector3f sun = (0.55f * behind - 0.6f * view.right + 0.95f * Vector3f::UnitZ()).normalized();
  std::vector<Light> light;
  if (shading.shadows) light.emplace_back(scene, sun, shading.point_size_m);

  const Panes panes(scene, fine, buffer.width, buffer.height);
  const auto shade = [&](int x, int y) -> Vector3f {
    const std::size_t at = buffer.at(x, y);
    const std::uint32_t id = buffer.id[at];
    const Vector3f ground_tone(shading.background.r, shading.background.g, shading.background.b);
    if (id == kNothing) return ground_tone;
    const bool point = (id & kPointBit) != 0;
    const std::size_t index = id & ~kPointBit;
    const Rgb c = point ? scene.point_colours[index] : scene.colours[index];
    const Vector3f base(c.r, c.g, c.b);
    const Vector3f place =
        fine.unproject(static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f, buffer.depth[at]);
    Vector3f normal = Vector3f::Zero();
    if (!point) {
      const auto& [a, b, d] = scene.triangles[index];
      const auto [w1, w2] = buffer.weights[at];
      normal = (1 - w1 - w2) * scene.normals[a] + w1 * scene.normals[b] + w2 * scene.normals[d];
      normal.normalize();
      if (normal.dot(fine.forward) > 0) normal = -normal;
    }
    const float sky_share = light.empty() ? 1 : light[0].sky(place, normal);
    const float sun_share = light.empty() ? 1 : light[0].sun(place, normal);
    if (point) {
      const float near = nearer_neighbours(buffer, x, y, samples, 40 / fine.scale);
      return base * ((0.60f + 0.34f * sky_share + 0.30f * sun_share) * (1 - 0.5f * near));
    }
    const Scene::Surface surface = scene.surfaces[index];
    if (surface == Scene::Surface::ground) {
      // The disc fades into the background towards its rim.
      const float rim = buffer.weights[at][0] + buffer.weights[at][1];
      const float fade = std::clamp((1 - rim) * 2.5f, 0.0f, 1.0f);
      const Vector3f lit = base * (0.70f + 0.16f * sky_share + 0.18f * sun_share);
      return ground_tone + fade * (lit - ground_tone);
    }
    float direct = normal.dot(light.empty() ? sun : light[0].sun_direction());
    // A leaf lit from behind shines through a little.
    direct = surface == Scene::Surface::leaf ? std::max(direct, -0.6f * direct) : std::max(direct, 0.0f);
    const float upward = 0.5f + 0.5f * normal.z();
    return base * (0.36f + 0.34f * sky_share * (0.5f + 0.5f * upward) + 0.62f * direct * sun_share);
  };

  for (int y = 0; y < height_px; ++y)
    for (int x = 0; x < width_px; ++x) {
      Vector3f sum = Vector3f::Zero();
      for (int sy = 0; sy < samples; ++sy)
        for (int sx = 0; sx < samples; ++sx) {
          const int fx = x * samples + sx, fy = y * samples + sy;
          sum += panes.through(fx, fy, buffer.depth[buffer.at(fx, fy)], sun, shade(fx, fy));
        }
      sum /= factor * factor;
      const auto channel = [](float v) {
        return static_cast<std::uint8_t>(std::clamp(v + 0.5f, 0.0f, 255.0f));
      };
      image.blend(x, y, {channel(sum.x()), channel(sum.y()), channel(sum.z())}, 1);
    }
  return image;
}

}  // namespace dendrofit
