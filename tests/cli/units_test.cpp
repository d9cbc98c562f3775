// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/units.h"

#include <stdexcept>

#include <gtest/gtest.h>

namespace dendrofit::cli {
namespace {

TEST(Units, lengths_with_and_without_suffix) {
  EXPECT_DOUBLE_EQ(parse_quantity("5mm", Quantity::length), 0.005);
  EXPECT_DOUBLE_EQ(parse_quantity("0.6m", Quantity::length), 0.6);
  EXPECT_DOUBLE_EQ(parse_quantity("12.4", Quantity::length), 12.4);
  EXPECT_DOUBLE_EQ(parse_quantity("3 cm", Quantity::length), 0.03);
  EXPECT_DOUBLE_EQ(parse_quantity("10ft", Quantity::length), 3.048);
}

TEST(Units, angles_areas_and_times) {
  EXPECT_NEAR(parse_quantity("3.14159265358979rad", Quantity::angle), 180, 1e-9);
  EXPECT_DOUBLE_EQ(parse_quantity("30deg", Quantity::angle), 30);
  EXPECT_DOUBLE_EQ(parse_quantity("2500cm2", Quantity::area), 0.25);
  EXPECT_DOUBLE_EQ(parse_quantity("8min", Quantity::duration), 480);
}

TEST(Units, nonsense_is_refused_with_what_is_allowed) {
  for (const char* text : {"", "m", "five", "5 bananas", "5mm2", "nan", "inf", "1e999", "5,3"})
    EXPECT_THROW(parse_quantity(text, Quantity::length), std::invalid_argument) << text;
  EXPECT_THROW(parse_quantity("5mm", Quantity::pure), std::invalid_argument);
  try {
    parse_quantity("5yd", Quantity::length);
    FAIL();
  } catch (const std::invalid_argument& error) {
    EXPECT_NE(std::string(error.what()).find("mm"), std::string::npos);
  }
}

TEST(Units, formatting_parses_back_to_the_same_number) {
  for (const double value : {0.0, 0.004, 0.005, 0.0123456789, 1.3, 1.5, 12.4, 500.0, 1.0 / 3})
    for (const Quantity q :
         {Quantity::pure, Quantity::length, Quantity::angle, Quantity::area, Quantity::duration})
      EXPECT_EQ(parse_quantity(format_quantity(value, q), q), value);
  EXPECT_EQ(format_quantity(0.005, Quantity::length), "5mm");
}

}  // namespace
}  // namespace dendrofit::cli
