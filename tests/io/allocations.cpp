// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/io/allocations.h"

#include <atomic>
#include <cstdlib>
#include <new>

namespace {
std::atomic<std::size_t> largest{0};
}

// Every allocation of this program passes here.
void* operator new(std::size_t size, const std::nothrow_t&) noexcept {
  std::size_t seen = largest.load();
  while (size > seen && !largest.compare_exchange_weak(seen, size)) {
  }
  return std::malloc(size ? size : 1);
}
void* operator new(std::size_t size) {
  if (void* memory = operator new(size, std::nothrow)) return memory;
  throw std::bad_alloc();
}
void operator delete(void* memory) noexcept {
  std::free(memory);
}
void operator delete(void* memory, std::size_t) noexcept {
  std::free(memory);
}

namespace dendrofit::test {

std::size_t largest_allocation() {
  return largest;
}
void forget_allocations() {
  largest = 0;
}

}  // namespace dendrofit::test
