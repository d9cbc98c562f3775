// SPDX-License-Identifier: GPL-3.0-or-later
// A strict look at generated markup.
#pragma once

#include <string>

namespace dendrofit::test {

/// The first tag that is not closed in order (or text around a stray "<"); "" for markup that is in order.
/// What stands inside <script> and <style> is passed over.
std::string unclosed_tag(const std::string& html);

}  // namespace dendrofit::test
