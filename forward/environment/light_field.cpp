// SPDX-License-Identifier: GPL-3.0-or-later
#include "forward/environment/light_field.h"

#include "core/errors.h"
#include "forward/environment/vectorised.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <sstream>

namespace dendrofit {
namespace {

// Layers that must grow get this many voxels more on each side, or this part of their size.
constexpr std::int64_t kLeastRoom = 8, kRoomShare = 6;

int half_width(int q) {
  return std::min(q, kPyramidLayers);
}

// sum += rows of n, one below the other.
DENDROFIT_VECTORISED
void add_rows(std::size_t n, std::size_t rows, std::size_t stride, const Fixed* __restrict row,
              Fixed* __restrict sum) {
  for (; rows >= 4; rows -= 4, row += 4 * stride) {
    const Fixed* const second = row + stride;
    const Fixed* const third = second + stride;
    const Fixed* const fourth = third + stride;
    for (std::size_t x = 0; x < n; ++x) sum[x] += (row[x] + second[x]) + (third[x] + fourth[x]);
  }
  for (; rows > 0; --rows, row += stride)
    for (std::size_t x = 0; x < n; ++x) sum[x] += row[x];
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

void LightField::Rect::add(const Rect& r) {
  x0 = std::min(x0, r.x0), y0 = std::min(y0, r.y0);
  x1 = std::max(x1, r.x1), y1 = std::max(y1, r.y1);
}

void LightField::check_memory() const {
  double cells = 0;
  const Layer* widest = nullptr;
  for (const Layer& layer : layers_) {
    cells += static_cast<double>(layer.extent.cells());
    if (!widest || layer.extent.cells() > widest->extent.cells()) widest = &layer;
  }
  if (cells * sizeof(Fixed) / (1 << 30) <= max_gib_) return;
  std::ostringstream message;
  message << "light field: " << widest->extent.width() << " x " << widest->extent.height()
          << " voxels in a layer, " << layers_.size() << " layers, take more than " << max_gib_
          << " GiB; grow trees that stand far apart in separate runs, or use longer internodes";
  throw InputError(message.str());
}

void LightField::cover(std::size_t index, const Rect& rect) {
  Layer& layer = layers_[index];
  // One cell more on the far side, for the corners that close a square.
  layer.reach.add({rect.x0, rect.y0, rect.x1 + 1, rect.y1 + 1});
  if (layer.extent.holds(layer.reach)) return;
  // Crowns widen in every cycle: room for the next ones.
  const std::int32_t room =
      layer.extent.empty() ? 0
                           : static_cast<std::int32_t>(std::max<std::int64_t>(
                                 kLeastRoom, (layer.extent.width() + layer.extent.height()) / kRoomShare));
  const Rect before = layer.extent;
  layer.extent.add(layer.reach);
  if (before.empty()) return;
  if (layer.extent.x0 < before.x0) layer.extent.x0 -= room;
  if (layer.extent.y0 < before.y0) layer.extent.y0 -= room;
  if (layer.extent.x1 > before.x1) layer.extent.x1 += room;
  if (layer.extent.y1 > before.y1) layer.extent.y1 += room;
}

void LightField::make_room(Layer& layer) {
  if (layer.held == layer.extent) return;
  std::vector<Fixed> grown(static_cast<std::size_t>(layer.extent.cells()), 0);
  if (!layer.held.empty())
    for (std::int32_t y = layer.held.y0; y <= layer.held.y1; ++y) {
      const auto from = layer.difference.begin() + (y - layer.held.y0) * layer.held.width();
      std::copy(
          from, from + layer.held.width(),
          grown.begin() + ((y - layer.extent.y0) * layer.extent.width() + (layer.held.x0 - layer.extent.x0)));
    }
  layer.difference = std::move(grown);
  layer.held = layer.extent;
}

void LightField::cast(std::span<const Voxel> nodes, const ShadeProfile& profile, int sign) {
  std::int32_t lowest = Rect::kNone, highest = -1;
  for (const Voxel& v : nodes) {
    if (v.z < 0) continue;
    lowest = std::min(lowest, v.z);
    highest = std::max(highest, v.z);
  }
  if (highest < 0) return;
  if (layers_.size() <= static_cast<std::size_t>(highest))
    layers_.resize(static_cast<std::size_t>(highest) + 1);

  // Nodes by layer, and where those of each layer lie; from that what each layer below must cover.
  Shadows shadows{profile, sign, lowest, {}, {}};
  const auto count = static_cast<std::size_t>(highest - lowest) + 1;
  shadows.first.assign(count + 1, 0);
  std::vector<Rect> nodes_at(count);
  for (const Voxel& v : nodes) {
    if (v.z < 0) continue;
    const auto z = static_cast<std::size_t>(v.z - lowest);
    ++shadows.first[z + 1];
    nodes_at[z].add({v.x, v.y, v.x, v.y});
  }
  for (std::size_t z = 0; z < count; ++z) shadows.first[z + 1] += shadows.first[z];
  shadows.nodes.resize(shadows.first.back());
  std::vector<std::uint32_t> next(shadows.first.begin(), shadows.first.end() - 1);
  for (const Voxel& v : nodes)
    if (v.z >= 0) shadows.nodes[next[static_cast<std::size_t>(v.z - lowest)]++] = v;

  for (std::int32_t z = std::max(0, lowest - shadows.reach()); z <= highest; ++z) {
    Rect need;
    for (int q = std::max(0, lowest - z); q <= shadows.reach() && z + q <= highest; ++q) {
      const Rect& rect = nodes_at[static_cast<std::size_t>(z + q - lowest)];
      const int half = half_width(q);
      if (!rect.empty()) need.add({rect.x0 - half, rect.y0 - half, rect.x1 + half, rect.y1 + half});
    }
    if (!need.empty()) cover(static_cast<std::size_t>(z), need);
  }
  check_memory();
  pending_.push_back(std::move(shadows));
}

// l = l_0 - b^-q (Yi 2018, 4.5), as the four corners of each node's square in one layer.
void LightField::draw(const Shadows& shadows, std::int32_t z, Layer& layer) {
  const std::int64_t stride = layer.held.width();
  const std::int32_t x0 = layer.held.x0, y0 = layer.held.y0;
  Fixed* const data = layer.difference.data();
  for (int q = std::max(0, shadows.lowest - z); q <= shadows.reach() && z + q <= shadows.highest(); ++q) {
    const auto above = static_cast<std::size_t>(z + q - shadows.lowest);
    const int half = half_width(q), width = 2 * half + 1;
    const std::int64_t down = width * stride;
    const Fixed amount = shadows.sign * shadows.profile[q];
    for (std::uint32_t i = shadows.first[above]; i < shadows.first[above + 1]; ++i) {
      const Voxel& node = shadows.nodes[i];
      Fixed* low = data + ((node.y - half - y0) * stride + (node.x - half - x0));
      Fixed* high = low + down;
      low[0] += amount;
      low[width] -= amount;
      high[0] -= amount;
      high[width] += amount;
    }
  }
}

void LightField::darken(const Voxel& voxel, Fixed amount) {
  if (voxel.z < 0) return;
  const auto z = static_cast<std::size_t>(voxel.z);
  if (layers_.size() <= z) layers_.resize(z + 1);
  cover(z, {voxel.x, voxel.y, voxel.x, voxel.y});
  check_memory();
  Layer& layer = layers_[z];
  make_room(layer);
  const std::int64_t stride = layer.held.width();
  Fixed* low = layer.difference.data() + (voxel.y - layer.held.y0) * stride + (voxel.x - layer.held.x0);
  low[0] += amount;
  low[1] -= amount;
  low[stride] -= amount;
  low[stride + 1] += amount;
}

// Which voxels are asked for, by layer and row.
struct LightField::Queries {
  struct Rows {
    std::int32_t y0 = Rect::kNone, y1 = -Rect::kNone, x1 = -Rect::kNone;
    std::size_t first = 0;  // row y0's place in `start`
  };
  std::vector<Rows> layers;
  std::vector<std::uint32_t> start, query;

  Queries(std::span<const Voxel> at, std::size_t layer_count) : layers(layer_count) {
    const auto outside = [&](const Voxel& v) {
      return v.z < 0 || static_cast<std::size_t>(v.z) >= layer_count;
    };
    for (const Voxel& v : at) {
      if (outside(v)) continue;
      Rows& rows = layers[static_cast<std::size_t>(v.z)];
      rows.y0 = std::min(rows.y0, v.y), rows.y1 = std::max(rows.y1, v.y), rows.x1 = std::max(rows.x1, v.x);
    }
    std::size_t count = 0;
    for (Rows& rows : layers) {
      rows.first = count;
      if (rows.y0 <= rows.y1) count += static_cast<std::size_t>(rows.y1 - rows.y0) + 1;
    }
    start.assign(count + 1, 0);
    const auto row_of = [&](const Voxel& v) {
      const Rows& rows = layers[static_cast<std::size_t>(v.z)];
      return rows.first + static_cast<std::size_t>(v.y - rows.y0);
    };
    for (const Voxel& v : at)
      if (!outside(v)) ++start[row_of(v) + 1];
    for (std::size_t row = 0; row < count; ++row) start[row + 1] += start[row];
    query.resize(start.back());
    std::vector<std::uint32_t> next(start.begin(), start.end() - 1);
    for (std::size_t i = 0; i < at.size(); ++i)
      if (!outside(at[i])) query[next[row_of(at[i])]++] = static_cast<std::uint32_t>(i);
  }
};

void LightField::read(std::span<const Voxel> at, std::span<Fixed> shade) {
  std::fill(shade.begin(), shade.end(), 0);
  const Queries queries(at, layers_.size());
  for (std::size_t z = 0; z < layers_.size(); ++z) {
    Layer& layer = layers_[z];
    make_room(layer);
    for (const Shadows& shadows : pending_) draw(shadows, static_cast<std::int32_t>(z), layer);
    if (queries.layers[z].y0 <= queries.layers[z].y1) read_layer(layer, z, queries, at, shade);
  }
  pending_.clear();
}

// Integrates as much of a layer as is asked for: nothing lies before what was cast.
void LightField::read_layer(const Layer& layer, std::size_t z, const Queries& queries,
                            std::span<const Voxel> at, std::span<Fixed> shade) {
  const Queries::Rows& rows = queries.layers[z];
  const Rect& reach = layer.reach;
  const std::int32_t last_x = std::min(rows.x1, reach.x1), last_y = std::min(rows.y1, reach.y1);
  if (reach.empty() || last_x < reach.x0) return;
  const auto nx = static_cast<std::size_t>(last_x - reach.x0) + 1;
  const auto stride = static_cast<std::size_t>(layer.held.width());
  column_.assign(nx, 0);
  sum_.resize(nx);
  const Fixed* row = layer.difference.data() + static_cast<std::size_t>(reach.y0 - layer.held.y0) * stride +
                     static_cast<std::size_t>(reach.x0 - layer.held.x0);
  std::int32_t done = reach.y0;  // rows before this one are in the column
  for (std::int32_t y = std::max(rows.y0, reach.y0); y <= last_y; ++y) {
    const std::size_t r = rows.first + static_cast<std::size_t>(y - rows.y0);
    if (queries.start[r] == queries.start[r + 1]) continue;
    const auto count = static_cast<std::size_t>(y + 1 - done);
    add_rows(nx, count, stride, row, column_.data());
    row += count * stride;
    done = y + 1;
    std::partial_sum(column_.begin(), column_.end(), sum_.begin());
    for (std::uint32_t j = queries.start[r]; j < queries.start[r + 1]; ++j) {
      const std::int32_t x = at[queries.query[j]].x;
      if (x >= reach.x0 && x <= last_x)
        shade[queries.query[j]] = sum_[static_cast<std::size_t>(x - reach.x0)];
    }
  }
}

}  // namespace dendrofit
