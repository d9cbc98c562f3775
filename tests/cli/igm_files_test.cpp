// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/igm_files.h"

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
    const IgmParameters back = load_igm_parameters((scratch / "p.toml").string());
    EXPECT_EQ(back.equation, p.equation);
    for (const ParameterSpec& spec : igm_parameter_table(equation))
      EXPECT_EQ(back.get(spec.key), p.get(spec.key)) << spec.key;
  }
}

TEST(IgmFiles, faults_are_named_with_line_field_and_limit) {
  const test::ScratchFolder scratch;
  write_file(scratch / "p.toml", "xm = 80\nxmm = 3\n");
  EXPECT_THAT(complaint([&] { load_igm_parameters((scratch / "p.toml").string()); }),
              AllOf(HasSubstr("line 2"), HasSubstr("xm")));
  write_file(scratch / "p.toml", "\nxm = -80\n");
  EXPECT_THAT(complaint([&] { load_igm_parameters((scratch / "p.toml").string()); }),
              AllOf(HasSubstr("line 2"), HasSubstr("-80")));
  EXPECT_THAT(complaint([] { load_igm_parameters("standart"); }), HasSubstr("standard"));
}

TEST(IgmFiles, settings_change_parameters) {
  IgmParameters p;
  apply_settings(p, {"xm=70", "resource_allocation=false"});
  EXPECT_EQ(p.get("xm"), 70);
  EXPECT_FALSE(p.resource_allocation);
  EXPECT_THAT(complaint([&] { apply_settings(p, {"xm"}); }), HasSubstr("key=value"));
  EXPECT_THAT(complaint([&] { apply_settings(p, {"xm=tall"}); }), HasSubstr("not a number"));
  EXPECT_THAT(complaint([&] { apply_settings(p, {"xm=-1"}); }), HasSubstr("--set"));
}

TEST(IgmFiles, a_site_holds_trees_and_obstacles) {
  const test::ScratchFolder scratch;
  write_file(scratch / "site.toml",
             "[[tree]]\nroot = [0, 0, 0]\n[[tree]]\nroot = [3, 0, 0, 3.5, 0, 0]\nparameters = \"table2-05\"\n"
             "[[box]]\nmin = [1, -1, 0]\nmax = [1.5, 1, 4]\n[[halfspace]]\npoint = [-2, 0, 0]\nnormal = [1, "
             "0, 0]\n");
  const IgmSite site = load_site(scratch / "site.toml", IgmParameters{});
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
}

}  // namespace
}  // namespace dendrofit::cli
