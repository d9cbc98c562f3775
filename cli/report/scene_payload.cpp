// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/report/scene_payload.h"

#include "cli/report/html.h"
#include "core/random.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <numeric>

namespace dendrofit {
namespace {

static_assert(std::endian::native == std::endian::little, "the payload is written in the machine's order");

/// Appends arrays and notes where they are.
class Blob {
 public:
  template <class T>
  std::string add(const char* type, const std::vector<T>& values) {
    while (bytes.size() % 4) bytes.push_back('\0');
    const std::string entry = "{\"type\":\"" + std::string(type) +
                              "\",\"offset\":" + std::to_string(bytes.size()) +
                              ",\"count\":" + std::to_string(values.size()) + "}";
    bytes.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T));
    return entry;
  }
  std::string bytes;
};

/// Places as 16-bit steps in their own box: {"lo":[..],"step":[..],"data":{..}}.
std::string quantised(const std::vector<Vec3>& places, Blob& blob) {
  const Bounds box = bounds_of(places);
  const Vec3 lo = places.empty() ? Vec3(Vec3::Zero()) : box.lo;
  const Vec3 step = places.empty() ? Vec3(Vec3::Ones()) : Vec3(box.size() / 65535).cwiseMax(1e-9);
  std::vector<std::uint16_t> steps;
  steps.reserve(3 * places.size());
  for (const Vec3& p : places)
    for (int c = 0; c < 3; ++c)
      steps.push_back(
          static_cast<std::uint16_t>(std::clamp(std::lround((p[c] - lo[c]) / step[c]), 0L, 65535L)));
  const auto triple = [](const Vec3& v) {
    return "[" + json_number(v.x()) + "," + json_number(v.y()) + "," + json_number(v.z()) + "]";
  };
  return "{\"lo\":" + triple(lo) + ",\"step\":" + triple(step) + ",\"data\":" + blob.add("u16", steps) + "}";
}

Vec3 foot_of(const Tree& tree) {
  return tree.origin_shift + tree.start[0];
}

std::string wood(const Tree& tree, Blob& blob) {
  std::vector<std::size_t> order(tree.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return tree.birth_cycle[a] < tree.birth_cycle[b]; });
  std::vector<std::int32_t> place(tree.size());
  for (std::size_t k = 0; k < order.size(); ++k) place[order[k]] = static_cast<std::int32_t>(k);
  const Vec3 shift = tree.origin_shift - foot_of(tree);
  std::vector<Vec3> ends;
  std::vector<float> radius;
  std::vector<float> radius_se;
  std::vector<std::int32_t> parent;
  std::vector<std::int32_t> id;
  std::vector<std::int16_t> birth;
  std::vector<std::uint8_t> rank;
  std::vector<std::uint8_t> quality;
  for (std::size_t i : order) {
    ends.push_back(tree.start[i] + shift);
    ends.push_back(tree.end[i] + shift);
    radius.push_back(static_cast<float>(tree.radius[i]));
    radius_se.push_back(static_cast<float>(tree.radius_se[i]));
    parent.push_back(tree.parent[i] < 0 ? -1 : place[static_cast<std::size_t>(tree.parent[i])]);
    id.push_back(static_cast<std::int32_t>(i) + 1);
    birth.push_back(static_cast<std::int16_t>(std::clamp(tree.birth_cycle[i], -1, 32767)));
    rank.push_back(static_cast<std::uint8_t>(std::clamp(tree.order[i], 0, 255)));
    quality.push_back(static_cast<std::uint8_t>(tree.quality[i]));
  }
  // A step along an axis goes on with its parent's radius; elsewhere the cylinder begins with its own.
  std::vector<std::uint8_t> continues;
  for (std::size_t i : order)
    continues.push_back(tree.parent[i] >= 0 &&
                        tree.axis[static_cast<std::size_t>(tree.parent[i])] == tree.axis[i]);
  const bool any_se =
      std::any_of(radius_se.begin(), radius_se.end(), [](float v) { return std::isfinite(v); });
  if (!any_se) radius_se.clear();
  return "{\"ends\":" + quantised(ends, blob) + ",\"radius\":" + blob.add("f32", radius) +
         ",\"radius_se\":" + blob.add("f32", radius_se) + ",\"parent\":" + blob.add("i32", parent) +
         ",\"id\":" + blob.add("i32", id) + ",\"birth\":" + blob.add("i16", birth) +
         ",\"order\":" + blob.add("u8", rank) + ",\"quality\":" + blob.add("u8", quality) +
         ",\"continues\":" + blob.add("u8", continues) + "}";
}

constexpr std::size_t kMostShootCylinders = 60'000;

/// Shoots as bare cylinders; of very many, every so many-th shoot with all its side twigs.
std::string shoots(const Tree& twigs, const Vec3& foot, Blob& blob) {
  const Vec3 shift = twigs.origin_shift - foot;
  const std::size_t step = (twigs.size() + kMostShootCylinders - 1) / kMostShootCylinders;
  std::vector<Vec3> ends;
  std::vector<float> radius;
  std::vector<std::size_t> root(twigs.size());  // which shoot a cylinder belongs to
  std::size_t roots = 0;
  for (std::size_t i = 0; i < twigs.size(); ++i) {
    root[i] = twigs.parent[i] < 0 ? roots++ : root[static_cast<std::size_t>(twigs.parent[i])];
    if (root[i] % step != 0) continue;
    ends.push_back(twigs.start[i] + shift);
    ends.push_back(twigs.end[i] + shift);
    radius.push_back(static_cast<float>(twigs.radius[i]));
  }
  return "{\"ends\":" + quantised(ends, blob) + ",\"radius\":" + blob.add("f32", radius) + "}";
}

