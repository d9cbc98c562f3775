// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/parallel.h"

#include <atomic>
#include <mutex>
#include <set>
#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

namespace dendrofit {
namespace {

TEST(Parallel, every_index_once_in_the_same_blocks) {
  for (const int threads : {1, 2, 7}) {
    std::vector<int> hits(1003);
    std::mutex mutex;
    std::set<std::pair<std::size_t, std::size_t>> blocks;
    parallel_blocks(hits.size(), 100, threads, [&](std::size_t first, std::size_t last) {
      for (std::size_t i = first; i < last; ++i) ++hits[i];
      const std::lock_guard lock(mutex);
      blocks.emplace(first, last);
    });
    for (const int h : hits) ASSERT_EQ(h, 1);
    EXPECT_EQ(blocks.size(), 11u);
    EXPECT_TRUE(blocks.count({1000, 1003}));
  }
}

TEST(Parallel, an_exception_reaches_the_caller) {
  EXPECT_THROW(parallel_blocks(50, 1, 2,
                               [](std::size_t first, std::size_t) {
                                 if (first == 31) throw std::runtime_error("31");
                               }),
               std::runtime_error);
}

TEST(Parallel, nothing_to_do) {
  std::atomic<int> calls = 0;
  parallel_blocks(0, 10, 2, [&](std::size_t, std::size_t) { ++calls; });
  EXPECT_EQ(calls, 0);
  EXPECT_GE(resolve_threads(0), 1);
  EXPECT_EQ(resolve_threads(3), 3);
}

}  // namespace
}  // namespace dendrofit
