// SPDX-License-Identifier: GPL-3.0-or-later
#include "forward/environment/zero_arena.h"

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <new>

#include <gtest/gtest.h>

namespace dendrofit {
namespace {

TEST(ZeroArena, gives_pieces_of_zeros_that_do_not_overlap) {
  ZeroArena arena;
  constexpr std::size_t kBytes = 192 * 1024;  // chunks are not a multiple of it
  std::vector<unsigned char*> pieces;
  for (int i = 0; i < 50; ++i) {
    auto* piece = static_cast<unsigned char*>(arena.take(kBytes));
    EXPECT_EQ(reinterpret_cast<std::uintptr_t>(piece) % 64, 0u);
    EXPECT_EQ(std::count(piece, piece + kBytes, 0), static_cast<std::ptrdiff_t>(kBytes));
    std::memset(piece, i + 1, kBytes);
    pieces.push_back(piece);
  }
  for (int i = 0; i < 50; ++i)
    EXPECT_EQ(
        std::count(pieces[static_cast<std::size_t>(i)], pieces[static_cast<std::size_t>(i)] + kBytes, i + 1),
        static_cast<std::ptrdiff_t>(kBytes));
  EXPECT_EQ(arena.taken_bytes(), 50 * kBytes);
}

TEST(ZeroArena, refuses_more_than_a_chunk_at_once) {
  ZeroArena arena;
  EXPECT_THROW(arena.take(ZeroArena::kChunkBytes + 1), std::bad_alloc);
  EXPECT_NE(arena.take(ZeroArena::kChunkBytes), nullptr);
}

}  // namespace
}  // namespace dendrofit
