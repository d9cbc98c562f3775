// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/file_info.h"

#include "core/errors.h"
#include "io/cloud_formats.h"
#include "io/glb_info.h"
#include "io/las_format.h"
#include "io/metrics_json.h"
#include "io/ply_file.h"
#include "io/read_cloud.h"
#include "io/read_mesh.h"
#include "io/read_table.h"
#include "io/read_tree.h"
#include "io/text_numbers.h"
#include "io/tree_formats.h"

namespace dendrofit {
namespace {

Bounds world_bounds(const std::vector<Vec3>& points, const Vec3& shift) {
  Bounds bounds;
  for (const Vec3& p : points) bounds.add(p + shift);
  return bounds;
}

void describe_mesh(FileInfo& info, const std::filesystem::path& path, const char* format) {
  const TriangleMesh mesh = read_mesh(path);
  info.kind = "mesh";
  info.format = format;
  info.rows = mesh.triangles.size();
  info.bounds = world_bounds(mesh.vertices, mesh.origin_shift);
  info.details.emplace_back("vertices", std::to_string(mesh.vertices.size()));
}

void describe_cloud(FileInfo& info, const FileBytes& bytes, Progress& progress) {
  const CloudFormat format = cloud_format_of(bytes);
  info.kind = "cloud";
  info.format = to_string(format);
  info.cloud = read_point_cloud(bytes.path(), {}, progress);
  info.crs_wkt = info.cloud->crs_wkt;
  info.bounds = world_bounds(info.cloud->points, info.cloud->origin_shift);
  if (format == CloudFormat::las || format == CloudFormat::laz) {
    const LasHeader header = read_las_header(bytes);
    info.details.emplace_back("version", std::to_string(header.major) + "." + std::to_string(header.minor));
    info.details.emplace_back("point format", std::to_string(header.point_format));
    std::string step;
    append_number(step, header.scale[0]);
    info.details.emplace_back("coordinate step", step);
    LasFrame frame;
    for (int k = 0; k < 3; ++k) {
      frame.step[k] = header.scale[k];
      frame.offset[k] = header.offset[k];
    }
    for (const LasRecord& record : header.projection)
      frame.projection.emplace_back(record.id, record.content);
    info.frame = frame;
    if (!header.software.empty()) info.details.emplace_back("written by", header.software);
  }
}

void describe_glb(FileInfo& info, const FileBytes& bytes) {
  const GlbInfo glb = read_glb_info(bytes);
  info.kind = "mesh";
  info.format = "glb";
  info.rows = glb.triangles;
  info.bounds = glb.bounds;
  info.details.emplace_back("vertices", std::to_string(glb.vertices));
  if (glb.instances > 0) info.details.emplace_back("instances", std::to_string(glb.instances));
}

void describe_tree(FileInfo& info, const std::filesystem::path& path) {
  info.kind = "tree";
  info.format = to_string(tree_format_of(path));
  info.tree = read_tree(path);
  info.crs_wkt = crs_beside(path);
  for (const auto* ends : {&info.tree->start, &info.tree->end})
    for (const Vec3& p : *ends) info.bounds.add(p + info.tree->origin_shift);
}

void describe_table(FileInfo& info, const std::filesystem::path& path) {
  const std::vector<MeasurementSeries> all = read_measurements(path);
  info.kind = "table";
  info.format = "measurements";
  info.series = all.size();
  for (const MeasurementSeries& series : all) info.rows += series.time.size();
}

bool has_columns(const FileBytes& bytes, std::string_view a, std::string_view b) {
  if (bytes.view().substr(0, 4096).find('\0') != std::string_view::npos) return false;
  const CsvTable table(bytes);
  return table.find(a) >= 0 && table.find(b) >= 0;
}

bool is_tree(const std::filesystem::path& path) {
  try {
    tree_format_of(path);
    return true;
  } catch (const IoError&) {
    return false;
  }
}

bool is_obj(const FileBytes& bytes) {
  return lower(bytes.path().extension().string()) == ".obj";
}

}  // namespace

FileInfo describe_file(const std::filesystem::path& path, Progress& progress) {
  const FileBytes bytes(path);
  FileInfo info;
  info.bytes = bytes.size();
  const std::string_view view = bytes.view();
  if (view.starts_with("glTF")) {
    describe_glb(info, bytes);
  } else if (view.starts_with("LASF") || view.starts_with("ASTM-E57")) {
    describe_cloud(info, bytes, progress);
  } else if (view.starts_with("ply")) {
    const PlyElement* face = nullptr;
    const PlyHeader header = read_ply_header(bytes);
    face = header.find("face");
    if (face && face->count > 0)
      describe_mesh(info, path, "ply");
    else
      describe_cloud(info, bytes, progress);
  } else if (is_obj(bytes)) {
    describe_mesh(info, path, "obj");
  } else if (is_tree(path)) {
    describe_tree(info, path);
  } else if (has_columns(bytes, "time", "value")) {
    describe_table(info, path);
  } else {
    describe_cloud(info, bytes, progress);
  }
  return info;
}

}  // namespace dendrofit
