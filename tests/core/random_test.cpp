// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/random.h"

#include <array>
#include <cmath>
#include <set>

#include <gtest/gtest.h>

namespace dendrofit {
namespace {

TEST(Random, a_child_depends_on_its_keys_alone) {
  Random parent(7);
  Random early = parent.child({3, 5});
  for (int i = 0; i < 10; ++i) parent.bits();
  Random late = parent.child({3, 5});
  EXPECT_EQ(early.bits(), late.bits());
  EXPECT_NE(parent.child({3, 5}).bits(), parent.child({5, 3}).bits());
  EXPECT_NE(Random(7).bits(), Random(8).bits());
}

TEST(Random, neighbouring_keys_do_not_collide) {
  std::set<std::uint64_t> seen;
  for (std::uint64_t a = 0; a < 100; ++a)
    for (std::uint64_t b = 0; b < 100; ++b) seen.insert(Random(1).child({a, b}).bits());
  EXPECT_EQ(seen.size(), 10000u);
}

TEST(Random, uniform_fills_its_range_evenly) {
  Random random(1);
  std::array<int, 10> bins{};
  constexpr int kDraws = 100000;
  for (int i = 0; i < kDraws; ++i) ++bins[static_cast<std::size_t>(10 * random.uniform())];
  double chi2 = 0;
  for (const int count : bins) chi2 += (count - kDraws / 10.0) * (count - kDraws / 10.0) / (kDraws / 10.0);
  EXPECT_LT(chi2, 27.9);  // 0.1 % point of chi2 with 9 degrees of freedom
}

TEST(Random, first_draws_of_neighbouring_streams_are_independent) {
  double sum = 0;
  double product = 0;
  constexpr int kStreams = 20000;
  double previous = Random(1).child({0}).uniform();
  for (std::uint64_t k = 1; k <= kStreams; ++k) {
    const double u = Random(1).child({k}).uniform();
    sum += u;
    product += (u - 0.5) * (previous - 0.5);
    previous = u;
  }
  EXPECT_NEAR(sum / kStreams, 0.5, 4 * std::sqrt(1.0 / 12 / kStreams));
  EXPECT_NEAR(product / kStreams, 0, 4.0 / 12 / std::sqrt(kStreams));
}

TEST(Random, normal_has_mean_zero_and_unit_variance) {
  Random random(2);
  double sum = 0;
  double squares = 0;
  constexpr int kDraws = 100000;
  for (int i = 0; i < kDraws; ++i) {
    const double z = random.normal();
    sum += z;
    squares += z * z;
  }
  EXPECT_NEAR(sum / kDraws, 0, 4 / std::sqrt(kDraws));
  EXPECT_NEAR(squares / kDraws, 1, 4 * std::sqrt(2.0 / kDraws));
}

TEST(Random, directions_are_unit_and_centred) {
  Random random(3);
  Vec3 sum = Vec3::Zero();
  for (int i = 0; i < 10000; ++i) {
    const Vec3 d = random.direction();
    ASSERT_NEAR(d.norm(), 1, 1e-12);
    sum += d;
  }
  EXPECT_LT((sum / 10000).norm(), 0.03);
}

TEST(Random, below_stays_below) {
  Random random(4);
  std::array<int, 7> bins{};
  for (int i = 0; i < 7000; ++i) ++bins.at(random.below(7));
  for (const int count : bins) EXPECT_NEAR(count, 1000, 150);
}

}  // namespace
}  // namespace dendrofit
