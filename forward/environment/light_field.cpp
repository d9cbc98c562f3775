// SPDX-License-Identifier: GPL-3.0-or-later
#include "forward/environment/light_field.h"

#include "core/errors.h"
#include "forward/environment/vectorised.h"

#include <algorithm>
#include <numeric>
#include <sstream>

namespace dendrofit {
namespace {

constexpr int kBrickBits = 5;
constexpr int kBrick = 1 << kBrickBits;  // voxels a side
constexpr std::size_t kBrickCells = std::size_t{kBrick} * kBrick;

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
  const VoxelRect wanted{layer.reach.x0 >> kBrickBits, layer.reach.y0 >> kBrickBits,
                         layer.reach.x1 >> kBrickBits, layer.reach.y1 >> kBrickBits};
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
  std::int32_t lowest = VoxelRect::kNone, highest = -1;
  for (const Voxel& v : nodes) {
    if (v.z < 0) continue;
    lowest = std::min(lowest, v.z);
    highest = std::max(highest, v.z);
  }
  if (highest < 0) return;
  if (layers_.size() <= static_cast<std::size_t>(highest))
    layers_.resize(static_cast<std::size_t>(highest) + 1);
  const Shadows& shadows = cast_.emplace_back(nodes, lowest, highest, profile, sign);
  for (std::int32_t z = 0; z <= highest; ++z) {
    const VoxelRect reach = shadows.reach(z);
    // One voxel more on the far side, for the corners that close a square.
    if (!reach.empty())
      layers_[static_cast<std::size_t>(z)].reach.add({reach.x0, reach.y0, reach.x1 + 1, reach.y1 + 1});
  }
  check_memory();
}

// A layer to write on, in voxels from the corner of its table of bricks.
struct LightField::Canvas {
  LightField& field;
  Fixed** const bricks;
  const std::uint32_t width;
  const std::int32_t x0, y0;

  Canvas(LightField& owner, Layer& layer)
      : field(owner),
        bricks(layer.bricks.data()),
        width(static_cast<std::uint32_t>(layer.table.width())),
        x0(layer.table.x0 * kBrick),
        y0(layer.table.y0 * kBrick) {}

