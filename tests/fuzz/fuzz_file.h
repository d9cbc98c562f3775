// SPDX-License-Identifier: GPL-3.0-or-later
// The fuzzer's bytes as a file that readers can open, and what a reader may do with them.
#pragma once

#include "core/errors.h"

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string>

#include <sys/mman.h>
#include <unistd.h>

namespace dendrofit::test {

/// Calls read(path) on a file in memory that holds the bytes. A refusal is fine; another exception ends the
/// program.
template <class Read>
int fuzz(const std::uint8_t* data, std::size_t size, const Read& read) {
  static const int file = ::memfd_create("fuzz", 0);
  static const std::string path = "/proc/self/fd/" + std::to_string(file);
  if (::ftruncate(file, 0) != 0 || ::pwrite(file, data, size, 0) != static_cast<ssize_t>(size)) std::abort();
  try {
    read(path);
  } catch (const IoError&) {
  } catch (const InputError& error) {
    // Options are sound and files are answered by IoError: an InputError here is a value no reader should let
    // through.
    std::fprintf(stderr, "InputError: %s\n", error.what());
    std::abort();
  }
  return 0;
}

}  // namespace dendrofit::test
