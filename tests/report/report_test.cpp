// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/report/report.h"

#include "core/errors.h"
#include "tests/report/markup.h"
#include "tests/report/sample.h"

#include <gtest/gtest.h>

namespace dendrofit {
namespace {

bool has(const std::string& page, const std::string& words) {
  return page.find(words) != std::string::npos;
}

TEST(Report, HoldsEveryTableAndPlot) {
  const test::Sample sample(2000, 50);
  const std::string page = make_report(sample.data);
  for (const char* id : {"view",
                         "picture",
                         "table-metrics",
                         "table-parameters",
                         "table-descriptors",
                         "table-leaves",
                         "table-provenance",
                         "table-options",
                         "table-stages",
                         "warnings",
                         "plot-growth-1",
                         "plot-increment-1",
                         "table-given",
                         "plot-taper",
                         "plot-volume-order",
                         "plot-volume-diameter",
                         "plot-branch-angle",
                         "plot-branch-length",
                         "plot-profile",
                         "plot-cost",
                         "plot-descriptors",
                         "plot-parameters"})
    EXPECT_TRUE(has(page, std::string("id=\"") + id + "\"")) << id;
  EXPECT_TRUE(has(page, "not identifiable"));
  EXPECT_EQ(test::unclosed_tag(page), "");
}

TEST(Report, NamesCannotBreakOutOfTheirPlace) {
  const test::Sample sample(500, 10);
  const std::string page = make_report(sample.data);
  EXPECT_FALSE(has(page, "<script>document.title"));
  EXPECT_FALSE(has(page, "<img src=x"));
  EXPECT_FALSE(has(page, "a\"b<c>"));
  EXPECT_TRUE(has(page, "B\xc3\xa4ume &quot;&lt;b&gt;no. 7&lt;/b&gt;&quot;"));
}

TEST(Report, AsksTheNetworkForNothing) {
  const test::Sample sample(500, 10);
  const std::string page = make_report(sample.data);
  EXPECT_TRUE(has(page, "default-src 'none'"));
  for (const char* word : {"src=\"http", "href=\"http", "src=\"//", "@import", "url(http"})
    EXPECT_FALSE(has(page, word)) << word;
}

TEST(Report, HasTheViewWhereItIsBuiltIn) {
  const test::Sample sample(500, 10);
  const std::string page = make_report(sample.data);
  EXPECT_EQ(has(page, "The 3-D view is not in this report"), !has_viewer());
  EXPECT_EQ(has(page, "id=\"scene-data\""), has_viewer());
}

TEST(Report, SameDataSameBytes) {
  const test::Sample a(500, 10);
  const test::Sample b(500, 10);
  EXPECT_EQ(make_report(a.data), make_report(b.data));
}

TEST(Report, WithoutAnythingIsStillAPage) {
  const std::string page = make_report({});
  EXPECT_EQ(test::unclosed_tag(page), "");
  EXPECT_FALSE(has(page, "id=\"view\""));
  EXPECT_TRUE(has(page, "id=\"table-provenance\""));
}

TEST(Report, MeasuredStemCylindersAreThePointsOfTheTaperPlot) {
  const Tree model = test::branching_tree(3, 1, {1000, 2000, 300});  // five measured stem cylinders
  const TreeMetrics metrics = measure(model);
  ReportData data;
  data.model = &model;
  data.model_metrics = &metrics;
  const std::string page = make_report(data);
  const std::size_t from = page.find("id=\"plot-taper\"");
  ASSERT_NE(from, std::string::npos);
  const std::string plot = page.substr(from, page.find("</figure>", from) - from);
  std::size_t circles = 0;
  for (std::size_t at = plot.find("r=\"2.6\""); at != std::string::npos; at = plot.find("r=\"2.6\"", at + 1))
    ++circles;
  EXPECT_EQ(circles, 5u);
}

TEST(Report, ScanWithoutATreeShowsTheScan) {
  const PointCloud cloud = test::scattered_scan(test::branching_tree(1, 1), 300);
  ReportData data;
  data.scan = &cloud;
  const std::string page = make_report(data);
  EXPECT_EQ(test::unclosed_tag(page), "");
  EXPECT_TRUE(has(page, "id=\"view\""));
}

TEST(Report, StaysUnderFifteenMegabytesForALargeScan) {
  // Past max_scan_points and max_leaves the page grows no further.
  const test::Sample sample(750'000, 160'000);
  const std::string page = make_report(sample.data);
  EXPECT_LT(page.size(), 15'000'000u);
  EXPECT_TRUE(!has_viewer() || has(page, "The view shows 700,000 of the scan"));
}

TEST(Report, RefusesColumnsOfUnequalLengthAndBrokenTrees) {
  ReportData data;
  ReportCurve curve;
  curve.name = "height";
  curve.time = {1, 2};
  curve.value = {1};
  data.curves = {curve};
  EXPECT_THROW(make_report(data), InputError);
  data.curves.clear();
  Tree broken = test::branching_tree(1, 1);
  broken.radius[0] = -1;
  data.model = &broken;
  EXPECT_THROW(make_report(data), InputError);
  ReportOptions options;
  options.max_leaves = -1;
  EXPECT_THROW(make_report({}, options), InputError);
}

}  // namespace
}  // namespace dendrofit
