// SPDX-License-Identifier: GPL-3.0-or-later
// Whole numbers out of JSON. Not installed: the library's type shows.
#pragma once

#include <cstdint>

#include <nlohmann/json.hpp>

namespace dendrofit {

/// A number without a fraction, 0 or above. Throws the library's type_error for anything else; its own get()
/// would convert 1e300, which is undefined.
template <class Json>
std::uint64_t whole_number(const Json& json) {
  return json.template get_ref<const std::uint64_t&>();
}

/// The same of an optional key.
template <class Json>
std::uint64_t whole_number_or(const Json& object, const char* key, std::uint64_t absent) {
  const auto found = object.find(key);
  return found == object.end() ? absent : whole_number(*found);
}

}  // namespace dendrofit
