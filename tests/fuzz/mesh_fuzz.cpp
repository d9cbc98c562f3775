// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/glb_info.h"
#include "io/read_mesh.h"
#include "tests/fuzz/fuzz_file.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return dendrofit::test::fuzz(data, size, [](const std::string& path) {
    const dendrofit::FileBytes bytes(path);
    if (bytes.view().starts_with("glTF"))
      dendrofit::read_glb_info(bytes);
    else
      dendrofit::read_mesh(path).validate();
  });
}
