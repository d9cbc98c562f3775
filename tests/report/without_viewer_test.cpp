// SPDX-License-Identifier: GPL-3.0-or-later
// The report of a build with DENDROFIT_VIEWER=OFF: this program is linked with viewer_missing.cpp, as that
// build is.
#include "tests/report/markup.h"
#include "tests/report/sample.h"

#include <gtest/gtest.h>

namespace dendrofit {
namespace {

TEST(ReportWithoutViewer, says_what_is_missing_and_keeps_everything_else) {
  ASSERT_FALSE(has_viewer());
  const test::Sample sample(500, 10);
  const std::string page = make_report(sample.data);
  const auto has = [&](const char* part) { return page.find(part) != std::string::npos; };
  EXPECT_TRUE(has("The 3-D view is not in this report"));
  EXPECT_TRUE(has("Node.js and npm"));
  EXPECT_FALSE(has("<script"));
  EXPECT_EQ(test::unclosed_tag(page), "");
  for (const char* part : {"id=\"side-by-side\"", "id=\"table-metrics\"", "id=\"table-parameters\"",
                           "id=\"plot-taper\"", "id=\"plot-growth-1\"", "id=\"table-provenance\""})
    EXPECT_TRUE(has(part)) << part;
}

}  // namespace
}  // namespace dendrofit
