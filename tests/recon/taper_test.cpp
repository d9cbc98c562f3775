// SPDX-License-Identifier: GPL-3.0-or-later
#include "recon/taper.h"

#include "core/errors.h"
#include "core/random.h"

#include <gtest/gtest.h>

namespace dendrofit {
namespace {

TEST(Taper, keeps_what_falls_already) {
  EXPECT_EQ(falling_towards_tips({3, 2, 1, 1.5}, {1, 1, 1, 1}, {-1, 0, 1, 1}),
            (std::vector<double>{3, 2, 1, 1.5}));
}

TEST(Taper, pools_a_thick_child_with_its_thin_parent_by_weight) {
  const auto fitted = falling_towards_tips({5, 1, 4}, {1, 1, 3}, {-1, 0, 1});
  EXPECT_DOUBLE_EQ(fitted[0], 5);
  EXPECT_DOUBLE_EQ(fitted[1], 3.25);
  EXPECT_DOUBLE_EQ(fitted[2], 3.25);
}

TEST(Taper, never_rises_and_meets_the_optimality_conditions_on_random_trees) {
  Random random(11);
  std::vector<double> value, weight;
  std::vector<std::int32_t> parent;
  for (int i = 0; i < 300; ++i) {
    value.push_back(random.uniform());
    weight.push_back(0.1 + random.uniform());
    parent.push_back(i == 0 ? -1 : static_cast<std::int32_t>(random.below(static_cast<std::uint64_t>(i))));
  }
  const auto fitted = falling_towards_tips(value, weight, parent);
  // Within each level set the residuals cancel (first-order condition for shifting it as a whole).
  double total = 0;
  for (std::size_t i = 0; i < fitted.size(); ++i) {
    if (parent[i] >= 0) {
      EXPECT_LE(fitted[i], fitted[static_cast<std::size_t>(parent[i])] + 1e-12);
    }
    total += weight[i] * (fitted[i] - value[i]) * fitted[i];
  }
  EXPECT_NEAR(total, 0, 1e-9);
}

TEST(Taper, refuses_columns_that_do_not_fit) {
  EXPECT_TRUE(falling_towards_tips({}, {}, {}).empty());
  EXPECT_THROW(falling_towards_tips({1}, {1, 2}, {-1}), InputError);
  EXPECT_THROW(falling_towards_tips({1}, {0}, {-1}), InputError);
  EXPECT_THROW(falling_towards_tips({1, 2}, {1, 1}, {1, -1}), InputError);
}

}  // namespace
}  // namespace dendrofit
