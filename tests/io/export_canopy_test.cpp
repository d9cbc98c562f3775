// SPDX-License-Identifier: GPL-3.0-or-later
// Leaves and petioles for other programs: what is written is what was placed.
#include "io/export_canopy.h"

#include "io/birth_cycles.h"
#include "io/read_foliage.h"
#include "io/read_mesh.h"
#include "io/write_mesh.h"
#include "tests/io/samples.h"

#include <filesystem>
#include <numbers>

#include <gmock/gmock.h>

namespace dendrofit {
namespace {

using test::TemporaryFolder;
using testing::HasSubstr;

const Vec3 kUtm(500000, 5412300, 1200);

std::vector<std::string> lines_of(const std::filesystem::path& path) {
  std::istringstream in(test::content_of(path));
  std::vector<std::string> lines;
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  return lines;
}

std::vector<double> numbers_of(const std::string& line) {
  std::istringstream in(line);
  return {std::istream_iterator<double>(in), {}};
}

TEST(Petioles, StandInGroupsOfTheirLeaves) {
  const TemporaryFolder folder;
  Foliage foliage = test::sample_foliage(kUtm);
  foliage.leaves[1].petiole_foot = foliage.leaves[1].origin;  // sits on the wood
  write_petioles_obj(folder / "p.obj", foliage);
  write_petioles_ply(folder / "p.ply", foliage);
  const std::string text = test::content_of(folder / "p.obj");
  EXPECT_THAT(text, HasSubstr("g leaf_1\n"));
  EXPECT_THAT(text, testing::Not(HasSubstr("g leaf_2\n")));
  EXPECT_THAT(text, HasSubstr("g leaf_3\n"));
  for (const char* name : {"p.obj", "p.ply"}) {
    const TriangleMesh mesh = read_mesh(folder / name);
    ASSERT_EQ(mesh.triangles.size(), 2 * (foliage.size() - 1));
    const auto world = [&](std::size_t v) -> Vec3 { return mesh.vertices[v] + mesh.origin_shift - kUtm; };
    EXPECT_LT((0.5 * (world(0) + world(1)) - foliage.leaves[0].petiole_foot).norm(), 2e-6) << name;
    EXPECT_LT((0.5 * (world(6) + world(7)) - foliage.leaves[2].origin).norm(), 2e-6) << name;
  }
}

TEST(FoliageGlb, ComesBackAsWritten) {
  const TemporaryFolder folder;
  Foliage foliage = test::sample_foliage(kUtm);
  foliage.shapes.push_back(foliage.shapes[0]);
  foliage.shapes[1].vertices[1].x() = -0.2;
  foliage.leaves[1].shape = foliage.leaves[4].shape = 1;
  foliage.leaves[2].petiole_foot = foliage.leaves[2].origin;
  write_scene_glb(folder / "s.glb", test::sample_tree(kUtm), foliage);
  const Foliage back = read_foliage_glb(folder / "s.glb");
  EXPECT_EQ(back.origin_shift, foliage.origin_shift);
  ASSERT_EQ(back.size(), foliage.size());
  ASSERT_EQ(back.shapes.size(), 2U);
  const std::size_t order[] = {0, 2, 3, 1, 4};  // shape by shape
  std::vector<Vec3> expected, found;
  for (std::size_t k = 0; k < 5; ++k) {
    const Leaf &leaf = foliage.leaves[order[k]], &read = back.leaves[k];
    blade_vertices(leaf, foliage.shapes[leaf.shape], expected);
    blade_vertices(read, back.shapes[read.shape], found);
    ASSERT_EQ(expected.size(), found.size());
    for (std::size_t v = 0; v < found.size(); ++v) EXPECT_LT((expected[v] - found[v]).norm(), 5e-6) << k;
    EXPECT_LT((leaf.petiole_foot - read.petiole_foot).norm(), 1e-6) << k;
    EXPECT_NEAR(back.leaf_area(k), foliage.leaf_area(order[k]), 1e-8);
  }
  write_tree_glb(folder / "t.glb", test::sample_tree());
  EXPECT_THAT(test::refusal([&] { read_foliage_glb(folder / "t.glb"); }), HasSubstr("no leaves in it"));
}

TEST(BirthCycles, ComeBackAndMustFitTheirTree) {
  const TemporaryFolder folder;
  Tree tree = test::sample_tree();
  for (std::size_t i = 0; i < tree.size(); ++i) tree.birth_cycle[i] = static_cast<std::int32_t>(i) - 1;
  write_birth_cycles(folder / "b.csv", tree);
  Tree back = test::sample_tree();
  read_birth_cycles(folder / "b.csv", back);
  EXPECT_EQ(back.birth_cycle, tree.birth_cycle);
  Tree one;
  one.add(tree.node(0));
  EXPECT_THAT(test::refusal([&] { read_birth_cycles(folder / "b.csv", one); }), HasSubstr("line 3"));
  const auto shorter = folder.file("s.csv", "id,birth_cycle\n1,4\n");
  EXPECT_THAT(test::refusal([&] { read_birth_cycles(shorter, back); }), HasSubstr("1 rows found"));
  EXPECT_THAT(test::refusal([&] { read_birth_cycles(folder.file("x.csv", "id,birth_cycle\n1,-7\n"), one); }),
              HasSubstr("line 2"));
}

TEST(ExportHelios, NamesMaterialsAndPutsTheTreeWhereItStands) {
  const TemporaryFolder folder;
  const auto out = folder / "helios";
  std::filesystem::create_directories(out);
  const Tree tree = test::sample_tree(kUtm);
  const Foliage foliage = test::sample_foliage(kUtm);
  export_helios(out, tree, foliage, "conifer");
  const std::string obj = test::content_of(out / "tree.obj");
  EXPECT_THAT(obj, HasSubstr("mtllib tree.mtl\no wood\nusemtl wood\n"));
  EXPECT_THAT(obj, HasSubstr("o leaves\nusemtl leaves\n"));
  const std::string mtl = test::content_of(out / "tree.mtl");
  EXPECT_THAT(mtl, HasSubstr("newmtl wood\n"));
  EXPECT_THAT(mtl, HasSubstr("helios_classification 1\nhelios_spectra conifer\n"));
  const std::string scene = test::content_of(out / "scene.xml");
  EXPECT_THAT(scene, HasSubstr("value=\"helios/tree.obj\""));
  EXPECT_THAT(scene, HasSubstr("key=\"offset\" value=\"500000;5412300;1200\""));
  // All of it is there: wood, petioles and blades.
  const TriangleMesh all = read_mesh(out / "tree.obj");
  EXPECT_EQ(all.triangles.size(), tree_mesh(tree).triangles.size() + 4 * foliage.size());
  // The last face is the last leaf's, and points at its own vertices.
  const Vec3 tip = all.vertices[all.triangles.back()[2]] + all.origin_shift;
  EXPECT_LT((tip - foliage.leaves.back().origin).norm(), 0.2);
}

TEST(ExportLess, GivesComponentsInGroupsOfFourAndTurnsYUp) {
  const TemporaryFolder folder;
  const Tree tree = test::sample_tree(kUtm);
  const Foliage foliage = test::sample_foliage(kUtm);
  export_less(folder / "", tree, foliage);
  EXPECT_EQ(test::content_of(folder / "objects.txt"),
            "tree tree_wood.obj branch - 0x8b5a2bff tree_leaves.obj leaf - 0x006400ff\n");
  EXPECT_EQ(test::content_of(folder / "instances.txt"), "tree 50 50 0 0\n");
  const TriangleMesh leaves = read_mesh(folder / "tree_leaves.obj");
  ASSERT_EQ(leaves.triangles.size(), 2 * foliage.size());
  const Vec3 local = foliage.leaves[0].origin - tree.start[0];
  EXPECT_LT((leaves.vertices[0] + leaves.origin_shift - Vec3(local.x(), local.z(), -local.y())).norm(), 3e-6);
  export_less(folder / "", tree, Foliage{});
  EXPECT_EQ(test::content_of(folder / "objects.txt"), "tree tree_wood.obj branch - 0x8b5a2bff\n");
}

TEST(ExportEradiate, GivesDiscsOfTheLeavesArea) {
  const TemporaryFolder folder;
  const Tree tree = test::sample_tree(kUtm);
  const Foliage foliage = test::sample_foliage(kUtm);
  export_eradiate(folder / "", tree, foliage);
  const std::vector<std::string> lines = lines_of(folder / "leaves.txt");
  ASSERT_EQ(lines.size(), foliage.size());
  double area = 0;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const std::vector<double> n = numbers_of(lines[i]);
    ASSERT_EQ(n.size(), 7U) << lines[i];
    area += std::numbers::pi * n[0] * n[0];
    const Leaf& leaf = foliage.leaves[i];
    const Vec3 middle = leaf.origin + 0.5 * leaf.length_m * leaf.direction - tree.start[0];
    EXPECT_LT((Vec3(n[1], n[2], n[3]) - middle).norm(), 3e-6) << i;
    EXPECT_LT((Vec3(n[4], n[5], n[6]) - leaf.normal).norm(), 1e-12) << i;
  }
  EXPECT_NEAR(area, foliage.total_area(), 1e-12);
  EXPECT_GT(read_mesh(folder / "wood.ply").triangles.size(), 100U);
}

TEST(Export, RefusesATreeWithoutWoodAndLeavesOfAnotherOrigin) {
  const TemporaryFolder folder;
  EXPECT_THROW(export_helios(folder / "", Tree{}, Foliage{}), InputError);
  EXPECT_THROW(export_less(folder / "", test::sample_tree(), test::sample_foliage(kUtm)), InputError);
  EXPECT_THROW(export_eradiate(folder / "nowhere", test::sample_tree(), test::sample_foliage()), IoError);
}

}  // namespace
}  // namespace dendrofit
