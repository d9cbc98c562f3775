// SPDX-License-Identifier: GPL-3.0-or-later
#include "forward/leaves/clearance.h"

#include "core/random.h"
#include "tests/leaves/exact_check.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

namespace dendrofit {
namespace {

using Corners = std::array<Vec3, 3>;

Corners random_triangle(Random& draw, double size, double spread) {
  const Vec3 middle = spread * draw.direction() * draw.uniform();
  return {middle + size * draw.direction(), middle + size * draw.direction(),
          middle + size * draw.direction()};
}

leafcheck::Triangle plain(const Corners& t) {
  leafcheck::Triangle out;
  for (std::size_t k = 0; k < 3; ++k) out.corner[k] = {t[k].x(), t[k].y(), t[k].z()};
  return out;
}

/// Least distance found between points spread over both triangles.
double sampled_distance(const Corners& a, const Corners& b) {
  constexpr int kSteps = 14;
  double least = 1e9;
  const auto at = [](const Corners& t, int i, int j) -> Vec3 {
    const double u = static_cast<double>(i) / kSteps, v = static_cast<double>(j) / kSteps;
    return t[0] + u * (t[1] - t[0]) + v * (t[2] - t[0]);
  };
  for (int i = 0; i <= kSteps; ++i)
    for (int j = 0; i + j <= kSteps; ++j)
      for (int k = 0; k <= kSteps; ++k)
        for (int l = 0; k + l <= kSteps; ++l) least = std::min(least, (at(a, i, j) - at(b, k, l)).norm());
  return least;
}

bool clear(const Corners& a, const Corners& b, double gap) {
  return triangles_clear({&a[0], &a[1], &a[2]}, {&b[0], &b[1], &b[2]}, gap);
}

TEST(Clearance, NeverCallsTrianglesClearThatMeetOrComeNear) {
  Random draw(3);
  int called_clear = 0, met = 0;
  for (int n = 0; n < 2000; ++n) {
    const Corners a = random_triangle(draw, 0.4, 0.6), b = random_triangle(draw, 0.4, 0.6);
    const double gap = 0.05;
    const bool apart = clear(a, b, gap);
    const double least = sampled_distance(a, b);
    called_clear += apart ? 1 : 0;
    if (leafcheck::meet(plain(a), plain(b))) {
      ++met;
      EXPECT_FALSE(apart);
    }
    if (least <= gap) {
      EXPECT_FALSE(apart) << least;
    }
    // Conservative, but not by much: a corner facing a corner may be refused up to a gap seen aslant.
    if (least > 3 * gap) {
      EXPECT_TRUE(apart) << least;
    }
  }
  EXPECT_GT(called_clear, 300);
  EXPECT_GT(met, 100);
}

TEST(Clearance, TellsCoplanarTrianglesApart) {
  const Corners a = {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0)};
  const auto moved = [&](double x, double y) {
    Corners b = a;
    for (Vec3& v : b) v += Vec3(x, y, 0);
    return b;
  };
  EXPECT_TRUE(clear(a, moved(1.01, 0), 1e-4));
  EXPECT_FALSE(clear(a, moved(1, 0), 1e-4));        // corner on corner
  EXPECT_FALSE(clear(a, moved(1.00005, 0), 1e-4));  // nearer than the gap
  EXPECT_FALSE(clear(a, moved(0.2, 0.2), 1e-4));    // overlap
  EXPECT_FALSE(clear(a, a, 1e-4));
}

TEST(Clearance, CylindersAgreeWithTheExactTest) {
  Random draw(9);
  const LeafShape shape = [] {
    LeafShape s;
    s.vertices = {{-0.4, 0, 0}, {0.4, 0, 0.1}, {0, 1, 0}};
    s.triangles = {{0, 1, 2}};
    return s;
  }();
  int hits = 0, clears = 0;
  LeafBody body;
  for (int n = 0; n < 4000; ++n) {
    Leaf leaf;
    leaf.direction = draw.direction();
    leaf.normal = leaf.direction.unitOrthogonal();
    leaf.length_m = draw.uniform(0.1, 1.0);
    leaf.petiole_foot = leaf.origin = draw.direction() * draw.uniform(0, 1.2);
    body.set(leaf, shape);
    const Vec3 base = -0.5 * Vec3(0.6, 0, 0.8), tip = -base;
    const SolidCylinder cylinder = solid_cylinder(base, tip, 0.3);
    const bool apart = cylinder_clear(body, cylinder, 1e-4);
    const leafcheck::Triangle t = plain({body.blade[0], body.blade[1], body.blade[2]});
    const bool hit = leafcheck::meets(t, {{base.x(), base.y(), base.z()}, {0.6, 0, 0.8}, 1, 0.3});
    if (hit) {
      EXPECT_FALSE(apart);
    }
    // A hair's breadth decides otherwise only where the gap does.
    if (!apart && !hit) {
      const bool wider = leafcheck::meets(
          t, {{base.x() - 2.4e-4, base.y(), base.z() - 3.2e-4}, {0.6, 0, 0.8}, 1 + 8e-4, 0.3 + 4e-4});
      EXPECT_TRUE(wider);
    }
    hits += hit ? 1 : 0;
    clears += apart ? 1 : 0;
  }
  EXPECT_GT(hits, 400);
  EXPECT_GT(clears, 400);
}

}  // namespace
}  // namespace dendrofit
