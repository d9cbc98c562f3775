// SPDX-License-Identifier: GPL-3.0-or-later
// How much memory the program asked for at once.
#pragma once

#include <cstddef>

namespace dendrofit::test {

/// Bytes of the largest `new` since forget_allocations().
std::size_t largest_allocation();
void forget_allocations();

}  // namespace dendrofit::test
