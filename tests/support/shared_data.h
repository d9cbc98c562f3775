// SPDX-License-Identifier: GPL-3.0-or-later
// Larger data that developers keep beside the checkout; tests that want it skip with a message where it is
// absent.
#pragma once

#include <cstdlib>
#include <filesystem>
#include <string>

namespace dendrofit::test {

/// The file or folder under $DENDROFIT_SHARED_DATA (default: ../shared/data beside the checkout).
inline std::filesystem::path shared_data(const std::string& relative) {
  const char* set = std::getenv("DENDROFIT_SHARED_DATA");
  return (set ? std::filesystem::path(set)
              : std::filesystem::path(DENDROFIT_SOURCE_DIR).parent_path() / "shared" / "data") /
         relative;
}

}  // namespace dendrofit::test

/// First line of a test that needs shared data.
#define DENDROFIT_NEED(path) \
  if (!std::filesystem::exists(path)) GTEST_SKIP() << "not here: " << (path) << " (set DENDROFIT_SHARED_DATA)"
