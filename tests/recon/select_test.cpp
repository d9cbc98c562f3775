// SPDX-License-Identifier: GPL-3.0-or-later
#include "recon/select.h"

#include "core/random.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

namespace dendrofit {
namespace {

TEST(KthSmallest, is_what_sorting_puts_there) {
  Random random(11);
  for (std::size_t n = 1; n < 80; ++n)
    for (const double steps : {1e9, 3.0}) {  // all different, and nearly all equal to others
      std::vector<double> values(n);
      for (double& v : values) v = std::floor(steps * random.uniform());
      std::vector<double> sorted = values;
      std::sort(sorted.begin(), sorted.end());
      for (std::size_t k = 0; k < n; ++k) {
        std::vector<double> scratch = values;
        ASSERT_EQ(kth_smallest(scratch, k), sorted[k]) << k << " of " << n;
      }
    }
}

TEST(KthSmallest, takes_lists_that_are_sorted_already) {
  std::vector<double> values(1000);
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = static_cast<double>(i);
  std::vector<double> falling(values.rbegin(), values.rend());
  EXPECT_EQ(kth_smallest(values, 500), 500);
  EXPECT_EQ(kth_smallest(falling, 10), 10);
}

}  // namespace
}  // namespace dendrofit
