// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/glb_info.h"

#include "core/mesh.h"
#include "io/file_info.h"
#include "io/write_mesh.h"
#include "tests/io/samples.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace dendrofit {
namespace {

using test::content_of;
using test::refusal;
using test::TemporaryFolder;
using testing::HasSubstr;

TEST(GlbInfo, CountsAndBoundsAreThoseOfTheMeshWritten) {
  const TemporaryFolder folder;
  const Tree tree = test::random_tree(60, {500000, 5400000, 300});
  write_tree_glb(folder / "a.glb", tree);
  write_tree_ply(folder / "a.ply", tree);
  const FileInfo glb = describe_file(folder / "a.glb"), ply = describe_file(folder / "a.ply");
  EXPECT_EQ(glb.kind, "mesh");
  EXPECT_EQ(glb.format, "glb");
  EXPECT_EQ(glb.rows, ply.rows);
  EXPECT_LT((glb.bounds.lo - ply.bounds.lo).norm(), 1e-4);  // single precision about the shift
  EXPECT_LT((glb.bounds.hi - ply.bounds.hi).norm(), 1e-4);
}

TEST(GlbInfo, RefusalsSayWhatIsWrong) {
  const TemporaryFolder folder;
  write_tree_glb(folder / "a.glb", test::sample_tree());
  const std::string good = content_of(folder / "a.glb");
  EXPECT_THAT(refusal([&] { describe_file(folder.file("b.glb", good.substr(0, good.size() / 2))); }),
              HasSubstr("truncated"));
  std::string bad = good;
  bad[4] = 1;
  EXPECT_THAT(refusal([&] { describe_file(folder.file("b.glb", bad)); }), HasSubstr("version 1"));
  bad = good;
  bad[bad.find("\"nodes\":[0]") + 9] = '9';
  EXPECT_THAT(refusal([&] { describe_file(folder.file("b.glb", bad)); }), HasSubstr("b.glb"));
  // node 0 becomes its own child
  bad = good;
  const auto child = bad.find("\"children\":[1");
  ASSERT_NE(child, std::string::npos);
  bad[child + 12] = '0';
  EXPECT_THAT(refusal([&] { describe_file(folder.file("b.glb", bad)); }), HasSubstr("contain one another"));
}

}  // namespace
}  // namespace dendrofit
