// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/report/colours.h"

#include "tests/report/sample.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

namespace dendrofit {
namespace {

using Row = std::array<double, 3>;

// Machado, Oliveira & Fernandes (2009), severity 1, on linear RGB.
constexpr std::array<Row, 3> kNoRed = {
    {{0.152286, 1.052583, -0.204868}, {0.114503, 0.786281, 0.099216}, {-0.003882, -0.048116, 1.051998}}};
constexpr std::array<Row, 3> kNoGreen = {
    {{0.367322, 0.860646, -0.227968}, {0.280085, 0.672501, 0.047413}, {-0.011820, 0.042940, 0.968881}}};

Row linear(Rgb c) {
  const auto one = [](double v) { return v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4); };
  return {one(c.r / 255.0), one(c.g / 255.0), one(c.b / 255.0)};
}

Row times(const std::array<Row, 3>& m, const Row& v) {
  Row out{};
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t k = 0; k < 3; ++k) out[i] += m[i][k] * v[k];
  return out;
}

Row lab(const Row& rgb) {
  constexpr std::array<Row, 3> kToXyz = {
      {{0.4124, 0.3576, 0.1805}, {0.2126, 0.7152, 0.0722}, {0.0193, 0.1192, 0.9505}}};
  Row xyz = times(kToXyz, rgb);
  const Row white = {0.9505, 1.0, 1.089};
  for (std::size_t i = 0; i < 3; ++i) {
    const double t = std::max(0.0, xyz[i] / white[i]);
    xyz[i] = t > 0.008856 ? std::cbrt(t) : 7.787 * t + 16.0 / 116;
  }
  return {116 * xyz[1] - 16, 500 * (xyz[0] - xyz[1]), 200 * (xyz[1] - xyz[2])};
}

double apart(const Row& a, const Row& b) {
  return std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
}

TEST(Colours, NeighbouringOrdersAndQualitiesStayApartWithoutRedOrGreenVision) {
  std::vector<std::pair<Rgb, Rgb>> pairs;
  for (int order = 0; order + 1 < static_cast<int>(kOrderColours.size()); ++order)
    pairs.emplace_back(order_colour(order), order_colour(order + 1));
  for (int a = 0; a < 4; ++a)
    for (int b = 0; b < a; ++b)
      pairs.emplace_back(quality_colour(static_cast<RadiusQuality>(a)),
                         quality_colour(static_cast<RadiusQuality>(b)));
  for (const auto& [a, b] : pairs)
    for (const auto& vision : {kNoRed, kNoGreen})
      EXPECT_GT(apart(lab(times(vision, linear(a))), lab(times(vision, linear(b)))), 20) << hex(a) << hex(b);
}

TEST(Colours, TheScaleGetsLighterAllTheWay) {
  double before = -1;
  for (int k = 0; k <= 20; ++k) {
    const double lightness = lab(linear(scale_colour(k / 20.0)))[0];
    EXPECT_GT(lightness, before);
    before = lightness;
  }
  EXPECT_EQ(scale_colour(-3), scale_colour(0));
  EXPECT_EQ(scale_colour(7), scale_colour(1));
  EXPECT_EQ(scale_colour(std::numeric_limits<double>::quiet_NaN()), scale_colour(0));
}

TEST(Colours, EveryModeColoursEveryCylinder) {
  const Tree tree = test::branching_tree(2, 3);
  for (TreeColour mode : {TreeColour::order, TreeColour::quality, TreeColour::radius, TreeColour::birth_cycle,
                          TreeColour::bark})
    EXPECT_EQ(tree_colours(tree, mode).size(), tree.size());
  EXPECT_EQ(tree_colours(tree, TreeColour::order)[0], order_colour(0));
  EXPECT_NE(tree_colours(tree, TreeColour::radius).front(), tree_colours(tree, TreeColour::radius).back());
  EXPECT_TRUE(tree_colours(Tree{}, TreeColour::radius).empty());
}

TEST(Colours, HexHasSixDigits) {
  EXPECT_EQ(hex({0, 90, 160}), "#005aa0");
}

}  // namespace
}  // namespace dendrofit
