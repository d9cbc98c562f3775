// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/report/html.h"

#include <limits>

#include <gtest/gtest.h>

namespace dendrofit {
namespace {

TEST(Html, EscapesWhatWouldBecomeMarkup) {
  EXPECT_EQ(escape_html("<a href=\"x\">'&'</a>"), "&lt;a href=&quot;x&quot;&gt;&#39;&amp;&#39;&lt;/a&gt;");
  EXPECT_EQ(escape_html("B\xc3\xa4ume \xf0\x9f\x8c\xb3"), "B\xc3\xa4ume \xf0\x9f\x8c\xb3");
  EXPECT_EQ(escape_html("a\xff\x01z"), "a\xef\xbf\xbdz");
  EXPECT_EQ(escape_html("\xc3"), "\xef\xbf\xbd");
}

TEST(Html, JsonStringsCannotEndTheirScript) {
  EXPECT_EQ(quote_json("</script>"), "\"\\u003c/script\\u003e\"");
  EXPECT_EQ(quote_json("a\"\\\n"), "\"a\\u0022\\u005c\\u000a\"");
}

TEST(Html, NumbersAreShortAndNeverNan) {
  EXPECT_EQ(number(12.3456), "12.35");
  EXPECT_EQ(measured(6.2), "6.20");
  EXPECT_EQ(measured(0.05123), "0.0512");
  EXPECT_EQ(measured(9.996), "10.0");
  EXPECT_EQ(measured(-21.964), "-22.0");
  EXPECT_EQ(measured(4958.4), "4958");
  EXPECT_EQ(measured(0), "0.00");
  EXPECT_EQ(measured(std::numeric_limits<double>::infinity()), "\xe2\x80\x93");
  EXPECT_EQ(number(1234567.0), "1234567");
  EXPECT_EQ(number(-1e-30 * 0.0), "0");
  EXPECT_EQ(number(0.00012345), "0.0001234");
  EXPECT_EQ(number(std::numeric_limits<double>::quiet_NaN()), "\xe2\x80\x93");
  EXPECT_EQ(number(std::optional<double>{}), "\xe2\x80\x93");
  EXPECT_EQ(fixed(2.345, 1), "2.3");
  EXPECT_EQ(json_number(std::numeric_limits<double>::infinity()), "null");
}

TEST(Html, Base64FollowsTheStandardsExamples) {  // RFC 4648, 10
  EXPECT_EQ(base64(""), "");
  EXPECT_EQ(base64("f"), "Zg==");
  EXPECT_EQ(base64("fo"), "Zm8=");
  EXPECT_EQ(base64("foobar"), "Zm9vYmFy");
  EXPECT_EQ(base64(std::string_view("\xff\x00\xfe", 3)), "/wD+");
}

TEST(Html, TablesNameTheirColumnsInEveryCell) {
  const HtmlTable table{"t\"1", "cap<", {"a", "b&c"}, {0, 1}, {{"x", "1"}, {"y", "2"}}};
  const std::string html = table.html();
  EXPECT_NE(html.find("id=\"t&quot;1\""), std::string::npos);
  EXPECT_NE(html.find("<td class=\"n\" data-name=\"b&amp;c\"><span>2</span></td>"), std::string::npos);
  EXPECT_NE(html.find("<th scope=\"row\">y</th>"), std::string::npos);
}

}  // namespace
}  // namespace dendrofit
