// SPDX-License-Identifier: GPL-3.0-or-later
// The 3-D view's script, made from cli/report/viewer/ when dendrofit is built.
#pragma once

#include <string_view>

namespace dendrofit {

/// JavaScript safe to put inside <script>; empty in a build without Node.js and npm.
std::string_view viewer_bundle();

}  // namespace dendrofit
