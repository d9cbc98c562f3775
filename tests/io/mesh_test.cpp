// SPDX-License-Identifier: GPL-3.0-or-later
// Meshes and scenes: OBJ, PLY, binary glTF.
#include "io/read_mesh.h"
#include "io/write_mesh.h"
#include "io/write_tree.h"
#include "tests/io/samples.h"

#include <Eigen/Geometry>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace dendrofit {
namespace {

using test::content_of;
using test::refusal;
using test::TemporaryFolder;
using testing::HasSubstr;

const Vec3 kUtm(500000, 5412300, 1200);

TEST(Mesh, ObjAndPlyReadBack) {
  const TemporaryFolder folder;
  const Tree tree = test::sample_tree(kUtm);
  const TriangleMesh mesh = tree_mesh(tree);
  write_tree_obj(folder / "t.obj", tree);
  write_tree_ply(folder / "t.ply", tree);
  for (const char* name : {"t.obj", "t.ply"}) {
    const TriangleMesh back = read_mesh(folder / name);
    ASSERT_EQ(back.triangles, mesh.triangles);
    for (std::size_t i = 0; i < mesh.vertices.size(); ++i)
      EXPECT_LT((back.vertices[i] - mesh.vertices[i] - kUtm).cwiseAbs().maxCoeff(), 1e-6);
  }
}

TEST(Mesh, LeavesComeInOrderWithTheirTriangles) {
  const TemporaryFolder folder;
  const Foliage foliage = test::sample_foliage(kUtm);
  write_foliage_obj(folder / "l.obj", foliage);
  write_foliage_ply(folder / "l.ply", foliage);
  for (const char* name : {"l.obj", "l.ply"}) {
    const TriangleMesh back = read_mesh(folder / name);
    ASSERT_EQ(back.triangles.size(), 10u);
    for (std::size_t i = 0; i < 5; ++i) {
      const Vec3 base = back.vertices[back.triangles[2 * i][0]];
      EXPECT_LT((base - foliage.leaves[i].origin - kUtm).norm(), 2e-6);
    }
  }
  write_leaves_csv(folder / "leaves.csv", foliage);
  const std::string text = content_of(folder / "leaves.csv");
  EXPECT_THAT(text, testing::StartsWith("id,cylinder,x,y,z,normal_x,normal_y,normal_z,length_m,area_m2,"
                                        "species\n1,1,500000,5412300.2,1202,0,0,1,0.05,"));
  EXPECT_THAT(text, HasSubstr("\"Acer, \"\"Norway\"\"\"\n"));
}

TEST(Mesh, RefusesFacesWithoutVertices) {
  const TemporaryFolder folder;
  EXPECT_THAT(refusal([&] { read_mesh(folder.file("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4\n")); }),
              HasSubstr("line 4: '4' found"));
  EXPECT_THAT(refusal([&] { read_mesh(folder.file("a.obj", "v 0 0 0\nv 1 0 0\nv 0 x 0\n")); }),
              HasSubstr("line 3: 'x'"));
  EXPECT_THAT(refusal([&] { read_mesh(folder.file("a.obj", "v 0 0 0\n")); }), HasSubstr("no faces"));
  const TriangleMesh quad =
      read_mesh(folder.file("q.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1/1/1 2//2 -2 -1\n"));
  EXPECT_EQ(quad.triangles.size(), 2u);
}

// The two chunks of a binary glTF.
struct Glb {
  nlohmann::json json;
  std::string data;
  explicit Glb(const std::string& file) {
    const auto word = [&](std::size_t at) {
      std::uint32_t value = 0;
      std::memcpy(&value, file.data() + at, 4);
      return value;
    };
    EXPECT_EQ(file.substr(0, 4), "glTF");
    EXPECT_EQ(word(4), 2u);
    EXPECT_EQ(word(8), file.size());
    EXPECT_EQ(word(12) % 4, 0u);
    json = nlohmann::json::parse(file.substr(20, word(12)));
    EXPECT_EQ(word(24 + word(12)), 0x004E4942u);
    data = file.substr(28 + word(12));
    EXPECT_EQ(word(20 + word(12)), data.size());
    EXPECT_EQ(json["buffers"][0]["byteLength"], data.size());
  }
  std::vector<float> floats(int accessor) const {
    const auto& a = json["accessors"][static_cast<std::size_t>(accessor)];
    const auto& view = json["bufferViews"][a["bufferView"].get<std::size_t>()];
    std::vector<float> values(view["byteLength"].get<std::size_t>() / 4);
    std::memcpy(values.data(), data.data() + view["byteOffset"].get<std::size_t>(), values.size() * 4);
    return values;
  }
};

TEST(Gltf, PlacesWoodByANodeWithYUp) {
  const TemporaryFolder folder;
  const Tree tree = test::sample_tree(kUtm);
  write_tree_glb(folder / "t.glb", tree);
  const Glb glb(content_of(folder / "t.glb"));
  EXPECT_EQ(glb.json["nodes"][0]["translation"], nlohmann::json({500000.0, 1200.0, -5412300.0}));
  const auto& primitive = glb.json["meshes"][0]["primitives"][0];
  const int position = primitive["attributes"]["POSITION"];
  const std::vector<float> p = glb.floats(position);
  const TriangleMesh mesh = tree_mesh(tree);
  ASSERT_EQ(p.size(), mesh.vertices.size() * 3);
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    EXPECT_NEAR(p[3 * i], mesh.vertices[i].x(), 1e-6);
    EXPECT_NEAR(p[3 * i + 1], mesh.vertices[i].z(), 1e-6);
    EXPECT_NEAR(p[3 * i + 2], -mesh.vertices[i].y(), 1e-6);
  }
  const auto& accessor = glb.json["accessors"][static_cast<std::size_t>(position)];
  float highest = -1e9f;
  for (std::size_t i = 1; i < p.size(); i += 3) highest = std::max(highest, p[i]);
  EXPECT_EQ(accessor["max"][1].get<float>(), highest);
  EXPECT_EQ(glb.json["accessors"][primitive["indices"].get<std::size_t>()]["count"],
            mesh.triangles.size() * 3);
}

