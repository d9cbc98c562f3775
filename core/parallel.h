// SPDX-License-Identifier: GPL-3.0-or-later
// Loops over blocks of indices on several threads. The blocks depend on `count` and `block` alone, so a loop
// whose body writes only what belongs to its indices gives the same result for any number of threads.
#pragma once

#include <cstddef>
#include <functional>

namespace dendrofit {

/// Calls body(first, last) for [0, count) cut into blocks of `block` (the last may be shorter), on up to
/// `threads` threads (0: all cores). Exceptions thrown by a body reach the caller.
void parallel_blocks(std::size_t count, std::size_t block, int threads,
                     const std::function<void(std::size_t first, std::size_t last)>& body);

/// The number of threads that `threads` means: itself, or the machine's cores for 0.
int resolve_threads(int threads);

}  // namespace dendrofit
