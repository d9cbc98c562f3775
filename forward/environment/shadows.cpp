// SPDX-License-Identifier: GPL-3.0-or-later
#include "forward/environment/shadows.h"

#include "core/errors.h"
#include "forward/environment/vectorised.h"

#include <cmath>

namespace dendrofit {
namespace {

// Nodes of one layer, row after row: those of row y0 + j are x[start[j]] to x[start[j + 1]].
struct NodeRows {
  const std::int32_t* x;
  const std::uint32_t* start;
  std::int32_t y0, count;
};

// shade[i] += amount for each node within `half` of voxel i, both ways.
DENDROFIT_VECTORISED
void add_sums(const NodeRows& rows, std::int32_t half, Fixed amount, std::size_t n, const Voxel* at,
              Fixed* shade) {
  for (std::size_t i = 0; i < n; ++i) {
    const std::int32_t first = std::clamp(at[i].y - half - rows.y0, 0, rows.count);
    const std::int32_t last = std::clamp(at[i].y + half + 1 - rows.y0, 0, rows.count);
    const std::int32_t lo = at[i].x - half, hi = at[i].x + half;
    std::int32_t within = 0;
    for (std::uint32_t j = rows.start[first]; j < rows.start[last]; ++j)
      within += static_cast<std::int32_t>(rows.x[j] >= lo) & static_cast<std::int32_t>(rows.x[j] <= hi);
    shade[i] += amount * within;
  }
}

}  // namespace

ShadeProfile::ShadeProfile(double b) {
  require(b > 1, "b", b, "must be greater than 1");
  for (int q = 0;; ++q) {
    const auto weight = static_cast<Fixed>(std::llround(std::pow(b, -q) * static_cast<double>(kFullLight)));
    weight_.push_back(weight);
    if (weight == 0) break;
  }
}

void VoxelRect::add(const VoxelRect& r) {
  x0 = std::min(x0, r.x0), y0 = std::min(y0, r.y0);
  x1 = std::max(x1, r.x1), y1 = std::max(y1, r.y1);
}

VoxelRows::VoxelRows(std::span<const Voxel> at, std::int32_t lowest, std::size_t count)
    : lowest_(lowest), layers_(count) {
  const auto inside = [&](const Voxel& v) { return v.z >= lowest_ && v.z <= highest(); };
  for (const Voxel& v : at)
    if (inside(v)) layers_[static_cast<std::size_t>(v.z - lowest_)].span.add({v.x, v.y, v.x, v.y});
  std::size_t row_count = 0;
  for (Layer& layer : layers_) {
    layer.first = row_count;
    row_count += static_cast<std::size_t>(layer.span.height());
  }
  start_.assign(row_count + 1, 0);
  const auto row_of = [&](const Voxel& v) {
    return layer(v.z).first + static_cast<std::size_t>(v.y - layer(v.z).span.y0);
  };
  for (const Voxel& v : at)
    if (inside(v)) ++start_[row_of(v) + 1];
  for (std::size_t row = 0; row < row_count; ++row) start_[row + 1] += start_[row];
  order_.resize(start_.back());
  std::vector<std::uint32_t> next(start_.begin(), start_.end() - 1);
  for (std::size_t i = 0; i < at.size(); ++i)
    if (inside(at[i])) order_[next[row_of(at[i])]++] = static_cast<std::uint32_t>(i);
}

VoxelRows::Range VoxelRows::layers(std::int32_t z0, std::int32_t z1) const {
  const auto place = [&](std::int32_t z) { return z <= highest() ? start_[layer(z).first] : start_.back(); };
  return z0 > z1 ? Range{0, 0} : Range{place(z0), place(z1 + 1)};
}

Shadows::Shadows(std::span<const Voxel> nodes, std::int32_t lowest, std::int32_t highest,
                 const ShadeProfile& profile, int sign)
    : profile_(profile), sign_(sign), rows_(nodes, lowest, static_cast<std::size_t>(highest - lowest) + 1) {
  for (const std::uint32_t i : rows_.order()) {
    x_.push_back(nodes[i].x);
    y_.push_back(nodes[i].y);
  }
}

std::pair<int, int> Shadows::steps(std::int32_t z) const {
  return {std::max(0, rows_.lowest() - z), std::min(profile_.layers() - 1, rows_.highest() - z)};
}

std::size_t Shadows::count_above(std::int32_t z) const {
  const auto [first, last] = steps(z);
  const auto [from, to] = rows_.layers(z + first, z + last);
  return to - from;
}

VoxelRect Shadows::reach(std::int32_t z) const {
  VoxelRect reach;
  const auto [first, last] = steps(z);
  for (int q = first; q <= last; ++q) {
    const VoxelRect& span = rows_.layer(z + q).span;
    const int half = shadow_half_width(q);
    if (!span.empty()) reach.add({span.x0 - half, span.y0 - half, span.x1 + half, span.y1 + half});
  }
  return reach;
}

void Shadows::add_at(std::int32_t z, std::span<const Voxel> at, std::span<Fixed> shade) const {
  const auto [first, last] = steps(z);
  for (int q = first; q <= last; ++q) {
    const VoxelRows::Layer& layer = rows_.layer(z + q);
    add_sums({x_.data(), rows_.starts().data() + layer.first, layer.span.y0,
              static_cast<std::int32_t>(layer.span.height())},
             shadow_half_width(q), amount(q), at.size(), at.data(), shade.data());
  }
}

}  // namespace dendrofit
