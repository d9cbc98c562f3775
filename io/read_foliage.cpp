// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/read_foliage.h"

#include "io/coordinate_limit.h"
#include "io/file_bytes.h"
#include "io/json_numbers.h"

#include <cmath>
#include <vector>

#include <Eigen/Geometry>
#include <nlohmann/json.hpp>

namespace dendrofit {
namespace {

using Json = nlohmann::json;

Vec3 z_up(const Vec3& v) {
  return {v.x(), -v.z(), v.y()};
}

/// The two chunks of a binary glTF 2.0; every number it is asked for is checked.
class Glb {
 public:
  explicit Glb(const std::filesystem::path& path) : bytes_(path) {
    if (bytes_.number<std::uint32_t>(0, "magic number") != 0x46546C67 ||
        bytes_.number<std::uint32_t>(4, "version") != 2)
      fail_in_file(path, "not a binary glTF 2.0");
    const std::uint64_t length = bytes_.number<std::uint32_t>(12, "length of the JSON chunk");
    bytes_.need(20, length, "JSON chunk");
    try {
      json_ = Json::parse(bytes_.view().substr(20, length));
    } catch (const Json::exception& error) {
      fail_at_byte(path, 20, std::string("not JSON: ") + error.what());
    }
    data_size_ = bytes_.number<std::uint32_t>(20 + length, "length of the binary chunk");
    data_at_ = 28 + length;
    bytes_.need(data_at_, data_size_, "binary chunk");
  }

  const Json& json() const { return json_; }

  /// An accessor's numbers, `width` to an element.
  template <class Number>
  std::vector<Number> numbers(const Json& index, std::size_t width) const {
    const Json& accessor = json_.at("accessors").at(whole_number(index));
    const Json& view = json_.at("bufferViews").at(whole_number(accessor.at("bufferView")));
    const std::uint64_t offset =
        whole_number_or(view, "byteOffset", 0) + whole_number_or(accessor, "byteOffset", 0);
    const auto count = whole_number(accessor.at("count"));
    if (count > data_size_ || offset > data_size_ || count * width * sizeof(Number) > data_size_ - offset)
      fail_in_file(bytes_.path(), "an accessor reaches past the binary chunk");
    std::vector<Number> out(count * width);
    for (std::size_t i = 0; i < out.size(); ++i)
      out[i] = bytes_.number<Number>(data_at_ + offset + i * sizeof(Number), "an accessor's numbers");
    return out;
  }

