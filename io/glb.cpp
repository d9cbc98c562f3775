// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/glb.h"

#include "core/atomic_file.h"
#include "core/errors.h"
#include "io/text_numbers.h"

#include <bit>
#include <cstdint>
#include <string>

#include <Eigen/Geometry>

namespace dendrofit {
namespace {

Vec3 y_up(const Vec3& v) {
  return {v.x(), v.z(), -v.y()};
}

std::string numbers(const Vec3& v) {
  std::string text;
  for (int k = 0; k < 3; ++k) {
    if (k > 0) text += ',';
    append_number(text, v[k]);
  }
  return text;
}

// Gathers buffer, views, accessors, meshes and nodes.
class Scene {
 public:
  Scene() { static_assert(std::endian::native == std::endian::little); }

  std::string positions(const std::vector<Vec3>& points) {
    Vec3 lo = Vec3::Constant(1e300);
    Vec3 hi = -lo;
    for (const Vec3& p : points) {
      const Vec3 single = p.cast<float>().cast<double>();
      lo = lo.cwiseMin(single);
      hi = hi.cwiseMax(single);
      put(p);
    }
    return accessor(points.size(), 12, "5126", "VEC3", 34962,
                    ",\"min\":[" + numbers(lo) + "],\"max\":[" + numbers(hi) + "]");
  }
  std::string vectors(const std::vector<Vec3>& values, int target) {
    for (const Vec3& v : values) put(v);
    return accessor(values.size(), 12, "5126", "VEC3", target);
  }
  std::string rotations(const std::vector<Eigen::Quaterniond>& values) {
    for (const Eigen::Quaterniond& q : values)
      for (const double c : {q.x(), q.y(), q.z(), q.w()}) put(static_cast<float>(c));
    return accessor(values.size(), 16, "5126", "VEC4", 0);
  }
  std::string indices(const std::vector<std::array<std::uint32_t, 3>>& triangles) {
    for (const auto& t : triangles)
      for (const std::uint32_t v : t) put(v);
    return accessor(triangles.size() * 3, 4, "5125", "SCALAR", 34963);
  }

  /// Returns the mesh's index. Vertices as given; normals are the area-weighted means of the triangles'.
  std::string mesh(const std::vector<Vec3>& vertices,
                   const std::vector<std::array<std::uint32_t, 3>>& triangles, int material) {
    std::vector<Vec3> normals(vertices.size(), Vec3::Zero());
    for (const auto& t : triangles) {
      const Vec3 n = (vertices[t[1]] - vertices[t[0]]).cross(vertices[t[2]] - vertices[t[0]]);
      for (const std::uint32_t v : t) normals[v] += n;
    }
    for (Vec3& n : normals) n = n.norm() > 0 ? Vec3(n.normalized()) : Vec3::UnitZ();
    const std::string position = positions(vertices);
    const std::string normal = vectors(normals, 34962);
    const std::string index = indices(triangles);
    join(meshes_, "{\"primitives\":[{\"attributes\":{\"POSITION\":" + position + ",\"NORMAL\":" + normal +
                      "},\"indices\":" + index + ",\"material\":" + std::to_string(material) + "}]}");
    return std::to_string(mesh_count_++);
  }

  void node(const std::string& json) {
    join(nodes_, json);
    join(children_, std::to_string(++node_count_));  // node 0 is the root
  }

  void write(const std::filesystem::path& path, const Vec3& shift, bool instances) {
    std::string json = "{\"asset\":{\"version\":\"2.0\",\"generator\":\"dendrofit\"},";
    if (instances)
      json +=
          "\"extensionsUsed\":[\"EXT_mesh_gpu_instancing\"],\"extensionsRequired\":[\"EXT_mesh_gpu_"
          "instancing\"],";
    json += "\"scene\":0,\"scenes\":[{\"nodes\":[0]}],\"nodes\":[{\"name\":\"tree\",\"translation\":[" +
            numbers(y_up(shift)) + "],\"children\":[" + children_ + "]}," + nodes_ + "],\"meshes\":[" +
            meshes_ + "],\"materials\":[" + material("wood", "0.36,0.25,0.16", false) + "," +
            material("leaf", "0.24,0.45,0.12", true) + "],\"accessors\":[" + accessors_ +
            "],\"bufferViews\":[" + views_ +
            "],\"buffers\":[{\"byteLength\":" + std::to_string(buffer_.size()) + "}]}";
    json.resize((json.size() + 3) / 4 * 4, ' ');
    const std::uint64_t total = 12 + 8 + json.size() + 8 + buffer_.size();
    if (total > UINT32_MAX)
      throw InputError(path.string() +
                       ": more than 4 GiB, which binary glTF cannot hold; write .ply instead");
    AtomicFile file(path);
    const auto word = [&](std::uint64_t value) {
      const auto w = static_cast<std::uint32_t>(value);
      file.stream().write(reinterpret_cast<const char*>(&w), 4);
    };
    word(0x46546C67);  // "glTF"
    word(2);
    word(total);
    word(json.size());
    word(0x4E4F534A);  // "JSON"
    file.stream().write(json.data(), static_cast<std::streamsize>(json.size()));
    word(buffer_.size());
    word(0x004E4942);  // "BIN"
    file.stream().write(buffer_.data(), static_cast<std::streamsize>(buffer_.size()));
    file.commit();
  }

