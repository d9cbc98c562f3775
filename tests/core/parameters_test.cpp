// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/parameters.h"

#include "core/errors.h"

#include <array>
#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace dendrofit {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

constexpr std::array<ParameterSpec, 2> kTable = {{
    {"xm", "Xm", "internodes", 100, 1, 1e6, "final size", "test"},
    {"rate", "r", "1/cycle", 0.34, 0, 10, "rate", "test"},
}};

std::string complaint(const char* key, double value) {
  ParameterSet set(kTable);
  try {
    set.set(key, value, "params.toml:4");
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(Parameters, start_at_their_defaults_and_can_be_set) {
  ParameterSet set(kTable);
  EXPECT_EQ(set.get("rate"), 0.34);
  set.set("rate", 0.5);
  EXPECT_EQ(set.get("rate"), 0.5);
  EXPECT_TRUE(set.knows("xm"));
  EXPECT_FALSE(set.knows("Xm"));
}

TEST(Parameters, a_bad_value_is_named_with_place_and_limit) {
  EXPECT_THAT(complaint("xm", -3), AllOf(HasSubstr("params.toml:4"), HasSubstr("xm = -3"), HasSubstr("1"),
                                         HasSubstr("internodes")));
  EXPECT_THAT(complaint("rate", std::nan("")), HasSubstr("rate = nan"));
  EXPECT_EQ(complaint("rate", 10), "");
}

TEST(Parameters, an_unknown_key_suggests_the_nearest) {
  EXPECT_THAT(complaint("rat", 1), AllOf(HasSubstr("unknown parameter 'rat'"), HasSubstr("'rate'")));
  EXPECT_EQ(nearest_word("bark", {"branch", "dark", "barley"}), "dark");
  EXPECT_EQ(nearest_word("x", {}), "");
}

}  // namespace
}  // namespace dendrofit
