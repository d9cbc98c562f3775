// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/parallel.h"

#include <algorithm>
#include <thread>

#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

namespace dendrofit {

int resolve_threads(int threads) {
  return threads > 0 ? threads : std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
}

void parallel_blocks(std::size_t count, std::size_t block, int threads,
                     const std::function<void(std::size_t, std::size_t)>& body) {
  if (count == 0) return;
  block = std::max<std::size_t>(1, block);
  const std::size_t blocks = (count + block - 1) / block;
  const auto run = [&](std::size_t b) { body(b * block, std::min(count, (b + 1) * block)); };
  const int workers = std::min(resolve_threads(threads), resolve_threads(0));  // more would only wait
  if (workers == 1 || blocks == 1) {
    for (std::size_t b = 0; b < blocks; ++b) run(b);
    return;
  }
  tbb::task_arena arena(workers);
  arena.execute([&] { tbb::parallel_for(std::size_t{0}, blocks, run); });
}

}  // namespace dendrofit
