// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/cloud_formats.h"
#include "io/ply_file.h"
#include "io/text_numbers.h"

#include <algorithm>
#include <cmath>

namespace dendrofit {
namespace {

int find_any(const PlyElement& vertex, std::initializer_list<std::string_view> names) {
  for (std::size_t k = 0; k < vertex.properties.size(); ++k) {
    const std::string name = lower(vertex.properties[k].name);
    if (!vertex.properties[k].is_list && std::find(names.begin(), names.end(), name) != names.end())
      return static_cast<int>(k);
  }
  return -1;
}

std::uint8_t class_from(double value) {
  return value >= 0 && value <= 255 ? static_cast<std::uint8_t>(value) : std::uint8_t{0};
}

}  // namespace

PointCloud read_ply_cloud(const FileBytes& bytes, Progress& progress) {
  const PlyHeader header = read_ply_header(bytes);
  const PlyElement* vertex = header.find("vertex");
  if (!vertex) fail_at_line(bytes.path(), header.lines, "no 'element vertex' in the header; expected points");
  const int column[3] = {find_any(*vertex, {"x"}), find_any(*vertex, {"y"}), find_any(*vertex, {"z"})};
  for (int k = 0; k < 3; ++k)
    if (column[k] < 0)
      fail_at_line(bytes.path(), header.lines,
                   std::string("the vertices have no property '") + "xyz"[k] + "'");
  const int intensity =
      find_any(*vertex, {"intensity", "scalar_intensity", "reflectance", "scalar_reflectance"});
  const int classes = find_any(
      *vertex, {"classification", "class", "label", "scalar_classification", "scalar_class", "scalar_label"});

  PlyCursor cursor(bytes, header);
  for (const PlyElement& e : header.elements) {
    if (&e == vertex) break;
    for (std::uint64_t i = 0; i < e.count; ++i) cursor.skip(e);
  }
  PointCloud cloud;
  cloud.crs_wkt = header.crs;
  cloud.points.reserve(vertex->count);
  if (intensity >= 0) cloud.intensity.reserve(vertex->count);
  if (classes >= 0) cloud.classification.reserve(vertex->count);
  PointTicker ticker(progress, "reading", static_cast<double>(vertex->count));
  const auto add = [&](const auto& value_of) {
    const Vec3 p(value_of(column[0]), value_of(column[1]), value_of(column[2]));
    if (!p.allFinite())
      cursor.fail("point " + std::to_string(cloud.size() + 1) +
                  " has a coordinate that is not a finite number; remove it");
    cloud.points.push_back(p);
    if (intensity >= 0) cloud.intensity.push_back(static_cast<float>(value_of(intensity)));
    if (classes >= 0) cloud.classification.push_back(class_from(value_of(classes)));
    ticker.tick();
  };
  if (!header.ascii && !vertex->has_lists()) {
    const std::size_t stride = vertex->stride();
    std::vector<std::size_t> at;
    std::size_t sum = 0;
    for (const PlyProperty& p : vertex->properties) {
      at.push_back(sum);
      sum += ply_width(p.type);
    }
    bytes.need(cursor.offset(), stride * vertex->count, "last point");
    const std::uint64_t first = cursor.offset();
    for (std::uint64_t i = 0; i < vertex->count; ++i) {
      const char* record = bytes.data() + first + i * stride;
      cursor.seek(first + i * stride);
      add([&](int k) {
        const auto c = static_cast<std::size_t>(k);
        return ply_number(vertex->properties[c].type, record + at[c], header.order);
      });
    }
    return cloud;
  }
  std::vector<double> values(vertex->properties.size());
  for (std::uint64_t i = 0; i < vertex->count; ++i) {
    for (std::size_t k = 0; k < values.size(); ++k) {
      const PlyProperty& p = vertex->properties[k];
      if (p.is_list) {
        const std::uint64_t n = cursor.next_count(p.count_type);
        for (std::uint64_t j = 0; j < n; ++j) cursor.next(p.type);
      } else {
        values[k] = cursor.next(p.type);
      }
    }
    add([&](int k) { return values[static_cast<std::size_t>(k)]; });
  }
  return cloud;
}

}  // namespace dendrofit
