// SPDX-License-Identifier: GPL-3.0-or-later
#include "forward/environment/zero_arena.h"

#include <cstdlib>
#include <new>

#ifdef __linux__
#include <sys/mman.h>
#endif

namespace dendrofit {
namespace {

#ifdef __linux__
constexpr std::size_t kLargePage = std::size_t{2} << 20;

void* make_chunk() {
  // Some more, so that a piece of it starts on a large page; what lies beside it goes back.
  const std::size_t bytes = ZeroArena::kChunkBytes + kLargePage;
  void* const mapped = mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  if (mapped == MAP_FAILED) throw std::bad_alloc();
  void* chunk = mapped;
  std::size_t space = bytes;
  std::align(kLargePage, ZeroArena::kChunkBytes, chunk, space);
  const std::size_t before = bytes - space, after = space - ZeroArena::kChunkBytes;
  if (before > 0) munmap(mapped, before);
  if (after > 0) munmap(static_cast<char*>(chunk) + ZeroArena::kChunkBytes, after);
  madvise(chunk, ZeroArena::kChunkBytes, MADV_HUGEPAGE);
  return chunk;
}

void free_chunk(void* chunk) {
  munmap(chunk, ZeroArena::kChunkBytes);
}
#else
void* make_chunk() {
  void* const chunk = std::calloc(ZeroArena::kChunkBytes, 1);
  if (!chunk) throw std::bad_alloc();
  return chunk;
}

void free_chunk(void* chunk) {
  std::free(chunk);
}
#endif

}  // namespace

void ZeroArena::Release::operator()(void* chunk) const {
  free_chunk(chunk);
}

void* ZeroArena::take(std::size_t bytes) {
  if (bytes > kChunkBytes) throw std::bad_alloc();
  if (bytes > left_) {
    chunks_.emplace_back(make_chunk());
    left_ = kChunkBytes;
  }
  char* const piece = static_cast<char*>(chunks_.back().get()) + (kChunkBytes - left_);
  left_ -= bytes;
  taken_ += bytes;
  return piece;
}

}  // namespace dendrofit
