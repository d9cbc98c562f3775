// SPDX-License-Identifier: GPL-3.0-or-later
// Memory that starts as zeros, given out in small pieces and taken back all at once.
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

namespace dendrofit {

/// Asks the system for whole chunks, in large pages where it has them: a page fault for every 4 KiB would
/// cost more than the work done there.
class ZeroArena {
 public:
  /// `bytes` of zeros, aligned to 64 as long as every piece is a multiple of 64; at most a chunk.
  void* take(std::size_t bytes);
  std::size_t taken_bytes() const { return taken_; }

  static constexpr std::size_t kChunkBytes = std::size_t{4} << 20;

 private:
  struct Release {
    void operator()(void* chunk) const;
  };
  std::vector<std::unique_ptr<void, Release>> chunks_;
  std::size_t left_ = 0;  // bytes of the last chunk
  std::size_t taken_ = 0;
};

}  // namespace dendrofit
