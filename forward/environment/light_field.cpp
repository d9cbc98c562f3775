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

constexpr int kBrickBits = 5;
constexpr int kBrick = 1 << kBrickBits;  // voxels a side
constexpr std::size_t kBrickCells = std::size_t{kBrick} * kBrick;

int half_width(int q) {
  return std::min(q, kPyramidLayers);
}

// column += the rows of bricks that lie side by side; a missing brick is 0.
DENDROFIT_VECTORISED
void add_rows(std::size_t count, Fixed* const* bricks, std::int32_t first_row, std::int32_t last_row,
              Fixed* __restrict column) {
  for (std::size_t b = 0; b < count; ++b, column += kBrick) {
    if (!bricks[b]) continue;
    for (std::int32_t y = first_row; y <= last_row; ++y) {
      const Fixed* __restrict row = bricks[b] + y * kBrick;
      for (std::int32_t x = 0; x < kBrick; ++x) column[x] += row[x];
    }
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

void LightField::Rect::add(const Rect& r) {
  x0 = std::min(x0, r.x0), y0 = std::min(y0, r.y0);
  x1 = std::max(x1, r.x1), y1 = std::max(y1, r.y1);
}

void LightField::check_memory() const {
  double bytes = static_cast<double>(arena_.taken_bytes());
  std::int64_t nx = 0, ny = 0;
  for (const Layer& layer : layers_) {
    bytes += static_cast<double>(layer.reach.width()) * static_cast<double>(layer.reach.height()) *
             (sizeof(Fixed*) / static_cast<double>(kBrickCells));
    nx = std::max(nx, layer.reach.width());
    ny = std::max(ny, layer.reach.height());
  }
  if (bytes <= max_gib_ * (1 << 30)) return;
  std::ostringstream message;
  message << "light field: " << layers_.size() << " layers of up to " << nx << " x " << ny
          << " voxels take more than " << max_gib_
          << " GiB; grow trees that stand far apart in separate runs, or use longer internodes";
  throw InputError(message.str());
}

Fixed* LightField::new_brick() {
  auto* const brick = static_cast<Fixed*>(arena_.take(kBrickCells * sizeof(Fixed)));
  if (arena_.taken_bytes() % (std::size_t{1} << 24) == 0) check_memory();
  return brick;
}

void LightField::make_room(Layer& layer) {
  const Rect wanted{layer.reach.x0 >> kBrickBits, layer.reach.y0 >> kBrickBits, layer.reach.x1 >> kBrickBits,
                    layer.reach.y1 >> kBrickBits};
  if (layer.table.holds(wanted)) return;
  std::vector<Fixed*> bricks(static_cast<std::size_t>(wanted.width() * wanted.height()), nullptr);
  for (std::int64_t y = 0; y < layer.table.height(); ++y) {
    const auto from = layer.bricks.begin() + y * layer.table.width();
    std::copy(
        from, from + layer.table.width(),
        bricks.begin() + ((layer.table.y0 + y - wanted.y0) * wanted.width() + layer.table.x0 - wanted.x0));
  }
  layer.bricks = std::move(bricks);
  layer.table = wanted;
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
    // One voxel more on the far side, for the corners that close a square.
    if (!need.empty())
      layers_[static_cast<std::size_t>(z)].reach.add({need.x0, need.y0, need.x1 + 1, need.y1 + 1});
  }
  check_memory();
  pending_.push_back(std::move(shadows));
}

// A layer to write on, in voxels from the corner of its table of bricks.
struct LightField::Canvas {
  LightField& field;
  Fixed** const bricks;
  const std::uint32_t width;  // bricks
  const std::int32_t x0, y0;

  Canvas(LightField& owner, Layer& layer)
      : field(owner),
        bricks(layer.bricks.data()),
        width(static_cast<std::uint32_t>(layer.table.width())),
        x0(layer.table.x0 * kBrick),
        y0(layer.table.y0 * kBrick) {}

  // The square from voxel (x, y) on, `side` voxels wide, as its four corners.
  void add_square(std::int32_t x, std::int32_t y, std::uint32_t side, Fixed amount) const {
    const auto left = static_cast<std::uint32_t>(x - x0), low = static_cast<std::uint32_t>(y - y0);
    const std::uint32_t right = left + side, high = low + side;
    add_pair(bricks + (low >> kBrickBits) * width, (low % kBrick) * kBrick, left, right, amount);
    add_pair(bricks + (high >> kBrickBits) * width, (high % kBrick) * kBrick, left, right, -amount);
  }

 private:
  void add_pair(Fixed** row, std::uint32_t line, std::uint32_t left, std::uint32_t right,
                Fixed amount) const {
    Fixed*& first = row[left >> kBrickBits];
    if (!first) first = field.new_brick();
    first[line + left % kBrick] += amount;
    Fixed*& second = row[right >> kBrickBits];
    if (!second) second = field.new_brick();
    second[line + right % kBrick] -= amount;
  }
};

// l = l_0 - b^-q (Yi 2018, 4.5) in one layer.
void LightField::draw(const Shadows& shadows, std::int32_t z, Layer& layer) {
  const Canvas canvas(*this, layer);
  for (int q = std::max(0, shadows.lowest - z); q <= shadows.reach() && z + q <= shadows.highest(); ++q) {
    const auto above = static_cast<std::size_t>(z + q - shadows.lowest);
    const int half = half_width(q);
    const auto side = static_cast<std::uint32_t>(2 * half + 1);
    const Fixed amount = shadows.sign * shadows.profile[q];
    const std::span nodes(shadows.nodes.data() + shadows.first[above],
                          shadows.nodes.data() + shadows.first[above + 1]);
    for (const Voxel& node : nodes) canvas.add_square(node.x - half, node.y - half, side, amount);
  }
}

void LightField::darken(const Voxel& voxel, Fixed amount) {
  if (voxel.z < 0) return;
  const auto z = static_cast<std::size_t>(voxel.z);
  if (layers_.size() <= z) layers_.resize(z + 1);
  Layer& layer = layers_[z];
  layer.reach.add({voxel.x, voxel.y, voxel.x + 1, voxel.y + 1});
  check_memory();
  make_room(layer);
  Canvas(*this, layer).add_square(voxel.x, voxel.y, 1, amount);
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
    if (layer.reach.empty()) continue;
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
  if (last_x < reach.x0) return;
  const std::int32_t x0 = layer.table.x0 << kBrickBits;  // of the column
  const auto across = static_cast<std::size_t>((last_x >> kBrickBits) - layer.table.x0) + 1;
  column_.assign(across * kBrick, 0);
  sum_.resize(across * kBrick);
  std::int32_t next = reach.y0;  // row not yet in the column
  for (std::int32_t y = std::max(rows.y0, reach.y0); y <= last_y; ++y) {
    const std::size_t r = rows.first + static_cast<std::size_t>(y - rows.y0);
    const std::span asked(queries.query.data() + queries.start[r],
                          queries.query.data() + queries.start[r + 1]);
    if (asked.empty()) continue;
    while (next <= y) {
      const std::int32_t brick = next >> kBrickBits;
      const std::int32_t last = std::min(y, (brick << kBrickBits) + kBrick - 1);
      add_rows(across, layer.bricks.data() + (brick - layer.table.y0) * layer.table.width(),
               next & (kBrick - 1), last & (kBrick - 1), column_.data());
      next = last + 1;
    }
    std::int32_t furthest = x0 - 1;
    for (const std::uint32_t i : asked)
      if (at[i].x <= last_x) furthest = std::max(furthest, at[i].x);
    std::partial_sum(column_.begin(), column_.begin() + (furthest + 1 - x0), sum_.begin());
    for (const std::uint32_t i : asked)
      if (at[i].x >= x0 && at[i].x <= last_x) shade[i] = sum_[static_cast<std::size_t>(at[i].x - x0)];
  }
}

}  // namespace dendrofit
