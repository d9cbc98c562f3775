// SPDX-License-Identifier: GPL-3.0-or-later
// The checker must be able to fail: every kind of fault, injected.
#include "tests/leaves/exact_check.h"

#include "tests/support/shared_data.h"

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <random>

#include <gtest/gtest.h>

namespace leafcheck {
namespace {

using Point = std::array<double, 3>;

Triangle triangle(Point a, Point b, Point c, std::size_t leaf = 0) {
  return {{a, b, c}, leaf};
}

const Triangle kFlat = triangle({0, 0, 0}, {1, 0, 0}, {0, 1, 0});

TEST(ExactCheck, FindsACoplanarOverlap) {
  EXPECT_TRUE(meet(kFlat, triangle({0.2, 0.2, 0}, {1.2, 0.2, 0}, {0.2, 1.2, 0}, 1)));
  EXPECT_TRUE(meet(kFlat, triangle({0.2, 0.2, 0}, {0.3, 0.2, 0}, {0.2, 0.3, 0}, 1)));  // wholly inside
  EXPECT_FALSE(meet(kFlat, triangle({1.2, 1.2, 0}, {2.2, 1.2, 0}, {1.2, 2.2, 0}, 1)));
}

TEST(ExactCheck, FindsAnEdgeTouch) {
  EXPECT_TRUE(meet(kFlat, triangle({0, 0, 0}, {1, 0, 0}, {0.5, 0, 1}, 1)));
  EXPECT_TRUE(
      meet(kFlat, triangle({0.5, 0.5, 0}, {1, 1, 0}, {1, 1, 1}, 1)));  // a corner on the slanting edge
}

TEST(ExactCheck, FindsAContactOneUlpDeepAndNoneOneUlpApart) {
  const double up = std::nextafter(0.0, 1.0), down = std::nextafter(0.0, -1.0);
  const auto standing = [](double foot) {
    return triangle({0.3, 0.3, foot}, {0.2, 0.3, 1}, {0.4, 0.3, 1}, 1);
  };
  EXPECT_TRUE(meet(kFlat, standing(down)));
  EXPECT_TRUE(meet(kFlat, standing(0)));
  EXPECT_FALSE(meet(kFlat, standing(up)));
}

const Cylinder kPost = {{0, 0, 0}, {0, 0, 1}, 2, 0.5};

TEST(ExactCheck, FindsALeafWhollyInsideACylinder) {
  EXPECT_TRUE(meets(triangle({0.1, 0, 1}, {0.2, 0, 1}, {0.1, 0.1, 1}), kPost));
}

TEST(ExactCheck, FindsALeafThatTheAxisPierces) {
  EXPECT_TRUE(meets(triangle({-5, -5, 1}, {5, -5, 1}, {0, 7, 1.2}), kPost));
}

TEST(ExactCheck, FindsAPiercedCap) {
  EXPECT_TRUE(meets(triangle({0.1, 0.1, 1.9}, {0.1, 0.2, 3}, {0.2, 0.1, 3}), kPost));
  EXPECT_FALSE(meets(triangle({0.1, 0.1, 2.1}, {0.1, 0.2, 3}, {0.2, 0.1, 3}), kPost));
  // Outside the rim, though inside the round cap a capsule would have.
  EXPECT_FALSE(meets(triangle({0.45, 0, 2.05}, {0.6, 0.1, 2.1}, {0.6, -0.1, 2.1}), kPost));
}

TEST(ExactCheck, TouchingACylinderCounts) {
  std::size_t doubtful = 0;
  EXPECT_TRUE(meets(triangle({0.5, 0, 1}, {1, 0, 1}, {1, 0, 1.5}), kPost, &doubtful));      // its side
  EXPECT_TRUE(meets(triangle({0.1, 0, 2}, {0.2, 0, 3}, {0.1, 0.1, 3}), kPost, &doubtful));  // its cap
  EXPECT_EQ(doubtful, 0U);  // round numbers: the intervals are points
}

TEST(ExactCheck, AsksRationalNumbersWhereIntervalsCannotTell) {
  std::size_t doubtful = 0;
  int hits = 0;
  for (int k = 1; k <= 200; ++k) {
    // In decimals the corner lies on the surface; in doubles to the side that exact arithmetic tells.
    const double x = 0.003 * k, y = 0.004 * k, r = 0.005 * k;
    const bool hit =
        meets(triangle({x, y, 1}, {9, 9, 1}, {9, 9, 1.5}), {{0, 0, 0}, {0, 0, 1}, 2, r}, &doubtful);
    __extension__ const __float128 wx = x, wy = y, wr = r;
    EXPECT_EQ(hit, wx * wx + wy * wy <= wr * wr) << k;
    hits += hit;
  }
  EXPECT_GT(doubtful, 50U);
  EXPECT_GT(hits, 20);
  EXPECT_LT(hits, 180);
}

TEST(ExactCheck, DecidesOneUlpAtTheSurface) {
  const double in = std::nextafter(0.5, 0.0), out = std::nextafter(0.5, 1.0);
  EXPECT_TRUE(meets(triangle({in, 0, 1}, {1, 0, 1}, {1, 0, 1.5}), kPost));
  EXPECT_FALSE(meets(triangle({out, 0, 1}, {1, 0, 1}, {1, 0, 1.5}), kPost));
  const double below = std::nextafter(2.0, 0.0), above = std::nextafter(2.0, 3.0);
  EXPECT_TRUE(meets(triangle({0.1, 0, below}, {0.2, 0, 3}, {0.1, 0.1, 3}), kPost));
  EXPECT_FALSE(meets(triangle({0.1, 0, above}, {0.2, 0, 3}, {0.1, 0.1, 3}), kPost));
}

TEST(ExactCheck, AgreesWithSamplingOnRandomTriangles) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> at(-1.2, 1.2), share(0, 1);
  int hits = 0;
  for (int n = 0; n < 3000; ++n) {
    Triangle t;
    const Point middle = {at(random), at(random), 1 + 1.5 * at(random)};
    for (Point& p : t.corner)
      for (std::size_t k = 0; k < 3; ++k) p[k] = middle[k] + 0.5 * at(random);
    double deepest = 1e9;  // how far the deepest sample is outside the solid
    for (int s = 0; s < 400; ++s) {
      double u = share(random), v = share(random);
      if (u + v > 1) u = 1 - u, v = 1 - v;
      Point x{};
      for (std::size_t k = 0; k < 3; ++k)
        x[k] = t.corner[0][k] + u * (t.corner[1][k] - t.corner[0][k]) + v * (t.corner[2][k] - t.corner[0][k]);
      deepest = std::min(deepest, std::max({std::hypot(x[0], x[1]) - 0.5, -x[2], x[2] - 2}));
    }
    const bool hit = meets(t, kPost);
    hits += hit;
    if (deepest < 0) {
      EXPECT_TRUE(hit) << n;
    }
    if (deepest > 0.15) {
      EXPECT_FALSE(hit) << n;
    }
  }
  EXPECT_GT(hits, 300);
  EXPECT_LT(hits, 2700);
}

TEST(ExactCheck, BoxesMissNothingBruteForceFinds) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> at(0, 1);
  std::vector<Triangle> triangles;
  for (std::size_t i = 0; i < 300; ++i) {
    const Point m = {at(random), at(random), at(random)};
    Triangle t;
    t.leaf = i;
    for (Point& p : t.corner)
      for (std::size_t k = 0; k < 3; ++k) p[k] = m[k] + 0.2 * at(random);
    triangles.push_back(t);
  }
  std::size_t pairs = 0;
  for (std::size_t i = 0; i < triangles.size(); ++i)
    for (std::size_t j = i + 1; j < triangles.size(); ++j) pairs += meet(triangles[i], triangles[j]) ? 1 : 0;
  const Verdict verdict = check(triangles, {}, nullptr);
  EXPECT_EQ(verdict.leaf_hits.size(), pairs);
  EXPECT_GT(pairs, 20U);
}

