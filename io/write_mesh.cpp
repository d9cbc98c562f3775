// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/write_mesh.h"

#include "core/atomic_file.h"
#include "core/errors.h"
#include "io/glb.h"
#include "io/text_numbers.h"

#include <bit>
#include <cstdint>
#include <string>

namespace dendrofit {
namespace {

constexpr int kDecimals = 6;  // of coordinates in text: micrometres

constexpr const char* kObjHead = "# dendrofit, metres, z up\n";

void append_vertex(std::string& text, const Vec3& world) {
  text += 'v';
  for (int k = 0; k < 3; ++k) {
    text += ' ';
    append_fixed(text, world[k], kDecimals);
  }
  text += '\n';
}

void append_face(std::string& text, const std::array<std::uint32_t, 3>& triangle) {
  text += 'f';
  for (const std::uint32_t v : triangle) {
    text += ' ';
    append_number(text, std::int64_t{v} + 1);
  }
  text += '\n';
}

void write_obj(const std::filesystem::path& path, const TriangleMesh& mesh) {
  std::string text = kObjHead;
  text.reserve(mesh.vertices.size() * 40 + mesh.triangles.size() * 24);
  for (const Vec3& v : mesh.vertices) append_vertex(text, v + mesh.origin_shift);
  for (const auto& t : mesh.triangles) append_face(text, t);
  write_file(path, text);
}

void write_ply(const std::filesystem::path& path, const TriangleMesh& mesh) {
  static_assert(std::endian::native == std::endian::little);
  std::string data =
      "ply\nformat binary_little_endian 1.0\ncomment written by dendrofit, metres, z up\nelement vertex " +
      std::to_string(mesh.vertices.size()) +
      "\nproperty double x\nproperty double y\nproperty double z\nelement face " +
      std::to_string(mesh.triangles.size()) + "\nproperty list uchar int vertex_indices\nend_header\n";
  data.reserve(data.size() + mesh.vertices.size() * 24 + mesh.triangles.size() * 13);
  for (const Vec3& v : mesh.vertices) {
    const Vec3 world = v + mesh.origin_shift;
    data.append(reinterpret_cast<const char*>(world.data()), 24);
  }
  for (const auto& t : mesh.triangles) {
    data += '\3';
    data.append(reinterpret_cast<const char*>(t.data()), 12);
  }
  write_file(path, data);
}

void check_foliage(const Foliage& foliage) {
  for (const LeafShape& shape : foliage.shapes) shape.validate();
  for (std::size_t i = 0; i < foliage.size(); ++i) {
    const Leaf& leaf = foliage.leaves[i];
    const std::string where = "leaf " + std::to_string(i + 1) + ": ";
    if (leaf.shape >= foliage.shapes.size())
      throw InputError(where + "shape " + std::to_string(leaf.shape) + " does not exist");
    if (!leaf.origin.allFinite() || !leaf.direction.allFinite() || !leaf.normal.allFinite() ||
        !(leaf.length_m > 0))
      throw InputError(where + "place, direction or length is not a finite positive number");
  }
}

TriangleMesh petioles(const Foliage& foliage) {
  check_foliage(foliage);
  TriangleMesh mesh;
  mesh.origin_shift = foliage.origin_shift;
  for (std::size_t i = 0; i < foliage.size(); ++i) foliage.append_petiole(i, mesh);
  return mesh;
}

TriangleMesh blades(const Foliage& foliage) {
  check_foliage(foliage);
  TriangleMesh mesh;
  mesh.origin_shift = foliage.origin_shift;
  for (std::size_t i = 0; i < foliage.size(); ++i) foliage.append_blade(i, mesh);
  return mesh;
}

std::string csv_field(const std::string& text) {
  if (text.find_first_of(",\"\n\r") == std::string::npos) return text;
  std::string quoted_text = "\"";
  for (const char c : text)
    quoted_text += c == '"' ? std::string("\"\"") : std::string(1, c == '\n' || c == '\r' ? ' ' : c);
  return quoted_text + "\"";
}

}  // namespace

void write_mesh(const std::filesystem::path& path, const TriangleMesh& mesh) {
  mesh.validate();
  const std::string extension = lower(path.extension().string());
  if (extension == ".obj") return write_obj(path, mesh);
  if (extension == ".ply") return write_ply(path, mesh);
  if (extension == ".glb") return write_glb(path, &mesh, nullptr);
  throw IoError(path.string() + ": meshes are written as .obj, .ply or .glb, not '" + extension + "'");
}

void write_tree_obj(const std::filesystem::path& path, const Tree& tree, const TreeMeshOptions& options) {
  write_obj(path, tree_mesh(tree, options));
}

void write_tree_ply(const std::filesystem::path& path, const Tree& tree, const TreeMeshOptions& options) {
  write_ply(path, tree_mesh(tree, options));
}

void write_tree_glb(const std::filesystem::path& path, const Tree& tree, const TreeMeshOptions& options) {
  const TriangleMesh mesh = tree_mesh(tree, options);
  write_glb(path, &mesh, nullptr);
}

void write_foliage_obj(const std::filesystem::path& path, const Foliage& foliage) {
  write_obj(path, blades(foliage));
}

void write_foliage_ply(const std::filesystem::path& path, const Foliage& foliage) {
  write_ply(path, blades(foliage));
}

void write_petioles_obj(const std::filesystem::path& path, const Foliage& foliage) {
  check_foliage(foliage);
  std::string text = kObjHead;
  text.reserve(foliage.size() * 220);
  std::uint32_t first = 0;
  for (std::size_t i = 0; i < foliage.size(); ++i) {
    std::array<Vec3, 4> corners;
    if (!petiole_corners(foliage.leaves[i], foliage.shapes[foliage.leaves[i].shape], corners)) continue;
    text += "g leaf_";
    append_number(text, static_cast<std::int64_t>(i) + 1);
    text += '\n';
    for (const Vec3& corner : corners) append_vertex(text, corner + foliage.origin_shift);
    append_face(text, {first, first + 1, first + 2});
    append_face(text, {first, first + 2, first + 3});
    first += 4;
  }
  write_file(path, text);
}

void write_petioles_ply(const std::filesystem::path& path, const Foliage& foliage) {
  write_ply(path, petioles(foliage));
}

void write_foliage_glb(const std::filesystem::path& path, const Foliage& foliage) {
  check_foliage(foliage);
  write_glb(path, nullptr, &foliage);
}

void write_scene_glb(const std::filesystem::path& path, const Tree& tree, const Foliage& foliage,
                     const TreeMeshOptions& options) {
  check_foliage(foliage);
  if (!foliage.leaves.empty() && foliage.origin_shift != tree.origin_shift)
    throw InputError("tree and leaves of one scene have different origin shifts");
  const TriangleMesh mesh = tree_mesh(tree, options);
  write_glb(path, &mesh, &foliage);
}

void write_leaves_csv(const std::filesystem::path& path, const Foliage& foliage) {
  check_foliage(foliage);
  std::string text = "id,cylinder,x,y,z,normal_x,normal_y,normal_z,length_m,area_m2,species\n";
  const std::string species = csv_field(foliage.species);
  for (std::size_t i = 0; i < foliage.size(); ++i) {
    const Leaf& leaf = foliage.leaves[i];
    append_number(text, static_cast<std::int64_t>(i) + 1);
    text += ',';
    append_number(text, std::int64_t{leaf.node} + 1);
    text += ',';
    const Vec3 world = leaf.origin + foliage.origin_shift;
    for (const double value : {world.x(), world.y(), world.z(), leaf.normal.x(), leaf.normal.y(),
                               leaf.normal.z(), leaf.length_m, foliage.leaf_area(i)}) {
      append_number(text, value);
      text += ',';
    }
    text += species + '\n';
  }
  write_file(path, text);
}

}  // namespace dendrofit
