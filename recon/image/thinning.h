// SPDX-License-Identifier: GPL-3.0-or-later
// A silhouette worn down to lines one pixel wide.
#pragma once

#include <cstdint>
#include <vector>

namespace dendrofit {

/// Parallel thinning after Zhang & Suen (1984), then removal of the corner pixels it leaves, so that every
/// inner pixel of a line has two neighbours (of eight). Keeps the number of pieces and of holes. Pixels
/// beyond the picture count as unmarked.
std::vector<std::uint8_t> thin(const std::vector<std::uint8_t>& marked, int width, int height);

}  // namespace dendrofit
