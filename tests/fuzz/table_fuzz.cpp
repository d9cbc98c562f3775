// SPDX-License-Identifier: GPL-3.0-or-later
// Measurement tables, metrics.json and TOML: the first byte says which.
#include "io/metrics_json.h"
#include "io/read_table.h"
#include "io/toml.h"
#include "tests/fuzz/fuzz_file.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  return dendrofit::test::fuzz(data + 1, size - 1, [kind = data[0] % 3](const std::string& path) {
    if (kind == 0) dendrofit::read_measurements(path);
    if (kind == 1) dendrofit::metrics_from_json(path);
    if (kind == 2) dendrofit::read_toml(path);
  });
}
