// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/glb_info.h"

#include "io/json_numbers.h"

#include <cmath>

#include <nlohmann/json.hpp>

namespace dendrofit {
namespace {

using Json = nlohmann::json;

constexpr std::uint32_t kJsonChunk = 0x4E4F534A;
constexpr std::size_t kDeepest = 64;  // nodes within nodes

class Scene {
 public:
  Scene(const FileBytes& bytes, const Json& json) : bytes_(bytes), json_(json) {}

  GlbInfo read() {
    for (const Json& primitive_owner : list("meshes"))
      for (const Json& primitive : primitive_owner.at("primitives"))
        info_.vertices += whole_number(accessor(primitive.at("attributes").at("POSITION")).at("count"));
    const Json& scenes = list("scenes");
    if (!scenes.empty())
      for (const Json& node : scenes.at(whole_number_or(json_, "scene", 0)).value("nodes", Json::array()))
        visit(node, Vec3::Zero(), 0);
    return info_;
  }

 private:
  const Json& list(const char* key) const {
    static const Json none = Json::array();
    const auto found = json_.find(key);
    return found == json_.end() ? none : *found;
  }
  const Json& accessor(const Json& index) const { return list("accessors").at(whole_number(index)); }

  void visit(const Json& index, const Vec3& above, std::size_t depth) {
    if (depth > kDeepest || ++visited_ > list("nodes").size())
      fail_in_file(bytes_.path(), "its nodes contain one another; the file is damaged");
    const Json& node = list("nodes").at(whole_number(index));
    Vec3 at = above;
    if (const auto t = node.find("translation"); t != node.end())
      for (int k = 0; k < 3; ++k) at[k] += t->at(static_cast<std::size_t>(k)).get<double>();
    const bool turned = node.contains("rotation") || node.contains("scale") || node.contains("matrix");
    if (node.contains("mesh")) add_mesh(node, at, turned);
    for (const Json& child : node.value("children", Json::array())) visit(child, at, depth + 1);
  }

  void add_mesh(const Json& node, const Vec3& at, bool turned) {
    std::uint64_t times = 1;
    if (const auto instancing = "/extensions/EXT_mesh_gpu_instancing/attributes/TRANSLATION"_json_pointer;
        node.contains(instancing)) {
      times = whole_number(accessor(node.at(instancing)).at("count"));
      info_.instances += times;
      turned = true;
    }
    for (const Json& primitive : list("meshes").at(whole_number(node.at("mesh"))).at("primitives")) {
      const Json& position = accessor(primitive.at("attributes").at("POSITION"));
      const auto corners = primitive.contains("indices")
                               ? whole_number(accessor(primitive.at("indices")).at("count"))
                               : whole_number(position.at("count"));
      info_.triangles += corners / 3 * times;
      if (!turned && position.contains("min") && position.contains("max"))
        for (const char* side : {"min", "max"}) {
          Vec3 p = at;
          for (int k = 0; k < 3; ++k) p[k] += position.at(side).at(static_cast<std::size_t>(k)).get<double>();
          if (p.allFinite()) info_.bounds.add({p.x(), -p.z(), p.y()});  // glTF has y up
        }
    }
  }

  const FileBytes& bytes_;
  const Json& json_;
  GlbInfo info_;
  std::size_t visited_ = 0;
};

}  // namespace

GlbInfo read_glb_info(const FileBytes& bytes) {
  const auto version = bytes.number<std::uint32_t>(4, "glTF version");
  if (version != 2)
    fail_at_byte(bytes.path(), 4, "glTF version " + std::to_string(version) + " found; 2 is known");
  const auto total = bytes.number<std::uint32_t>(8, "length");
  if (total != bytes.size())
    fail_at_byte(bytes.path(), 8,
                 "a length of " + std::to_string(total) + " bytes; the file has " +
                     std::to_string(bytes.size()) + " (truncated or damaged)");
  const auto length = bytes.number<std::uint32_t>(12, "length of the scene");
  if (bytes.number<std::uint32_t>(16, "kind of the first chunk") != kJsonChunk)
    fail_at_byte(bytes.path(), 16, "the first chunk is not the scene (JSON)");
  bytes.need(20, length, "scene");
  std::uint64_t at = 20 + std::uint64_t{length};
  while (at < bytes.size()) {  // the other chunks fill the file
    const std::uint64_t chunk = bytes.number<std::uint32_t>(at, "length of a chunk");
    bytes.need(at + 8, chunk, "chunk");
    at += 8 + chunk;
  }
  try {
    const Json json = Json::parse(bytes.view().substr(20, length));
    return Scene(bytes, json).read();
  } catch (const Json::exception& error) {
    fail_in_file(bytes.path(), std::string("its scene is no glTF: ") + error.what());
  }
}

}  // namespace dendrofit
