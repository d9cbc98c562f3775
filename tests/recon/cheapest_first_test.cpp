// SPDX-License-Identifier: GPL-3.0-or-later
#include "recon/cheapest_first.h"

#include "core/random.h"

#include <queue>
#include <utility>

#include <gtest/gtest.h>

namespace dendrofit {
namespace {

/// Pops `count` points and pushes what they lead to, beside a queue that sorts all.
void expect_order_of_a_sorted_queue(double step, double least, double most, int count) {
  using Entry = std::pair<float, std::uint32_t>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> sorted;
  CheapestFirst queue(step);
  Random random(5);
  std::uint32_t name = 0;
  const auto push = [&](float cost) {
    const std::uint32_t point = name++ * 2654435761U;  // names that do not rise
    sorted.push({cost, point});
    queue.push(cost, point);
  };
  push(0);
  push(0);
  for (int i = 0; i < count; ++i) {
    ASSERT_FALSE(queue.empty());
    const auto [cost, point] = sorted.top();
    sorted.pop();
    ASSERT_EQ(queue.pop(), point) << i;
    const int ways = sorted.size() < 500 ? 2 : 1;
    for (int k = 0; k < ways; ++k) {
      // Whole numbers of the least step, so that many costs are equal.
      const double more = least * static_cast<double>(static_cast<int>(random.uniform() * most / least));
      push(cost + static_cast<float>(more));
    }
  }
  for (; !sorted.empty(); sorted.pop()) ASSERT_EQ(queue.pop(), sorted.top().second);
  EXPECT_TRUE(queue.empty());
}

TEST(CheapestFirst, gives_points_by_cost_then_index) {
  expect_order_of_a_sorted_queue(0.01, 0.02, 1, 20'000);
}
TEST(CheapestFirst, costs_may_fall_into_the_bucket_at_hand) {
  expect_order_of_a_sorted_queue(10, 0.02, 1, 5'000);
}
TEST(CheapestFirst, costs_may_lie_beyond_all_buckets) {
  expect_order_of_a_sorted_queue(1e-5, 1e-5, 1, 20'000);
}
TEST(CheapestFirst, is_empty_at_first) {
  EXPECT_TRUE(CheapestFirst(1).empty());
}

}  // namespace
}  // namespace dendrofit
