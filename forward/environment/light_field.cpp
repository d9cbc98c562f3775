// SPDX-License-Identifier: GPL-3.0-or-later
#include "forward/environment/light_field.h"

#include "core/errors.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <sstream>

namespace dendrofit {
namespace {

constexpr std::int32_t kFar = std::numeric_limits<std::int32_t>::max() / 4;

int half_width(int q) {
  return std::min(q, kPyramidLayers);
}

void add_rows(std::size_t n, const Fixed* __restrict row, Fixed* __restrict sum) {
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

double LightField::memory_gib() const {
  double cells = 0;
  for (const Layer& layer : layers_) cells += static_cast<double>(layer.difference.capacity());
  return cells * sizeof(Fixed) / (1 << 30);
}

void LightField::cover(std::size_t index, const Rect& rect) {
  Layer& layer = layers_[index];
  // One cell more on the far side, for the corners that close a square.
  Rect wanted{rect.x0, rect.y0, rect.x1 + 1, rect.y1 + 1};
  if (layer.nx > 0) {
    const std::int32_t x1 = layer.x0 + layer.nx - 1, y1 = layer.y0 + layer.ny - 1;
    layer.used_x0 = std::min(layer.used_x0, rect.x0);
    layer.used_y0 = std::min(layer.used_y0, rect.y0);
    if (wanted.x0 >= layer.x0 && wanted.y0 >= layer.y0 && wanted.x1 <= x1 && wanted.y1 <= y1) return;
    // Crowns widen in every cycle: room for the next ones on the sides that grow.
    const std::int32_t room = std::max(8, (layer.nx + layer.ny) / 6);
    wanted = {wanted.x0 < layer.x0 ? wanted.x0 - room : layer.x0,
              wanted.y0 < layer.y0 ? wanted.y0 - room : layer.y0, wanted.x1 > x1 ? wanted.x1 + room : x1,
              wanted.y1 > y1 ? wanted.y1 + room : y1};
  }
  const std::int64_t nx = std::int64_t{wanted.x1} - wanted.x0 + 1,
                     ny = std::int64_t{wanted.y1} - wanted.y0 + 1;
  const double gib =
      memory_gib() + static_cast<double>(nx) * static_cast<double>(ny) * sizeof(Fixed) / (1 << 30);
  if (gib > max_gib_) {
    std::ostringstream message;
    message << "light field: " << nx << " x " << ny << " voxels in a layer take more than " << max_gib_
            << " GiB; grow trees that stand far apart in separate runs, or use longer internodes";
    throw InputError(message.str());
  }
  std::vector<Fixed> grown(static_cast<std::size_t>(nx * ny), 0);
  for (std::int32_t y = 0; y < layer.ny; ++y) {
    const auto from = layer.difference.begin() + static_cast<std::ptrdiff_t>(y) * layer.nx;
    std::copy(from, from + layer.nx,
              grown.begin() +
                  static_cast<std::ptrdiff_t>((y + layer.y0 - wanted.y0) * nx + (layer.x0 - wanted.x0)));
  }
  if (layer.nx == 0) layer.used_x0 = rect.x0, layer.used_y0 = rect.y0;
  layer.x0 = wanted.x0, layer.y0 = wanted.y0;
  layer.nx = static_cast<std::int32_t>(nx), layer.ny = static_cast<std::int32_t>(ny);
  layer.difference = std::move(grown);
}

void LightField::cast(std::span<const Voxel> nodes, const ShadeProfile& profile, int sign) {
  std::int32_t lowest = kFar, highest = -1;
  for (const Voxel& v : nodes) {
    lowest = std::min(lowest, v.z);
    highest = std::max(highest, v.z);
  }
  if (highest < 0) return;
  lowest = std::max(lowest, 0);
  if (layers_.size() <= static_cast<std::size_t>(highest))
    layers_.resize(static_cast<std::size_t>(highest) + 1);

  // Where the nodes of each layer lie, and from that what each layer below must cover.
  std::vector<Rect> nodes_at(static_cast<std::size_t>(highest - lowest) + 1, Rect{kFar, kFar, -kFar, -kFar});
  for (const Voxel& v : nodes) {
    if (v.z < 0) continue;
    Rect& rect = nodes_at[static_cast<std::size_t>(v.z - lowest)];
    rect = {std::min(rect.x0, v.x), std::min(rect.y0, v.y), std::max(rect.x1, v.x), std::max(rect.y1, v.y)};
  }
  for (std::int32_t z = std::max(0, lowest - profile.layers() + 1); z <= highest; ++z) {
    Rect need{kFar, kFar, -kFar, -kFar};
    for (int q = std::max(0, lowest - z); q < profile.layers() && z + q <= highest; ++q) {
      const Rect& rect = nodes_at[static_cast<std::size_t>(z + q - lowest)];
      if (rect.x0 > rect.x1) continue;
      const int half = half_width(q);
      need = {std::min(need.x0, rect.x0 - half), std::min(need.y0, rect.y0 - half),
              std::max(need.x1, rect.x1 + half), std::max(need.y1, rect.y1 + half)};
    }
    if (need.x0 <= need.x1) cover(static_cast<std::size_t>(z), need);
  }

  // l = l_0 - b^-q (Yi 2018, 4.5), as the four corners of each layer's square; layer by layer, so that one
  // layer at a time is written to.
  std::vector<std::uint32_t> first(nodes_at.size() + 1, 0);
  for (const Voxel& v : nodes)
    if (v.z >= 0) ++first[static_cast<std::size_t>(v.z - lowest) + 1];
  for (std::size_t z = 1; z < first.size(); ++z) first[z] += first[z - 1];
  std::vector<Voxel> sorted(first.back());
  std::vector<std::uint32_t> next(first.begin(), first.end() - 1);
  for (const Voxel& v : nodes)
    if (v.z >= 0) sorted[next[static_cast<std::size_t>(v.z - lowest)]++] = v;
  for (std::int32_t z = std::max(0, lowest - profile.layers() + 1); z <= highest; ++z) {
    Layer& layer = layers_[static_cast<std::size_t>(z)];
    Fixed* const data = layer.difference.data();
    const std::int64_t stride = layer.nx;
    for (int q = std::max(0, lowest - z); q < profile.layers() && z + q <= highest; ++q) {
      const auto above = static_cast<std::size_t>(z + q - lowest);
      const int half = half_width(q), width = 2 * half + 1;
      const Fixed amount = sign * profile[q];
      for (std::uint32_t i = first[above]; i < first[above + 1]; ++i) {
        Fixed* low = data + ((sorted[i].y - half - layer.y0) * stride + (sorted[i].x - half - layer.x0));
        Fixed* high = low + width * stride;
        low[0] += amount;
        low[width] -= amount;
        high[0] -= amount;
        high[width] += amount;
      }
    }
  }
}

void LightField::darken(const Voxel& voxel, Fixed amount) {
  if (voxel.z < 0) return;
  const auto z = static_cast<std::size_t>(voxel.z);
  if (layers_.size() <= z) layers_.resize(z + 1);
  cover(z, {voxel.x, voxel.y, voxel.x, voxel.y});
  Layer& layer = layers_[z];
  Fixed* low = layer.difference.data() + std::int64_t{voxel.y - layer.y0} * layer.nx + (voxel.x - layer.x0);
  low[0] += amount;
  low[1] -= amount;
  low[layer.nx] -= amount;
  low[layer.nx + 1] += amount;
}

void LightField::read(std::span<const Voxel> at, std::span<Fixed> shade) const {
  // Queries by layer and row, by counting; then one integration of each layer that is asked for.
  std::vector<std::size_t> first_row(layers_.size() + 1, 0);
  for (std::size_t z = 0; z < layers_.size(); ++z)
    first_row[z + 1] = first_row[z] + static_cast<std::size_t>(layers_[z].ny);
  const auto row_of = [&](const Voxel& v) -> std::ptrdiff_t {
    if (v.z < 0 || static_cast<std::size_t>(v.z) >= layers_.size()) return -1;
    const Layer& layer = layers_[static_cast<std::size_t>(v.z)];
    if (v.x < layer.x0 || v.y < layer.y0 || v.x >= layer.x0 + layer.nx || v.y >= layer.y0 + layer.ny)
      return -1;
    return static_cast<std::ptrdiff_t>(first_row[static_cast<std::size_t>(v.z)]) + (v.y - layer.y0);
  };
  std::vector<std::uint32_t> start(first_row.back() + 1, 0);
  std::vector<std::int32_t> columns(layers_.size(), 0);  // up to the last one asked for
  for (std::size_t i = 0; i < at.size(); ++i) {
    const std::ptrdiff_t row = row_of(at[i]);
    if (row < 0) {
      shade[i] = 0;
      continue;
    }
    ++start[static_cast<std::size_t>(row) + 1];
    const auto z = static_cast<std::size_t>(at[i].z);
    columns[z] = std::max(columns[z], at[i].x - layers_[z].x0 + 1);
  }
  for (std::size_t row = 1; row < start.size(); ++row) start[row] += start[row - 1];
  std::vector<std::uint32_t> query(start.back());
  std::vector<std::uint32_t> next(start.begin(), start.end() - 1);
  for (std::size_t i = 0; i < at.size(); ++i) {
    const std::ptrdiff_t row = row_of(at[i]);
    if (row >= 0) query[next[static_cast<std::size_t>(row)]++] = static_cast<std::uint32_t>(i);
  }

  std::vector<Fixed> column;  // sums of the rows so far
  std::vector<Fixed> sum;     // and along x
  for (std::size_t z = 0; z < layers_.size(); ++z) {
    const Layer& layer = layers_[z];
    std::uint32_t waiting = start[first_row[z + 1]] - start[first_row[z]];
    if (waiting == 0) continue;
    // Nothing lies before the used corner, and nothing after the last voxel asked for matters.
    const std::int32_t skip = layer.used_x0 - layer.x0;
    const auto nx = static_cast<std::size_t>(std::max(0, columns[z] - skip));
    column.assign(nx, 0);
    sum.resize(nx);
    for (std::int32_t y = 0; waiting > 0; ++y) {
      if (y >= layer.used_y0 - layer.y0)
        add_rows(nx, layer.difference.data() + (std::int64_t{y} * layer.nx + skip), column.data());
      const std::size_t r = first_row[z] + static_cast<std::size_t>(y);
      if (start[r] == start[r + 1]) continue;
      std::partial_sum(column.begin(), column.end(), sum.begin());
      for (std::uint32_t j = start[r]; j < start[r + 1]; ++j)
        shade[query[j]] = at[query[j]].x < layer.used_x0
                              ? 0
                              : sum[static_cast<std::size_t>(at[query[j]].x - layer.used_x0)];
      waiting -= start[r + 1] - start[r];
    }
  }
}

}  // namespace dendrofit
