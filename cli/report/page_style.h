// SPDX-License-Identifier: GPL-3.0-or-later
// The report's style sheet.
#pragma once

#include <string_view>

namespace dendrofit {

std::string_view page_style();

}  // namespace dendrofit