/// 0..n-1 in random order, so that any first part of what it orders is an even sample.
std::vector<std::size_t> shuffled(std::size_t n) {
  std::vector<std::size_t> order(n);
  std::iota(order.begin(), order.end(), std::size_t{0});
  Random random(20240502);
  for (std::size_t k = n; k > 1; --k) std::swap(order[k - 1], order[random.below(k)]);
  return order;
}

std::string leaves(const Foliage& foliage, const Vec3& foot, std::size_t limit, Blob& blob,
                   std::size_t& shown) {
  std::vector<Vec3> origins;
  std::vector<Vec3> feet;
  std::vector<std::int8_t> frame;
  std::vector<float> length;
  std::vector<std::uint8_t> shape;
  shown = std::min(foliage.size(), limit);
  // Fewer leaves are drawn larger, so that the crown keeps its leaf area.
  const double larger =
      shown ? std::sqrt(static_cast<double>(foliage.size()) / static_cast<double>(shown)) : 1;
  for (const std::size_t k : shuffled(shown)) {
    const Leaf& leaf = foliage.leaves[k * foliage.size() / shown];
    origins.push_back(leaf.origin + foliage.origin_shift - foot);
    feet.push_back(leaf.petiole_foot + foliage.origin_shift - foot);
    for (const Vec3& axis : {leaf.direction, leaf.normal})
      for (int c = 0; c < 3; ++c)
        frame.push_back(static_cast<std::int8_t>(std::lround(127 * std::clamp(axis[c], -1.0, 1.0))));
    length.push_back(static_cast<float>(larger * leaf.length_m));
    shape.push_back(static_cast<std::uint8_t>(std::min<int>(leaf.shape, 255)));
  }
  std::string shapes;
  for (const LeafShape& s : foliage.shapes) {
    std::string vertices;
    for (const Vec3& v : s.vertices)
      for (int c = 0; c < 3; ++c) vertices += (vertices.empty() ? "" : ",") + json_number(v[c]);
    std::string triangles;
    for (const auto& t : s.triangles)
      for (std::uint32_t corner : t) triangles += (triangles.empty() ? "" : ",") + std::to_string(corner);
    shapes += (shapes.empty() ? "" : ",") + std::string("{\"vertices\":[") + vertices + "],\"triangles\":[" +
              triangles + "]}";
  }
  return "{\"origins\":" + quantised(origins, blob) + ",\"feet\":" + quantised(feet, blob) +
         ",\"frame\":" + blob.add("i8", frame) + ",\"length\":" + blob.add("f32", length) +
         ",\"shape\":" + blob.add("u8", shape) + ",\"shapes\":[" + shapes + "]}";
}

std::string scan(const PointCloud& cloud, const Vec3& foot, std::size_t limit, Blob& blob,
                 std::size_t& shown) {
  shown = std::min(cloud.size(), limit);
  std::vector<Vec3> points;
  points.reserve(shown);
  const Random random(20240501);
  for (const std::size_t k : shuffled(shown)) {
    // One point at random out of each of `shown` equal runs of the file.
    const std::size_t first = k * cloud.size() / shown;
    const std::size_t next = (k + 1) * cloud.size() / shown;
    const std::size_t pick = first + (next - first > 1 ? random.child({k}).below(next - first) : 0);
    points.push_back(cloud.points[pick] + cloud.origin_shift - foot);
  }
  return quantised(points, blob);
}

Vec3 lowest_point(const PointCloud& cloud) {
  const auto lowest = std::min_element(cloud.points.begin(), cloud.points.end(),
                                       [](const Vec3& a, const Vec3& b) { return a.z() < b.z(); });
  return cloud.origin_shift + *lowest;
}

}  // namespace

ScenePayload scene_payload(const ReportData& data, const ReportOptions& options) {
  Blob blob;
  ScenePayload payload;
  std::vector<std::string> layers;
  const Tree* model = data.model && !data.model->empty() ? data.model : nullptr;
  const Tree* regrown = data.regrown && !data.regrown->empty() ? data.regrown : nullptr;
  Vec3 foot = Vec3::Zero();
  if (model)
    foot = foot_of(*model);
  else if (data.scan && !data.scan->empty())
    foot = lowest_point(*data.scan);
  if (data.scan && !data.scan->empty())
    layers.push_back("\"scan\":" + scan(*data.scan, foot, static_cast<std::size_t>(options.max_scan_points),
                                        blob, payload.scan_shown));
  if (model) layers.push_back("\"model\":" + wood(*model, blob));
  if (regrown) layers.push_back("\"regrown\":" + wood(*regrown, blob));
  if (data.foliage && data.foliage->size() > 0) {
    const bool on_model = data.leaves_on_model || !regrown;
    const Tree* bearer = on_model ? model : regrown;
    const Vec3 leaf_foot = bearer ? foot_of(*bearer) : foot;
    layers.push_back("\"leaves\":" + leaves(*data.foliage, leaf_foot,
                                            static_cast<std::size_t>(options.max_leaves), blob,
                                            payload.leaves_shown));
    if (!data.foliage->twigs.empty())
      layers.push_back("\"shoots\":" + shoots(data.foliage->twigs, leaf_foot, blob));
    layers.push_back(std::string("\"leaves_on\":\"") + (on_model ? "model" : "regrown") + "\"");
  }
  for (const std::string& layer : layers)
    payload.directory += (payload.directory.empty() ? "{" : ",") + layer;
  payload.directory += payload.directory.empty() ? "{}" : "}";
  payload.binary = std::move(blob.bytes);
  return payload;
}

}  // namespace dendrofit
