// SPDX-License-Identifier: GPL-3.0-or-later
#include "forward/leaves/leaf_index.h"

#include "core/errors.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace dendrofit {
namespace {

constexpr std::int64_t kOffset = 1 << 20;  // block coordinates: 21 bits each
constexpr std::uint64_t kMask = (1 << 21) - 1;

std::int64_t floor_div(std::int64_t a, std::int64_t b) {
  return a >= 0 ? a / b : -((-a + b - 1) / b);
}

std::uint64_t pack(std::int64_t x, std::int64_t y, std::int64_t z) {
  return (static_cast<std::uint64_t>(x + kOffset) << 42) | (static_cast<std::uint64_t>(y + kOffset) << 21) |
         static_cast<std::uint64_t>(z + kOffset);
}

std::array<std::int64_t, 3> unpack(std::uint64_t block) {
  return {static_cast<std::int64_t>((block >> 42) & kMask) - kOffset,
          static_cast<std::int64_t>((block >> 21) & kMask) - kOffset,
          static_cast<std::int64_t>(block & kMask) - kOffset};
}

}  // namespace

LeafIndex::LeafIndex(double reach_m, double half_extent_m, const Vec3& origin)
    : origin_(origin),
      half_extent_(half_extent_m),
      cell_(std::max(1e-3, 1.2 * half_extent_m)),
      // What two leaves in blocks of one colour may read or write lies within reach + half extent + a cell of
      // each.
      cells_(static_cast<std::int64_t>(std::ceil((2 * reach_m + 2 * half_extent_m) / cell_)) + 2) {}

std::array<std::int64_t, 3> LeafIndex::cell_at(const Vec3& p) const {
  const Vec3 at = (p - origin_) / cell_;
  return {static_cast<std::int64_t>(std::floor(at.x())), static_cast<std::int64_t>(std::floor(at.y())),
          static_cast<std::int64_t>(std::floor(at.z()))};
}

std::uint64_t LeafIndex::block_of(const Vec3& foot) const {
  const std::array<std::int64_t, 3> b = block_at(cell_at(foot));
  return pack(b[0], b[1], b[2]);
}

int LeafIndex::colour_of(std::uint64_t block) const {
  const auto [x, y, z] = unpack(block);
  return static_cast<int>((x & 1) | ((y & 1) << 1) | ((z & 1) << 2));
}

void LeafIndex::prepare(const std::vector<Vec3>& feet) {
  const auto in_block = static_cast<std::size_t>(cells_ * cells_ * cells_);
  const double limit = static_cast<double>(kOffset - 2) * cell_ * static_cast<double>(cells_);
  std::uint64_t last = std::numeric_limits<std::uint64_t>::max();
  for (const Vec3& foot : feet) {
    if (!((foot - origin_).cwiseAbs().maxCoeff() < limit))
      throw InputError("leaves: the tree is too large for leaves of this size");
    const std::uint64_t block = block_of(foot);
    if (block == last) continue;
    last = block;
    const auto [x, y, z] = unpack(block);
    for (std::int64_t i = -1; i <= 1; ++i)
      for (std::int64_t j = -1; j <= 1; ++j)
        for (std::int64_t k = -1; k <= 1; ++k)
          if (first_head_.emplace(pack(x + i, y + j, z + k), heads_.size()).second)
            heads_.resize(heads_.size() + in_block, kNone);
  }
}

void LeafIndex::resize(std::size_t slots) {
  boxes_.resize(slots);
}

LeafIndex::Box LeafIndex::outward(const Vec3& lo, const Vec3& hi) {
  Box box;
  constexpr float kInf = std::numeric_limits<float>::infinity();
  for (int k = 0; k < 3; ++k) {
    const auto i = static_cast<std::size_t>(k);
    box.lo[i] = std::nextafter(static_cast<float>(lo[k]), -kInf);
    box.hi[i] = std::nextafter(static_cast<float>(hi[k]), kInf);
  }
  return box;
}

std::array<std::int64_t, 3> LeafIndex::block_at(const std::array<std::int64_t, 3>& c) const {
  return {floor_div(c[0], cells_), floor_div(c[1], cells_), floor_div(c[2], cells_)};
}

const std::uint32_t* LeafIndex::heads_of(const std::array<std::int64_t, 3>& b) const {
  const auto found = first_head_.find(pack(b[0], b[1], b[2]));
  return found == first_head_.end() ? nullptr : heads_.data() + found->second;
}

void LeafIndex::insert(std::uint32_t slot, const Vec3& lo, const Vec3& hi) {
  const std::array<std::int64_t, 3> c = cell_at(0.5 * (lo + hi)), b = block_at(c);
  const auto found = first_head_.find(pack(b[0], b[1], b[2]));
  if (found == first_head_.end())
    throw std::logic_error("leaves: a leaf reaches further from its foot than its shape allows");
  const std::int64_t within =
      ((c[0] - b[0] * cells_) * cells_ + (c[1] - b[1] * cells_)) * cells_ + (c[2] - b[2] * cells_);
  std::uint32_t& head = heads_[found->second + static_cast<std::size_t>(within)];
  boxes_[slot] = outward(lo - origin_, hi - origin_);
  boxes_[slot].next = head;
  head = slot;
}

}  // namespace dendrofit