TEST(Gltf, DrawsLeavesAsInstancesWhereTheyAre) {
  const TemporaryFolder folder;
  const Foliage foliage = test::sample_foliage();
  write_foliage_glb(folder / "l.glb", foliage);
  const Glb glb(content_of(folder / "l.glb"));
  EXPECT_EQ(glb.json["extensionsRequired"][0], "EXT_mesh_gpu_instancing");
  const auto& attributes = glb.json["nodes"][1]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"];
  const std::vector<float> t = glb.floats(attributes["TRANSLATION"]);
  const std::vector<float> q = glb.floats(attributes["ROTATION"]);
  const std::vector<float> s = glb.floats(attributes["SCALE"]);
  ASSERT_EQ(q.size(), foliage.size() * 4);
  for (std::size_t i = 0; i < foliage.size(); ++i) {
    // Where the blade's tip (0, 1, 0) goes, by the instance's own numbers.
    const Vec3 axis(q[4 * i], q[4 * i + 1], q[4 * i + 2]);
    const Vec3 v(0, s[3 * i], 0);
    const auto cross = [](const Vec3& a, const Vec3& b) {
      return Vec3(a.y() * b.z() - a.z() * b.y(), a.z() * b.x() - a.x() * b.z(),
                  a.x() * b.y() - a.y() * b.x());
    };
    const Vec3 twice = 2 * cross(axis, v);
    const Vec3 tip =
        v + q[4 * i + 3] * twice + cross(axis, twice) + Vec3(t[3 * i], t[3 * i + 1], t[3 * i + 2]);
    const Leaf& leaf = foliage.leaves[i];
    const Vec3 expected = leaf.origin + leaf.length_m * leaf.direction;
    EXPECT_LT((tip - Vec3(expected.x(), expected.z(), -expected.y())).norm(), 1e-6) << i;
  }
}

TEST(Gltf, DrawsPetiolesFromTheWoodToTheBlade) {
  const TemporaryFolder folder;
  const Foliage foliage = test::sample_foliage();
  write_foliage_glb(folder / "l.glb", foliage);
  const Glb glb(content_of(folder / "l.glb"));
  EXPECT_EQ(glb.json["nodes"][2]["name"], "petioles");
  const auto& attributes = glb.json["nodes"][2]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"];
  const std::vector<float> t = glb.floats(attributes["TRANSLATION"]);
  const std::vector<float> q = glb.floats(attributes["ROTATION"]);
  const std::vector<float> s = glb.floats(attributes["SCALE"]);
  ASSERT_EQ(t.size(), 3 * foliage.size());
  for (std::size_t i = 0; i < foliage.size(); ++i) {
    std::array<Vec3, 4> corner;
    ASSERT_TRUE(petiole_corners(foliage.leaves[i], foliage.shapes[0], corner));
    const Eigen::Quaterniond turn(q[4 * i + 3], q[4 * i], q[4 * i + 1], q[4 * i + 2]);
    const Vec3 unit[4] = {{-0.5, 0, 0}, {0.5, 0, 0}, {0.5, 1, 0}, {-0.5, 1, 0}};
    for (std::size_t k = 0; k < 4; ++k) {
      const Vec3 scaled(s[3 * i] * unit[k].x(), s[3 * i + 1] * unit[k].y(), 0);
      const Vec3 at = turn * scaled + Vec3(t[3 * i], t[3 * i + 1], t[3 * i + 2]);
      EXPECT_LT((at - Vec3(corner[k].x(), corner[k].z(), -corner[k].y())).norm(), 3e-6) << i << " " << k;
    }
  }
}

TEST(Gltf, ASceneHoldsBoth) {
  const TemporaryFolder folder;
  write_scene_glb(folder / "s.glb", test::sample_tree(), test::sample_foliage());
  EXPECT_EQ(Glb(content_of(folder / "s.glb")).json["nodes"].size(), 4u);  // root, wood, blades, petioles
  write_scene_glb(folder / "w.glb", test::sample_tree(), Foliage{});
  EXPECT_EQ(Glb(content_of(folder / "w.glb")).json["nodes"].size(), 2u);
  EXPECT_THROW(write_scene_glb(folder / "x.glb", test::sample_tree(), test::sample_foliage(kUtm)),
               InputError);
}

TEST(Mesh, RefusesPlacesBeyondTheEarth) {
  const TemporaryFolder folder;
  EXPECT_THAT(refusal([&] { read_mesh(folder.file("a.obj", "v 0 0 0\nv 1e307 0 0\nv 0 1 0\nf 1 2 3\n")); }),
              HasSubstr("line 2: a coordinate beyond 1e9 m"));
  const std::string ply =
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty double x\nproperty double y\nproperty double z\n"
      "element face 1\nproperty list uchar int vertex_indices\nend_header\n"
      "0 0 0\n0 -2e9 0\n1 0 0\n3 0 1 2\n";
  EXPECT_THAT(refusal([&] { read_mesh(folder.file("a.ply", ply)); }), HasSubstr("1e9 m"));
}

}  // namespace
}  // namespace dendrofit