 private:
  FileBytes bytes_;
  Json json_;
  std::uint64_t data_at_ = 0;
  std::uint64_t data_size_ = 0;
};

/// Where instances stand, about the origin shift, z up.
struct Placed {
  Vec3 at, scale;
  Vec3 x, y, z;  ///< unit
};

std::vector<Placed> instances_of(const Glb& glb, const Json& node) {
  const Json& attributes = node.at("extensions").at("EXT_mesh_gpu_instancing").at("attributes");
  const auto at = glb.numbers<float>(attributes.at("TRANSLATION"), 3);
  const auto turn = glb.numbers<float>(attributes.at("ROTATION"), 4);
  const auto scale = glb.numbers<float>(attributes.at("SCALE"), 3);
  std::vector<Placed> out;
  for (std::size_t i = 0; 3 * i < at.size() && 4 * i < turn.size() && 3 * i < scale.size(); ++i) {
    const Eigen::Matrix3d frame =
        Eigen::Quaterniond(turn[4 * i + 3], turn[4 * i], turn[4 * i + 1], turn[4 * i + 2])
            .normalized()
            .toRotationMatrix();
    const auto vector = [&](const std::vector<float>& v) {
      return Vec3(v[3 * i], v[3 * i + 1], v[3 * i + 2]);
    };
    out.push_back(
        {z_up(vector(at)), vector(scale), z_up(frame.col(0)), z_up(frame.col(1)), z_up(frame.col(2))});
  }
  return out;
}

LeafShape shape_of(const Glb& glb, const Json& node) {
  const Json& primitive = glb.json().at("meshes").at(whole_number(node.at("mesh"))).at("primitives").at(0);
  LeafShape shape;
  const auto vertices = glb.numbers<float>(primitive.at("attributes").at("POSITION"), 3);
  for (std::size_t i = 0; i + 2 < vertices.size(); i += 3)
    shape.vertices.emplace_back(vertices[i], vertices[i + 1], vertices[i + 2]);
  const auto corners = glb.numbers<std::uint32_t>(primitive.at("indices"), 1);
  for (std::size_t i = 0; i + 2 < corners.size(); i += 3)
    shape.triangles.push_back({corners[i], corners[i + 1], corners[i + 2]});
  shape.name = "shape " + std::to_string(whole_number(node.at("mesh")) + 1);
  return shape;
}

/// Petioles come in the order of the leaves; those of leaves that sit on the wood are missing.
void add_petioles(const std::vector<Placed>& petioles, Foliage& foliage) {
  constexpr double kNear = 1e-4;
  std::size_t next = 0;
  for (Leaf& leaf : foliage.leaves) {
    if (next == petioles.size()) return;
    const Placed& p = petioles[next];
    if ((p.at + p.scale.y() * p.y - leaf.origin).norm() > kNear) continue;
    leaf.petiole_foot = p.at;
    foliage.shapes[leaf.shape].petiole_width = p.scale.x() / leaf.length_m;
    ++next;
  }
}

}  // namespace

Foliage read_foliage_glb(const std::filesystem::path& path) {
  const Glb glb(path);
  Foliage foliage;
  try {
    const Json& nodes = glb.json().at("nodes");
    const Json& shift = nodes.at(0).at("translation");
    foliage.origin_shift = z_up(Vec3(shift.at(0), shift.at(1), shift.at(2)));
    if (!is_place(foliage.origin_shift)) fail_in_file(path, "an origin beyond 1e9 m");
    std::vector<Placed> petioles;
    for (const Json& node : nodes) {
      const std::string name = node.value("name", "");
      if (name == "petioles") petioles = instances_of(glb, node);
      if (name != "leaves") continue;
      if (foliage.shapes.size() == 65535) fail_in_file(path, "more than 65,535 leaf shapes");
      foliage.shapes.push_back(shape_of(glb, node));
      for (const Placed& p : instances_of(glb, node)) {
        Leaf leaf;
        leaf.origin = leaf.petiole_foot = p.at;
        leaf.direction = p.y;
        leaf.normal = p.z;
        leaf.length_m = p.scale.y();
        leaf.shape = static_cast<std::uint16_t>(foliage.shapes.size() - 1);
        if (!is_place(leaf.origin) || !leaf.normal.allFinite() || !leaf.direction.allFinite() ||
            !(leaf.length_m > 0 && leaf.length_m <= kLargestCoordinate))
          fail_in_file(path, "a leaf's place, turn or size is not a finite number up to 1e9 m");
        foliage.leaves.push_back(leaf);
      }
    }
    add_petioles(petioles, foliage);
  } catch (const Json::exception& error) {
    fail_in_file(path, std::string("not a scene of leaves as dendrofit writes it: ") + error.what());
  }
  if (foliage.shapes.empty())
    fail_in_file(path, "no leaves in it as dendrofit writes them (instances of a mesh, in a node `leaves`)");
  for (const LeafShape& shape : foliage.shapes) {
    for (const auto& t : shape.triangles)
      for (const std::uint32_t corner : t)
        if (corner >= shape.vertices.size())
          fail_in_file(path, "a leaf shape names a vertex that does not exist");
    for (const Vec3& v : shape.vertices)
      if (!is_place(v))
        fail_in_file(path, "a leaf shape with a coordinate that is not a finite number up to 1e9 m");
    if (shape.triangles.empty()) fail_in_file(path, "a leaf shape without triangles");
  }
  return foliage;
}

}  // namespace dendrofit
