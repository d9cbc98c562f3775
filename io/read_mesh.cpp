// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/read_mesh.h"

#include "io/coordinate_limit.h"
#include "io/csv_table.h"
#include "io/file_bytes.h"
#include "io/ply_file.h"
#include "io/text_numbers.h"

#include <cmath>

namespace dendrofit {
namespace {

void add_fan(TriangleMesh& mesh, const std::vector<std::uint32_t>& polygon) {
  for (std::size_t k = 2; k < polygon.size(); ++k)
    mesh.triangles.push_back({polygon[0], polygon[k - 1], polygon[k]});
}

TriangleMesh read_ply_mesh(const FileBytes& bytes) {
  const PlyHeader header = read_ply_header(bytes);
  const PlyElement* vertex = header.find("vertex");
  const PlyElement* face = header.find("face");
  if (!vertex || vertex->find("x") < 0 || vertex->find("y") < 0 || vertex->find("z") < 0)
    fail_at_line(bytes.path(), header.lines, "no vertices with x, y and z in the header");
  if (!face || face->count == 0)
    fail_at_line(bytes.path(), header.lines,
                 "no faces in the header; a surface was expected, this is a point cloud");
  TriangleMesh mesh;
  PlyCursor cursor(bytes, header);
  std::vector<std::uint32_t> polygon;
  for (const PlyElement& e : header.elements) {
    for (std::uint64_t i = 0; i < e.count; ++i) {
      if (&e == vertex) {
        Vec3 v;
        for (const PlyProperty& p : e.properties) {
          const std::uint64_t n = p.is_list ? cursor.next_count(p.count_type) : 1;
          for (std::uint64_t k = 0; k < n; ++k) {
            const double value = cursor.next(p.type);
            if (p.is_list) continue;
            if (p.name == "x") v.x() = value;
            if (p.name == "y") v.y() = value;
            if (p.name == "z") v.z() = value;
          }
        }
        if (!is_place(v))
          cursor.fail("vertex " + std::to_string(i + 1) +
                      " has a coordinate that is not a finite number up to 1e9 m");
        mesh.vertices.push_back(v);
      } else if (&e == face) {
        for (const PlyProperty& p : e.properties) {
          const bool corners = p.is_list && (p.name == "vertex_indices" || p.name == "vertex_index");
          const std::uint64_t n = p.is_list ? cursor.next_count(p.count_type) : 1;
          polygon.clear();
          for (std::uint64_t k = 0; k < n; ++k) {
            const double value = cursor.next(p.type);
            if (!corners) continue;
            if (!(value >= 0 && value < static_cast<double>(vertex->count)) || value != std::floor(value))
              cursor.fail("face " + std::to_string(i + 1) + " names a vertex that does not exist");
            polygon.push_back(static_cast<std::uint32_t>(value));
          }
          add_fan(mesh, polygon);
        }
      } else {
        cursor.skip(e);
      }
    }
  }
  if (mesh.triangles.empty())
    fail_at_line(bytes.path(), header.lines, "no face with three corners (property vertex_indices)");
  mesh.validate();
  return mesh;
}

TriangleMesh read_obj(const FileBytes& bytes) {
  require_text(bytes);
  const std::string_view view = bytes.view();
  TriangleMesh mesh;
  std::vector<std::uint32_t> polygon;
  std::size_t line = 0;
  for (std::size_t at = text_start(bytes); at < view.size();) {
    const std::size_t end = std::min(view.find('\n', at), view.size());
    std::string_view rest = trimmed(view.substr(at, end - at));
    at = end + 1;
    ++line;
    const auto word = [&] {
      const std::size_t stop = std::min(rest.find_first_of(" \t"), rest.size());
      const std::string_view found = rest.substr(0, stop);
      rest = trimmed(rest.substr(stop));
      return found;
    };
    const std::string_view kind = word();
    if (kind == "v") {
      Vec3 v;
      for (int k = 0; k < 3; ++k) {
        const std::string_view field = word();
        if (!number_from(field, v[k]) || !std::isfinite(v[k]))
          fail_at_line(bytes.path(), line, shown(field) + " found, a coordinate expected");
      }
      if (!is_place(v)) fail_at_line(bytes.path(), line, "a coordinate beyond 1e9 m; are its units metres?");
      mesh.vertices.push_back(v);
    } else if (kind == "f") {
      polygon.clear();
      while (!rest.empty()) {
        const std::string_view corner = word();
        std::int64_t index = 0;
        const auto count = static_cast<std::int64_t>(mesh.vertices.size());
        if (!integer_from(corner.substr(0, corner.find('/')), index) || index == 0 || index > count ||
            index < -count)
          fail_at_line(bytes.path(), line,
                       shown(corner) + " found, the number of one of the " + std::to_string(count) +
                           " vertices before it expected");
        polygon.push_back(static_cast<std::uint32_t>(index > 0 ? index - 1 : count + index));
      }
      if (polygon.size() < 3)
        fail_at_line(bytes.path(), line, "a face with fewer than three corners (truncated file?)");
      add_fan(mesh, polygon);
    }
  }
  if (mesh.triangles.empty()) fail_in_file(bytes.path(), "no faces; expected an OBJ or PLY surface");
  mesh.validate();
  return mesh;
}

}  // namespace

TriangleMesh read_mesh(const std::filesystem::path& path) {
  const FileBytes bytes(path);
  return bytes.view().starts_with("ply") ? read_ply_mesh(bytes) : read_obj(bytes);
}

}  // namespace dendrofit
