// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string_view>

namespace dendrofit::cli {

/// The program's version, as CMake's project() states it.
std::string_view version();

}  // namespace dendrofit::cli
