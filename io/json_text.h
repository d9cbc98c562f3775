// SPDX-License-Identifier: GPL-3.0-or-later
// JSON as text, the one way it is written. Not installed: the library's type shows.
#pragma once

#include <string>

#include <nlohmann/json_fwd.hpp>

namespace dendrofit {

/// The indented text of an object. Bytes that are no UTF-8 (a file's name, a name inside a file) become
/// U+FFFD; nothing is thrown for them.
std::string json_text(const nlohmann::ordered_json& json, int indent = 2);

/// The same of a plain text, for files of other kinds.
std::string valid_utf8(const std::string& text);

}  // namespace dendrofit