TEST(ExactCheck, NamesGroundAndDegenerateTriangles) {
  const double ground = 0;
  const Verdict verdict = check({kFlat, triangle({0, 0, 5}, {1, 0, 5}, {2, 0, 5}, 1)}, {}, &ground);
  EXPECT_EQ(verdict.ground_hits, std::vector<std::size_t>{0});
  EXPECT_EQ(verdict.degenerate, std::vector<std::size_t>{1});
  EXPECT_FALSE(verdict.clean());
}

class CheckLeavesProgram : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::temp_directory_path() /
              ("check_leaves_" + std::string(testing::UnitTest::GetInstance()->current_test_info()->name()));
    std::filesystem::create_directories(folder_);
    std::ofstream(folder_ / "qsm.csv")
        << "id,parent,axis,order,start_x,start_y,start_z,axis_x,axis_y,axis_z,length,"
           "radius,quality,radius_se\n1,0,1,0,0,0,0,0,0,1,2,0.5,measured,\n";
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }
  int run(const std::string& obj) {
    std::ofstream(folder_ / "leaves.obj") << obj;
    const std::string command = std::string(CHECK_LEAVES_PROGRAM) + " " + (folder_ / "leaves.obj").string() +
                                " " + (folder_ / "qsm.csv").string() + " > " +
                                (folder_ / "out.txt").string() + " 2>&1";
    return WEXITSTATUS(std::system(command.c_str()));
  }
  std::filesystem::path folder_;
};

TEST_F(CheckLeavesProgram, IsContentWithLeavesThatKeepApart) {
  EXPECT_EQ(run("v 1 0 1\nv 2 0 1\nv 1 1 1\nf 1 2 3\nv 1 0 1.1\nv 2 0 1.1\nv 1 1 1.1\nf 4 5 6\n"), 0);
}

TEST_F(CheckLeavesProgram, FailsOnLeavesThatMeetAndOnLeavesInWood) {
  EXPECT_EQ(run("v 1 0 1\nv 2 0 1\nv 1 1 1\nf 1 2 3\nv 1.2 0.1 0.9\nv 1.3 0.1 1.1\nv 1.2 0.3 1.1\nf 4 5 6\n"),
            1);
  EXPECT_EQ(run("v 0.4 0 1\nv 2 0 1\nv 1 1 1\nf 1 2 3\n"), 1);
  EXPECT_EQ(run("v 1 0 -1\nv 2 0 1\nv 1 1 1\nf 1 2 3\n"), 1);
}

TEST_F(CheckLeavesProgram, RefusesAFileItCannotRead) {
  EXPECT_EQ(run("v 1 0\n"), 2);
  EXPECT_EQ(run("v 1 0 1\nf 1 2 3\n"), 2);
}

}  // namespace
}  // namespace leafcheck
