// SPDX-License-Identifier: GPL-3.0-or-later
#include "recon/image/thinning.h"

#include <array>
#include <cstddef>

namespace dendrofit {
namespace {

/// A picture with a border of unmarked pixels, so that every neighbour exists.
struct Padded {
  std::ptrdiff_t stride;
  std::vector<std::uint8_t> on;
  std::array<std::ptrdiff_t, 8> around;  ///< p2 to p9 of the paper: north, then clockwise

  Padded(const std::vector<std::uint8_t>& marked, int width, int height)
      : stride(width + 2),
        on(static_cast<std::size_t>(stride) * static_cast<std::size_t>(height + 2), 0),
        around{-stride, -stride + 1, 1, stride + 1, stride, stride - 1, -1, -stride - 1} {
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x)
        on[at(x, y)] = marked[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                              static_cast<std::size_t>(x)]
                           ? 1
                           : 0;
  }
  std::size_t at(int x, int y) const {
    return static_cast<std::size_t>(y + 1) * static_cast<std::size_t>(stride) +
           static_cast<std::size_t>(x + 1);
  }
  std::size_t neighbour(std::size_t p, std::size_t k) const {
    return static_cast<std::size_t>(static_cast<std::ptrdiff_t>(p) + around[k]);
  }
  /// Bit k: neighbour k is marked.
  unsigned ring(std::size_t p) const {
    unsigned bits = 0;
    for (std::size_t k = 0; k < 8; ++k) bits |= static_cast<unsigned>(on[neighbour(p, k)]) << k;
    return bits;
  }
};

int count(unsigned ring) {
  return __builtin_popcount(ring);
}

/// Steps from unmarked to marked around the ring.
int crossings(unsigned ring) {
  return count(~ring & ((ring >> 1) | (ring << 7)) & 0xFF);
}

/// Zhang & Suen's conditions (a) to (d), and (c') (d') in the second subiteration.
bool removable(unsigned ring, int subiteration) {
  const int n = count(ring);
  if (n < 2 || n > 6 || crossings(ring) != 1) return false;
  constexpr unsigned north = 1, east = 4, south = 16, west = 64;
  const auto all = [&](unsigned bits) { return (ring & bits) == bits; };
  if (subiteration == 0) return !all(north | east | south) && !all(east | south | west);
  return !all(north | east | west) && !all(north | south | west);
}

/// True where the marked neighbours hold together without the pixel (8-connected, corners through edges).
bool joined_without(unsigned ring) {
  // A corner neighbour is reached through an edge neighbour beside it: fill corners between edge pixels.
  unsigned filled = ring;
  int pieces = 0;
  unsigned seen = 0;
  for (unsigned k = 0; k < 8; ++k) {
    if (!(filled >> k & 1) || (seen >> k & 1)) continue;
    ++pieces;
    unsigned stack = 1U << k;
    while (stack) {
      const auto p = static_cast<unsigned>(__builtin_ctz(stack));
      stack &= stack - 1;
      seen |= 1U << p;
      unsigned reach = 1U << ((p + 1) % 8) | 1U << ((p + 7) % 8);
      if (p % 2 == 0) reach |= 1U << ((p + 2) % 8) | 1U << ((p + 6) % 8);  // edge to edge, diagonally
      stack |= reach & filled & ~seen;
    }
  }
  return pieces == 1;
}

}  // namespace

std::vector<std::uint8_t> thin(const std::vector<std::uint8_t>& marked, int width, int height) {
  Padded image(marked, width, height);
  // A pixel is looked at again in a subiteration only when its ring has changed since it last was.
  std::array<std::vector<std::size_t>, 2> due;
  std::array<std::vector<std::uint8_t>, 2> listed = {std::vector<std::uint8_t>(image.on.size(), 0),
                                                     std::vector<std::uint8_t>(image.on.size(), 0)};
  const auto list = [&](std::size_t p) {
    for (std::size_t s = 0; s < 2; ++s)
      if (image.on[p] && !listed[s][p]) {
        listed[s][p] = 1;
        due[s].push_back(p);
      }
  };
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      if (const std::size_t p = image.at(x, y); image.on[p] && image.ring(p) != 0xFF) list(p);

  std::vector<std::size_t> gone;
  while (!due[0].empty() || !due[1].empty())
    for (std::size_t s = 0; s < 2; ++s) {
      gone.clear();
      for (const std::size_t p : due[s]) {
        listed[s][p] = 0;
        if (image.on[p] && removable(image.ring(p), static_cast<int>(s))) gone.push_back(p);
      }
      due[s].clear();
      for (const std::size_t p : gone) image.on[p] = 0;
      for (const std::size_t p : gone)
        for (std::size_t k = 0; k < 8; ++k) list(image.neighbour(p, k));
    }

  std::vector<std::uint8_t> lines(marked.size(), 0);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const std::size_t p = image.at(x, y);
      if (!image.on[p]) continue;
      const unsigned ring = image.ring(p);
      constexpr unsigned edges = 1 | 4 | 16 | 64;
      if (count(ring) >= 2 && (ring & edges) != edges && joined_without(ring)) image.on[p] = 0;
      lines[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x)] =
          image.on[p];
    }
  return lines;
}

}  // namespace dendrofit
