// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/igm_files.h"

#include "cli/site_file.h"
#include "cli/surroundings.h"
#include "core/atomic_file.h"
#include "core/errors.h"
#include "tests/support/scratch_folder.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace dendrofit::cli {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

template <class Action>
std::string complaint(Action action) {
  try {
    action();
  } catch (const InputError& error) {
    return error.what();
  } catch (const IoError& error) {
    return error.what();
  }
  return "no complaint";
}

TEST(IgmFiles, parameters_survive_writing_and_reading) {
  const test::ScratchFolder scratch;
  for (const char* equation : {"logistic", "weibull"}) {
    IgmParameters p = igm_preset("table2-06").parameters;
    p.set_equation(equation);
    p.set("gamma", 1.0 / 3);
    p.cycles = 13;
    write_file(scratch / "p.toml", igm_parameters_toml(p, {"a remark"}));
    const IgmParameters back = load_igm_setup((scratch / "p.toml").string()).parameters;
    EXPECT_EQ(back.equation, p.equation);
    for (const ParameterSpec& spec : igm_parameter_table(equation))
      EXPECT_EQ(back.get(spec.key), p.get(spec.key)) << spec.key;
  }
}

TEST(IgmFiles, faults_are_named_with_line_field_and_limit) {
  const test::ScratchFolder scratch;
  write_file(scratch / "p.toml", "xm = 80\nxmm = 3\n");
  EXPECT_THAT(complaint([&] { load_igm_setup((scratch / "p.toml").string()); }),
              AllOf(HasSubstr("line 2"), HasSubstr("xm")));
  write_file(scratch / "p.toml", "\nxm = -80\n");
  EXPECT_THAT(complaint([&] { load_igm_setup((scratch / "p.toml").string()); }),
              AllOf(HasSubstr("line 2"), HasSubstr("-80")));
  EXPECT_THAT(complaint([] { load_igm_setup("standart"); }), HasSubstr("standard"));
  const auto refused = [&](const std::string& text) {
    write_file(scratch / "p.toml", text);
    return complaint([&] { load_igm_setup((scratch / "p.toml").string()); });
  };
  EXPECT_THAT(refused("xm = true\n"), AllOf(HasSubstr("line 1"), HasSubstr("a number expected")));
  EXPECT_THAT(refused("xm = nan\n"), AllOf(HasSubstr("line 1"), HasSubstr("not finite")));
  EXPECT_THAT(refused("cycles = 3.5\n"), AllOf(HasSubstr("3.5"), HasSubstr("whole number")));
  EXPECT_THAT(refused("preset = \"standart\"\n"), AllOf(HasSubstr("line 1"), HasSubstr("standard")));
  EXPECT_THAT(refused("equation = \"weibull\"\nxm = 80\n"),
              AllOf(HasSubstr("line 2"), HasSubstr("logistic"), HasSubstr("omega1, omega2, omega3")));
  EXPECT_THAT(refused("[[tree]]\nroot = [0, 0, 0]\n"), AllOf(HasSubstr("line 2"), HasSubstr("--site")));
  EXPECT_THAT(refused("[growth]\nxm = 80\n"), AllOf(HasSubstr("line 2"), HasSubstr("by itself")));
  EXPECT_THAT(refused("[tree]\n"), AllOf(HasSubstr("line 1"), HasSubstr("nothing in it")));
  EXPECT_THAT(refused("roots = 0\n"), AllOf(HasSubstr("line 1"), HasSubstr("between 1 and")));
}

TEST(IgmFiles, settings_change_parameters) {
  IgmSetup p;
  apply_settings(p, {"xm=70", "resource_allocation=false", "roots=3"});
  EXPECT_EQ(p.parameters.get("xm"), 70);
  EXPECT_FALSE(p.parameters.resource_allocation);
  EXPECT_EQ(p.roots, 3);
  EXPECT_THAT(complaint([&] { apply_settings(p, {"xm"}); }), HasSubstr("key=value"));
  EXPECT_THAT(complaint([&] { apply_settings(p, {"xm=tall"}); }), HasSubstr("not a number"));
  EXPECT_THAT(complaint([&] { apply_settings(p, {"xm=-1"}); }), HasSubstr("--set"));
}

TEST(IgmFiles, what_was_grown_grows_again_from_its_own_files) {
  const test::ScratchFolder scratch;
  std::filesystem::create_directory(scratch / "out");
  write_file(scratch / "rock.obj",
             "v 2 2 0\nv 3 2 0\nv 2 3 0\nv 2 2 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n");
  write_file(scratch / "site.toml",
             "[[tree]]\nroot = [0, 0, 0.1]\n[[tree]]\nroot = [3, 0, 0, 3.5, 0, 0]\nparameters = {equation = "
             "\"weibull\", rho_m = 0.07}\n[[box]]\nmin = [1, -1, 0]\nmax = [1.5, 1, 4]\n[[halfspace]]\n"
             "point = [-2, 0, 0]\nnormal = [1, 0, 0.333]\n[[mesh]]\nfile = \"rock.obj\"\n");
  const SiteFile first = load_site(scratch / "site.toml", {});
  write_file(scratch / "out" / "site.toml", site_toml(first, scratch / "out"));
  const SiteFile again = load_site(scratch / "out" / "site.toml", {});
  EXPECT_EQ(site_toml(again, scratch / "out"), site_toml(first, scratch / "out"));
  ASSERT_EQ(again.site.trees.size(), 2u);
  EXPECT_EQ(again.site.trees[0].roots, first.site.trees[0].roots);
  EXPECT_FALSE(again.site.trees[0].parameters);
  EXPECT_EQ(again.site.trees[1].parameters->equation, "weibull");
  EXPECT_EQ(again.site.trees[1].parameters->rho_m, 0.07);
  EXPECT_EQ(again.site.solids.half_spaces.at(0).normal, first.site.solids.half_spaces.at(0).normal);
  EXPECT_EQ(again.site.solids.meshes.at(0).triangles.size(), 4u);

  IgmSetup shrub = load_igm_setup("table2-09");
  EXPECT_EQ(shrub.roots, 10);
  write_file(scratch / "out" / "params.toml", igm_setup_toml(shrub, {}));
  EXPECT_EQ(load_igm_setup((scratch / "out" / "params.toml").string()).roots, 10);
  shrub.site = "site.toml";
  write_file(scratch / "out" / "params.toml", igm_setup_toml(shrub, {}));
  EXPECT_EQ(load_igm_setup((scratch / "out" / "params.toml").string()).site, scratch / "out" / "site.toml");
}

