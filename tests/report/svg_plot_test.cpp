// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/report/svg_plot.h"

#include "tests/report/markup.h"

#include <limits>

#include <gtest/gtest.h>

namespace dendrofit {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

TEST(SvgPlot, HasNothingToShowWithoutFiniteNumbers) {
  SvgPlot plot("t", "x", "y");
  EXPECT_EQ(plot.figure("p"), "");
  plot.line({}, {}, kScanStyle, "a");
  plot.line({1, 2}, {1}, kScanStyle, "unequal");
  EXPECT_TRUE(plot.empty());
  plot.line({1, 2}, {kNan, kNan}, kScanStyle, "a");
  EXPECT_EQ(plot.figure("p"), "");
}

TEST(SvgPlot, TextIsEscapedAndMarkupCloses) {
  SvgPlot plot("a<b>", "x\"&", "y");
  plot.line({0, 1}, {0, 2}, kScanStyle, "<script>");
  plot.band({0, 1}, {0, 1}, {1, 2}, kScanStyle, "band");
  plot.points({0.5}, {1}, kRegrownStyle, "point");
  const std::string html = plot.figure("p");
  EXPECT_EQ(html.find("<script>"), std::string::npos);
  EXPECT_EQ(test::unclosed_tag(html), "");
}

TEST(SvgPlot, ALineBreaksAtAMissingValue) {
  SvgPlot plot("t", "x", "y");
  plot.line({0, 1, 2, 3, 4}, {1, 2, kNan, 3, 4}, kScanStyle, "");
  const std::string html = plot.figure("p");
  const std::string path = html.substr(html.find("d=\""));
  EXPECT_EQ(std::count(path.begin(), path.end(), 'M'), 2);
  EXPECT_EQ(html.find("nan"), std::string::npos);
}

TEST(SvgPlot, OneValueAndConstantsAndLogarithmsWork) {
  for (bool log : {false, true}) {
    SvgPlot plot("t", "x", "y");
    if (log) plot.logarithmic_y();
    plot.line({3, 3}, {7, 7}, kScanStyle, "");
    plot.points({3}, {0}, kScanStyle, "not on a logarithmic axis");
    const std::string html = plot.figure("p");
    EXPECT_EQ(test::unclosed_tag(html), "");
    EXPECT_EQ(html.find("nan"), std::string::npos);
    EXPECT_EQ(html.find("inf"), std::string::npos);
  }
}

TEST(SvgPlot, BarsShareASlotAndStandOnZero) {
  SvgPlot plot("t", "x", "y");
  plot.bars({2, kNan, 1}, kScanStyle, "a");
  plot.bars({1, 3}, kRegrownStyle, "b");
  plot.categories({"p", "q", "r"});
  const std::string html = plot.figure("p");
  std::size_t count = 0;
  for (std::size_t at = html.find("<rect x=\"3\" y=\"1\""); at != std::string::npos;
       at = html.find("<rect x=\"3\" y=\"1\"", at + 1))
    ++count;
  std::size_t all = 0;
  for (std::size_t at = html.find("<rect"); at != std::string::npos; at = html.find("<rect", at + 1)) ++all;
  EXPECT_EQ(all - count, 4u);  // beside the two in the legend
  EXPECT_NE(html.find(">q</text>"), std::string::npos);
}

TEST(SvgPlot, TicksAreRoundAndInside) {
  for (auto [lo, hi] : {std::pair{0.0, 1.0}, {-3.0, 17.0}, {0.00012, 0.00019}, {1e6, 3e6}}) {
    const std::vector<double> ticks = round_ticks(lo, hi, 5);
    EXPECT_GE(ticks.size(), 3u);
    EXPECT_LE(ticks.size(), 10u);
    for (std::size_t i = 0; i < ticks.size(); ++i) {
      EXPECT_GE(ticks[i], lo - 1e-9 * (hi - lo));
      EXPECT_LE(ticks[i], hi + 1e-9 * (hi - lo));
      EXPECT_TRUE(i == 0 || ticks[i] > ticks[i - 1]);
    }
  }
  EXPECT_EQ(round_ticks(2, 2, 5).size(), 1u);
}

}  // namespace
}  // namespace dendrofit