  void add(Fixed** row, std::uint32_t line, std::uint32_t x, Fixed amount) const {
    Fixed*& brick = row[x >> kBrickBits];
    if (!brick) brick = field.new_brick();
    brick[line + x % kBrick] += amount;
  }
  // The square from voxel (x, y) on, `side` voxels wide, as its four corners.
  void add_square(std::int32_t x, std::int32_t y, std::uint32_t side, Fixed amount) const {
    const auto left = static_cast<std::uint32_t>(x - x0), low = static_cast<std::uint32_t>(y - y0);
    const std::uint32_t right = left + side, high = low + side;
    Fixed** const below = bricks + (low >> kBrickBits) * width;
    Fixed** const above = bricks + (high >> kBrickBits) * width;
    const std::uint32_t first = (low % kBrick) * kBrick, last = (high % kBrick) * kBrick;
    add(below, first, left, amount);
    add(below, first, right, -amount);
    add(above, last, left, -amount);
    add(above, last, right, amount);
  }
};

// l = l_0 - b^-q (Yi 2018, 4.5) in one layer.
void LightField::draw(std::int32_t z) {
  Layer& layer = layers_[static_cast<std::size_t>(z)];
  // The layer is asked for in the order of memory before it is written to in that of the nodes.
  constexpr std::size_t kLine = 64 / sizeof(Fixed);
  for (Fixed* const brick : layer.bricks)
    if (brick)
      for (std::size_t i = 0; i < kBrickCells; i += kLine) __builtin_prefetch(brick + i, 1, 2);
  const Canvas canvas(*this, layer);
  for (; layer.drawn < cast_.size(); ++layer.drawn) {
    const Shadows& shadows = cast_[layer.drawn];
    const auto [first, last] = shadows.steps(z);
    for (int q = first; q <= last; ++q) {
      const int half = shadow_half_width(q);
      const auto side = static_cast<std::uint32_t>(2 * half + 1);
      const Fixed amount = shadows.amount(q);
      const auto [from, to] = shadows.rows().layers(z + q, z + q);
      for (std::uint32_t i = from; i < to; ++i)
        canvas.add_square(shadows.x(i) - half, shadows.y(i) - half, side, amount);
    }
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

void LightField::read(std::span<const Voxel> at, std::span<Fixed> shade) {
  std::fill(shade.begin(), shade.end(), 0);
  const VoxelRows queries(at, 0, layers_.size());
  for (std::size_t z = 0; z < layers_.size(); ++z)
    read_layer(static_cast<std::int32_t>(z), queries, at, shade, 0);
}

void LightField::update(std::span<const Voxel> at, std::span<Fixed> shade, std::size_t known) {
  std::fill(shade.begin() + static_cast<std::ptrdiff_t>(known), shade.end(), 0);
  const VoxelRows queries(at, 0, layers_.size());
  for (std::size_t z = 0; z < layers_.size(); ++z)
    read_layer(static_cast<std::int32_t>(z), queries, at, shade, known);
  updated_ = cast_.size();
}

// Whether to draw what is not drawn of a layer, rather than to sum it at the voxels asked for. The weights
// are those with which trees of 10^4 to 10^6 internodes took least time.
bool LightField::worth_drawing(std::int32_t z) const {
  constexpr std::size_t kSum = 5000, kNode = 32;  // against passing over a cell of the layer
  const Layer& layer = layers_[static_cast<std::size_t>(z)];
  std::size_t nodes = 0;
  for (std::size_t s = layer.drawn; s < cast_.size(); ++s) nodes += cast_[s].count_above(z);
  const std::size_t sums = asked_.known * (cast_.size() - updated_) +
                           (asked_.number.size() - asked_.known) * (cast_.size() - layer.drawn);
  return kNode * nodes + static_cast<std::size_t>(layer.reach.width() * layer.reach.height()) < kSum * sums;
}

// `shade` of the first `known` voxels lacks what was cast from updated_ on, of the others everything.
void LightField::read_layer(std::int32_t z, const VoxelRows& queries, std::span<const Voxel> at,
                            std::span<Fixed> shade, std::size_t known) {
  Layer& layer = layers_[static_cast<std::size_t>(z)];
  const auto [from, to] = queries.layers(z, z);
  if (layer.reach.empty() || from == to) return;
  make_room(layer);
  asked_.number.assign(queries.order().begin() + from, queries.order().begin() + to);
  const auto middle =
      std::partition(asked_.number.begin(), asked_.number.end(), [&](std::uint32_t i) { return i < known; });
  asked_.known = static_cast<std::size_t>(middle - asked_.number.begin());
  if (worth_drawing(z)) {
    for (const std::uint32_t i : asked_.number) shade[i] = 0;
    draw(z);
    integrate(z, queries, at, shade, 0);
    return;
  }
  if (asked_.known < asked_.number.size()) integrate(z, queries, at, shade, known);
  asked_.place.clear();
  for (const std::uint32_t i : asked_.number) asked_.place.push_back(at[i]);
  asked_.shade.assign(asked_.number.size(), 0);
  const std::span<const Voxel> place(asked_.place);
  const std::span<Fixed> added(asked_.shade);
  for (std::size_t s = layer.drawn; s < cast_.size(); ++s)
    cast_[s].add_at(z, place.subspan(asked_.known), added.subspan(asked_.known));
  for (std::size_t s = updated_; s < cast_.size(); ++s)
    cast_[s].add_at(z, place.first(asked_.known), added.first(asked_.known));
  for (std::size_t i = 0; i < added.size(); ++i) shade[asked_.number[i]] += added[i];
}

// Integrates as much of a layer as the voxels after the first `known` ask for: nothing lies before what was
// cast.
void LightField::integrate(std::int32_t z, const VoxelRows& queries, std::span<const Voxel> at,
                           std::span<Fixed> shade, std::size_t known) {
  const Layer& layer = layers_[static_cast<std::size_t>(z)];
  const VoxelRect& reach = layer.reach;
  const VoxelRect& wanted = queries.layer(z).span;
  const std::int32_t last_x = std::min(wanted.x1, reach.x1), last_y = std::min(wanted.y1, reach.y1);
  if (last_x < reach.x0) return;
  const std::int32_t x0 = layer.table.x0 << kBrickBits;  // of the column
  const auto across = static_cast<std::size_t>((last_x >> kBrickBits) - layer.table.x0) + 1;
  column_.assign(across * kBrick, 0);
  sum_.resize(across * kBrick);
  std::int32_t next = reach.y0;  // row not yet in the column
  for (std::int32_t y = std::max(wanted.y0, reach.y0); y <= last_y; ++y) {
    const auto [from, to] = queries.rows(z, y, y + 1);
    const std::span asked = queries.order().subspan(from, to - from);
    std::int32_t furthest = x0 - 1;
    for (const std::uint32_t i : asked)
      if (i >= known && at[i].x <= last_x) furthest = std::max(furthest, at[i].x);
    if (furthest < x0) continue;
    while (next <= y) {
      const std::int32_t brick = next >> kBrickBits;
      const std::int32_t last = std::min(y, (brick << kBrickBits) + kBrick - 1);
      add_rows(across, layer.bricks.data() + (brick - layer.table.y0) * layer.table.width(),
               next & (kBrick - 1), last & (kBrick - 1), column_.data());
      next = last + 1;
    }
    std::partial_sum(column_.begin(), column_.begin() + (furthest + 1 - x0), sum_.begin());
    for (const std::uint32_t i : asked)
      if (i >= known && at[i].x >= x0 && at[i].x <= last_x)
        shade[i] = sum_[static_cast<std::size_t>(at[i].x - x0)];
  }
}

}  // namespace dendrofit
