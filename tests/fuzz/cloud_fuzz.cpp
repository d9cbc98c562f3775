// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/e57_pages.h"
#include "io/read_cloud.h"
#include "tests/fuzz/fuzz_file.h"

#include <cstring>
#include <vector>

extern "C" int LLVMFuzzerInitialize(int*, char***) {
  ::setenv("PATH", "/nonexistent", 1);  // LAZ: its checks here, its decompressor not
  return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  std::vector<std::uint8_t> bytes(data, data + size);
  if (size >= 1024 && std::memcmp(data, "ASTM-E57", 8) == 0) {  // sound checksums, else none gets past them
    for (std::size_t at = 0; at + 1024 <= size; at += 1024) {
      const std::uint32_t crc = dendrofit::crc32c(reinterpret_cast<const char*>(bytes.data() + at), 1020);
      for (std::size_t k = 0; k < 4; ++k)
        bytes[at + 1020 + k] = static_cast<std::uint8_t>(crc >> (24 - 8 * k));
    }
  }
  return dendrofit::test::fuzz(bytes.data(), bytes.size(),
                               [](const std::string& path) { dendrofit::read_point_cloud(path).validate(); });
}