 private:
  template <class Number>
  void put(Number value) requires(sizeof(Number) == 4) {
    buffer_.append(reinterpret_cast<const char*>(&value), 4);
  }
  void put(const Vec3& v) {
    for (int k = 0; k < 3; ++k) put(static_cast<float>(v[k]));
  }
  static void join(std::string& list, const std::string& entry) { list += (list.empty() ? "" : ",") + entry; }
  static std::string material(const std::string& name, const std::string& colour, bool both_sides) {
    return "{\"name\":\"" + name + "\",\"pbrMetallicRoughness\":{\"baseColorFactor\":[" + colour +
           ",1],\"metallicFactor\":0,\"roughnessFactor\":0.9}" + (both_sides ? ",\"doubleSided\":true" : "") +
           "}";
  }
  // Describes the bytes put since the last accessor.
  std::string accessor(std::size_t count, std::size_t width, const char* component, const char* type,
                       int target, const std::string& limits = "") {
    const std::size_t bytes = count * width;
    join(views_, "{\"buffer\":0,\"byteOffset\":" + std::to_string(buffer_.size() - bytes) +
                     ",\"byteLength\":" + std::to_string(bytes) +
                     (target ? ",\"target\":" + std::to_string(target) : "") + "}");
    join(accessors_, "{\"bufferView\":" + std::to_string(accessor_count_) +
                         ",\"componentType\":" + component + ",\"count\":" + std::to_string(count) +
                         ",\"type\":\"" + type + "\"" + limits + "}");
    return std::to_string(accessor_count_++);
  }

  std::string buffer_;
  std::string views_;
  std::string accessors_;
  std::string meshes_;
  std::string nodes_;
  std::string children_;
  int accessor_count_ = 0;
  int mesh_count_ = 0;
  int node_count_ = 0;
};

Eigen::Quaterniond turned_y_up(const Vec3& x, const Vec3& y, const Vec3& z) {
  Eigen::Matrix3d to_y_up, frame;
  to_y_up << 1, 0, 0, 0, 0, 1, 0, -1, 0;
  frame << x, y, z;
  return Eigen::Quaterniond(Eigen::Matrix3d(to_y_up * frame)).normalized();
}

// One mesh drawn at many places.
struct Instances {
  std::vector<Vec3> places;
  std::vector<Vec3> scales;
  std::vector<Eigen::Quaterniond> turns;

  void write(Scene& scene, const std::string& name, const std::string& mesh) const {
    const std::string place = scene.vectors(places, 0);
    const std::string turn = scene.rotations(turns);
    const std::string scale = scene.vectors(scales, 0);
    scene.node("{\"name\":\"" + name + "\",\"mesh\":" + mesh +
               ",\"extensions\":{\"EXT_mesh_gpu_instancing\":{\"attributes\":{\"TRANSLATION\":" + place +
               ",\"ROTATION\":" + turn + ",\"SCALE\":" + scale + "}}}}");
  }
};

// Strips of the width and length core/foliage.h gives them, in the order in which the leaves are drawn.
void add_petioles(Scene& scene, const Foliage& foliage) {
  Instances strips;
  std::array<Vec3, 4> corner;
  for (std::size_t s = 0; s < foliage.shapes.size(); ++s)
    for (const Leaf& leaf : foliage.leaves) {
      if (leaf.shape != s || !petiole_corners(leaf, foliage.shapes[s], corner)) continue;
      const Vec3 along = leaf.origin - leaf.petiole_foot;
      const Vec3 across = (corner[1] - corner[0]).normalized();
      const Vec3 y = along.normalized();
      const Vec3 x = (across - across.dot(y) * y).normalized();
      strips.places.push_back(y_up(leaf.petiole_foot));
      strips.scales.push_back(Vec3((corner[1] - corner[0]).norm(), along.norm(), 1));
      strips.turns.push_back(turned_y_up(x, y, x.cross(y)));
    }
  if (strips.places.empty()) return;
  strips.write(scene, "petioles",
               scene.mesh({{-0.5, 0, 0}, {0.5, 0, 0}, {0.5, 1, 0}, {-0.5, 1, 0}}, {{0, 1, 2}, {0, 2, 3}}, 1));
}

void add_wood(Scene& scene, const std::string& name, const TriangleMesh& wood) {
  std::vector<Vec3> vertices;
  vertices.reserve(wood.vertices.size());
  for (const Vec3& v : wood.vertices) vertices.push_back(y_up(v));
  scene.node("{\"name\":\"" + name + "\",\"mesh\":" + scene.mesh(vertices, wood.triangles, 0) + "}");
}

void add_leaves(Scene& scene, const Foliage& foliage) {
  for (std::size_t s = 0; s < foliage.shapes.size(); ++s) {
    Instances blades;
    for (const Leaf& leaf : foliage.leaves) {
      if (leaf.shape != s) continue;
      blades.places.push_back(y_up(leaf.origin));
      blades.scales.push_back(Vec3::Constant(leaf.length_m));
      blades.turns.push_back(turned_y_up(leaf.direction.cross(leaf.normal), leaf.direction, leaf.normal));
    }
    if (blades.places.empty()) continue;
    blades.write(scene, "leaves", scene.mesh(foliage.shapes[s].vertices, foliage.shapes[s].triangles, 1));
  }
  add_petioles(scene, foliage);
  if (!foliage.twigs.empty()) add_wood(scene, "added_twigs", tree_mesh(foliage.twigs));
}

}  // namespace

void write_glb(const std::filesystem::path& path, const TriangleMesh* wood, const Foliage* foliage) {
  const bool has_wood = wood && !wood->triangles.empty();
  const bool has_leaves = foliage && !foliage->leaves.empty();
  if (!has_wood && !has_leaves)
    throw InputError(path.string() + ": a scene without wood and leaves is not written");
  Scene scene;
  if (has_wood) add_wood(scene, "wood", *wood);
  if (has_leaves) add_leaves(scene, *foliage);
  scene.write(path, has_wood ? wood->origin_shift : foliage->origin_shift, has_leaves);
}

}  // namespace dendrofit
