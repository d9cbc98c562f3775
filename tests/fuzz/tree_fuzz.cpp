// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/read_tree.h"
#include "tests/fuzz/fuzz_file.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return dendrofit::test::fuzz(data, size,
                               [](const std::string& path) { dendrofit::read_tree(path).validate(); });
}