TEST(IgmFiles, a_site_holds_trees_and_obstacles) {
  const test::ScratchFolder scratch;
  write_file(scratch / "site.toml",
             "[[tree]]\nroot = [0, 0, 0]\n[[tree]]\nroot = [3, 0, 0, 3.5, 0, 0]\nparameters = \"table2-05\"\n"
             "[[box]]\nmin = [1, -1, 0]\nmax = [1.5, 1, 4]\n[[halfspace]]\npoint = [-2, 0, 0]\nnormal = [1, "
             "0, 0]\n");
  const IgmSite site = load_site(scratch / "site.toml", IgmParameters{}).site;
  ASSERT_EQ(site.trees.size(), 2u);
  EXPECT_FALSE(site.trees[0].parameters);
  EXPECT_EQ(site.trees[1].roots.size(), 2u);
  EXPECT_EQ(site.trees[1].parameters->get("xm"), 70);
  EXPECT_EQ(site.solids.boxes.at(0).max, Vec3(1.5, 1, 4));
  EXPECT_EQ(site.solids.half_spaces.at(0).normal, Vec3(1, 0, 0));
  write_file(scratch / "bad.toml", "[[box]]\nmin = [1, 2, 3]\n");
  EXPECT_THAT(complaint([&] { load_site(scratch / "bad.toml", {}); }),
              AllOf(HasSubstr("[[box]]"), HasSubstr("no max")));
  write_file(scratch / "bad.toml", "[[box]]\nmin = [1, 2]\nmax = [3, 3, 3]\n");
  EXPECT_THAT(complaint([&] { load_site(scratch / "bad.toml", {}); }),
              AllOf(HasSubstr("line 2"), HasSubstr("x, y, z")));
  write_file(scratch / "bad.toml", "[[rock]]\nsize = 3\n");
  EXPECT_THAT(complaint([&] { load_site(scratch / "bad.toml", {}); }), HasSubstr("rock"));
  const auto refused = [&](const std::string& text) {
    write_file(scratch / "bad.toml", text);
    return complaint([&] { load_site(scratch / "bad.toml", {}); });
  };
  EXPECT_THAT(refused("[[box]]\nmin = [1, 2, 3]\nmax = [3, 3, 4]\n[[mesh]]\n"),
              AllOf(HasSubstr("line 4: [[mesh]]"), HasSubstr("nothing in it")));
  EXPECT_THAT(refused("[[mesh]]\nfile = \"none.obj\"\n"),
              AllOf(HasSubstr("bad.toml, line 2"), HasSubstr("none.obj")));
  EXPECT_THAT(refused("[[tree]]\nroot = [0, 0, 0]\nparameters = \"table2-99\"\n"),
              AllOf(HasSubstr("bad.toml, line 3"), HasSubstr("table2-09")));
  EXPECT_THAT(refused("[[tree]]\nroot = [1, 0, 0]\n[[tree]]\nroot = [1, 0, 0]\n"),
              AllOf(HasSubstr("bad.toml"), HasSubstr("tree 2"), HasSubstr("tree 1 stands there already")));
}

TEST(Surroundings, show_boxes_above_ground_planes_about_the_tree_and_meshes) {
  Bounds shown;
  shown.add({-1, -1, 0});
  shown.add({1, 1, 3});
  IgmSite site;
  EXPECT_TRUE(surroundings_of(site, shown).triangles.empty());
  site.solids.half_spaces.push_back({{0, 0, 0}, {0, 0, 1}});  // the ground
  EXPECT_TRUE(surroundings_of(site, shown).triangles.empty());
  site.solids.boxes.push_back({{2, 2, -5}, {3, 3, -1}});  // a cellar
  EXPECT_TRUE(surroundings_of(site, shown).triangles.empty());
  site.solids.boxes.push_back({{2, -1, -5}, {3, 1, 4}});
  site.solids.half_spaces.push_back({{-2, 0, 0}, {2, 0, 0}});
  TriangleMesh rock;
  rock.origin_shift = {10, 0, 0};
  rock.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  rock.triangles = {{0, 1, 2}};
  site.solids.meshes.push_back(rock);
  const TriangleMesh all = surroundings_of(site, shown);
  ASSERT_EQ(all.triangles.size(), 12U + 2U + 1U);
  for (std::size_t i = 0; i < 24; ++i) EXPECT_GE(all.vertices[i].z(), 0);
  for (std::size_t i = 24; i < 28; ++i) EXPECT_NEAR(all.vertices[i].x(), -2, 1e-12);
  EXPECT_EQ(all.vertices[29], Vec3(11, 0, 0));
}

}  // namespace
}  // namespace dendrofit::cli
