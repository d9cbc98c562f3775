// SPDX-License-Identifier: GPL-3.0-or-later
// Boughs below the horizon that a stretch of faint contrast parts from the tree.
#pragma once

#include <cstdint>
#include <vector>

namespace dendrofit {

/// Adds to `tree` the drawn-out pieces of `strong` that a way of at most `gap_px` over `faint` pixels leads
/// to it, with the way and the faint pixels beside it. Pieces as thick as a quarter of their length, or that
/// have fewer than 30 pixels, are blots, not boughs. Non-zero bytes mark; rows from the top. Returns how many
/// pixels were added.
std::size_t bridge_gaps(const std::vector<std::uint8_t>& strong, const std::vector<std::uint8_t>& faint,
                        int width, int height, int gap_px, std::vector<std::uint8_t>& tree);

}  // namespace dendrofit
