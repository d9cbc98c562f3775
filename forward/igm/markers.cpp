// SPDX-License-Identifier: GPL-3.0-or-later
#include "forward/igm/markers.h"

#include "core/errors.h"
#include "core/point_cloud.h"
#include "forward/environment/vectorised.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>

namespace dendrofit::igm {
namespace {

constexpr double kLeastLight = 0.1;  // darker markers pull nothing
constexpr double kMostCells = 1 << 28;
constexpr float kTakenPosition = 1e9F;
constexpr std::int32_t kTakenVoxel = 1 << 28;

constexpr double kRounding = 0.05;  // voxels; of positions in single precision
// Inner loops go by whole blocks, past the end of a run where need be.
constexpr std::uint32_t kBlock = 16;
constexpr std::uint32_t kPair = 2;  // flags looked at in one step

double light_of(Fixed shade) {
  return 1.0 - to_light(shade);
}

// Such a marker pulls nothing, and it only gets darker: it may as well be taken away.
bool too_dark(Fixed shade) {
  return light_of(shade) < kLeastLight;
}

std::uint32_t whole_blocks(std::uint32_t n) {
  return (n + kBlock - 1) & ~(kBlock - 1);
}

// shade[i] += weight[q] for each node in whose shadow a marker of the run lies; weight[layers] is 0.
DENDROFIT_VECTORISED
void shade_run(std::uint32_t n, const std::int32_t* __restrict vx, const std::int32_t* __restrict vy,
               const std::int32_t* __restrict vz, std::size_t node_count, const Voxel* __restrict nodes,
               const Fixed* __restrict weight, std::int32_t layers, Fixed* __restrict shade) {
  const auto last = static_cast<std::int32_t>(n), end = static_cast<std::int32_t>(whole_blocks(n));
  for (std::size_t k = 0; k < node_count; ++k) {
    const Voxel node = nodes[k];
    for (std::int32_t i = 0; i < end; ++i) {
      const std::int32_t q = node.z - vz[i];
      const std::int32_t away = std::max(std::abs(vx[i] - node.x), std::abs(vy[i] - node.y));
      const std::int32_t half = std::min(q, kPyramidLayers);  // below 0 where q is
      const std::int32_t in = -static_cast<std::int32_t>(away <= half) &
                              -static_cast<std::int32_t>(q < layers) & -static_cast<std::int32_t>(i < last);
      shade[i] += weight[(q & in) | (layers & ~in)];
    }
  }
}

// What a shoot's end sees, in voxels: markers within `near` are taken, those within `far` and the cone pull.
struct View {
  float x, y, z;     // the end
  float hx, hy, hz;  // unit vector ahead
  float near2, far2, cone2;
};

// keep[i]: whether a marker of the run is to be taken or pulls.
DENDROFIT_VECTORISED
void select_run(std::uint32_t n, const float* __restrict x, const float* __restrict y,
                const float* __restrict z, const View& v, std::int32_t* __restrict keep) {
  const std::uint32_t end = whole_blocks(n);
  for (std::uint32_t i = 0; i < end; ++i) {
    const float dx = x[i] - v.x, dy = y[i] - v.y, dz = z[i] - v.z;
    const float d2 = dx * dx + dy * dy + dz * dz;
    const float along = dx * v.hx + dy * v.hy + dz * v.hz;
    const int ahead = static_cast<int>(d2 <= v.far2) & static_cast<int>(along > 0) &
                      static_cast<int>(along * along >= v.cone2 * d2);
    keep[i] = static_cast<int>(d2 <= v.near2) | ahead;
  }
}

// How far a cone of cosine `cone` and length 1 about a unit vector goes along an axis, where the vector has
// component h.
double cone_reach(double h, double cone) {
  if (h >= cone) return 1;
  return h * cone + std::sqrt(std::max(0.0, 1 - h * h)) * std::sqrt(1 - cone * cone);
}

}  // namespace

MarkerField::MarkerField(const std::vector<Vec3>& position, const std::vector<Fixed>& shade,
                         const VoxelFrame& frame, double cell_m)
    : frame_(frame),
      cell_(Vec3(cell_m, 0.5 * cell_m, cell_m) / frame.edge_m),
      per_cell_(cell_.cwiseInverse()) {
  if (position.empty()) return;
  const Bounds bounds = bounds_of(position);
  lo_ = (bounds.lo - frame.origin) / frame.edge_m;
  if (((bounds.size() / frame.edge_m).cwiseQuotient(cell_) + Vec3::Ones()).prod() > kMostCells)
    throw InputError("trees stand too far apart to share one light field; grow them in separate runs");
  for (int axis = 0; axis < 3; ++axis)
    count_[axis] = static_cast<int>(bounds.size()[axis] / frame.edge_m / cell_[axis]) + 1;

  constexpr std::uint32_t kNowhere = ~std::uint32_t{0};
  const std::size_t n = position.size();
  std::vector<std::uint32_t> cell(n, kNowhere);
  first_.assign(static_cast<std::size_t>(count_[0]) * static_cast<std::size_t>(count_[1]) *
                        static_cast<std::size_t>(count_[2]) +
                    1,
                0);
  for (std::size_t i = 0; i < n; ++i) {
    if (too_dark(shade[i])) continue;
    const Vec3 p = (position[i] - frame.origin) / frame.edge_m;
    cell[i] = static_cast<std::uint32_t>((cell_of(p.z(), 2) * count_[0] + cell_of(p.x(), 0)) * count_[1] +
                                         cell_of(p.y(), 1));
    ++first_[cell[i] + 1];
  }
  for (std::size_t c = 1; c < first_.size(); ++c) first_[c] += first_[c - 1];
  resize(first_.back());
  std::vector<std::uint32_t> next(first_.begin(), first_.end() - 1);
  for (std::size_t i = 0; i < n; ++i) {
    if (cell[i] == kNowhere) continue;
    const std::size_t at = next[cell[i]]++;
    const Vec3 p = (position[i] - frame.origin) / frame.edge_m - lo_;
    const Voxel v = frame.at(position[i]);
    x_[at] = static_cast<float>(p.x()), y_[at] = static_cast<float>(p.y()),
    z_[at] = static_cast<float>(p.z());
    vx_[at] = v.x, vy_[at] = v.y, vz_[at] = v.z;
    shade_[at] = shade[i];
  }
}

int MarkerField::cell_of(double coordinate, int axis) const {
  return std::clamp(floor_to_int((coordinate - lo_[axis]) / cell_[axis]), 0, count_[axis] - 1);
}

int MarkerField::cell_before(double coordinate, int axis) const {
  return std::clamp(floor_to_int((coordinate - kRounding - lo_[axis]) * per_cell_[axis]), 0,
                    count_[axis] - 1);
}

int MarkerField::cell_after(double coordinate, int axis) const {
  return std::clamp(floor_to_int((coordinate + kRounding - lo_[axis]) * per_cell_[axis]), 0,
                    count_[axis] - 1);
}

MarkerField::Run MarkerField::run(int x, int y0, int y1, int z) const {
  const std::size_t row =
      (static_cast<std::size_t>(z) * static_cast<std::size_t>(count_[0]) + static_cast<std::size_t>(x)) *
      static_cast<std::size_t>(count_[1]);
  return {first_[row + static_cast<std::size_t>(y0)], first_[row + static_cast<std::size_t>(y1) + 1]};
}

void MarkerField::resize(std::size_t size) {
  size_ = size;
  const auto pad = [&](auto&... column) { (column.resize(size + kBlock), ...); };
  pad(x_, y_, z_, vx_, vy_, vz_, shade_);
}

// Squeezes out the markers that are gone once they are a quarter of all.
void MarkerField::squeeze() {
  if (4 * taken_ < size_) return;
  std::uint32_t to = 0;
  for (std::size_t c = 0; c + 1 < first_.size(); ++c) {
    const std::uint32_t from = first_[c], end = first_[c + 1];
    first_[c] = to;
    for (std::uint32_t i = from; i < end; ++i) {
      if (vx_[i] == kTakenVoxel || too_dark(shade_[i])) continue;
      x_[to] = x_[i], y_[to] = y_[i], z_[to] = z_[i];
      vx_[to] = vx_[i], vy_[to] = vy_[i], vz_[to] = vz_[i];
      shade_[to] = shade_[i];
      ++to;
    }
  }
  first_.back() = to;
  resize(to);
  taken_ = 0;
}

bool MarkerField::pull(const Vec3& at, const Vec3& heading, double near_m, double far_m, double cone,
                       Vec3& direction) {
  if (size_ == 0) return false;
  const Vec3 p = (at - frame_.origin) / frame_.edge_m, local = p - lo_;
  const double near = near_m / frame_.edge_m, far = far_m / frame_.edge_m;
  const View view{
      static_cast<float>(local.x()),   static_cast<float>(local.y()),   static_cast<float>(local.z()),
      static_cast<float>(heading.x()), static_cast<float>(heading.y()), static_cast<float>(heading.z()),
      static_cast<float>(near * near), static_cast<float>(far * far),   static_cast<float>(cone * cone)};
  int lo[3], hi[3];  // cells of the box about the near ball and the cone
  for (int axis = 0; axis < 3; ++axis) {
    lo[axis] = cell_before(p[axis] - std::max(near, far * cone_reach(-heading[axis], cone)), axis);
    hi[axis] = cell_after(p[axis] + std::max(near, far * cone_reach(heading[axis], cone)), axis);
  }
  double sx = 0, sy = 0, sz = 0;
  for (int cz = lo[2]; cz <= hi[2]; ++cz)
    for (int cx = lo[0]; cx <= hi[0]; ++cx) {
      const Run markers = run(cx, lo[1], hi[1], cz);
      const std::uint32_t n = markers.last - markers.first;
      if (keep_.size() < n + kBlock) keep_.resize(n + kBlock);
      select_run(n, x_.data() + markers.first, y_.data() + markers.first, z_.data() + markers.first, view,
                 keep_.data());
      for (std::uint32_t pair = 0; pair < n; pair += kPair) {
        std::uint64_t any = 0;
        std::memcpy(&any, keep_.data() + pair, sizeof any);
        if (any == 0) continue;
        for (std::uint32_t j = pair; j < std::min(pair + kPair, n); ++j) {
          if (!keep_[j]) continue;
          const std::size_t i = markers.first + j;
          const float dx = x_[i] - view.x, dy = y_[i] - view.y, dz = z_[i] - view.z;
          const float d2 = dx * dx + dy * dy + dz * dz;
          if (d2 <= view.near2) {
            x_[i] = kTakenPosition;
            vx_[i] = kTakenVoxel;
            ++taken_;
            continue;
          }
          if (too_dark(shade_[i])) continue;
          const double weight = std::min(light_of(shade_[i]), 1.0) / std::sqrt(static_cast<double>(d2));
          sx += weight * dx, sy += weight * dy, sz += weight * dz;
        }
      }
    }
  direction = Vec3(sx, sy, sz);
  const double norm = direction.norm();
  if (!(norm > 1e-9)) return false;
  direction /= norm;
  return true;
}

void MarkerField::cast(std::span<const Voxel> nodes, const ShadeProfile& profile) {
  squeeze();
  if (size_ == 0 || nodes.empty()) return;
  Voxel low = nodes[0], high = nodes[0];
  for (const Voxel& node : nodes) {
    low = {std::min(low.x, node.x), std::min(low.y, node.y), std::min(low.z, node.z)};
    high = {std::max(high.x, node.x), std::max(high.y, node.y), std::max(high.z, node.z)};
  }
  const int deepest = profile.layers() - 1;
  const int cz0 = cell_before(low.z - deepest - 0.5, 2), cz1 = cell_after(high.z + 0.5, 2);
  for (int cz = cz0; cz <= cz1; ++cz) {
    // The shadow's width at the bottom of this layer of cells.
    const double bottom = lo_.z() + cz * cell_.z();
    const int half = std::clamp(static_cast<int>(std::ceil(high.z - bottom + 0.5)), 0, kPyramidLayers);
    const int cx0 = cell_before(low.x - half - 0.5, 0), cx1 = cell_after(high.x + half + 0.5, 0);
    const int cy0 = cell_before(low.y - half - 0.5, 1), cy1 = cell_after(high.y + half + 0.5, 1);
    for (int cx = cx0; cx <= cx1; ++cx) {
      const Run markers = run(cx, cy0, cy1, cz);
      shade_run(markers.last - markers.first, vx_.data() + markers.first, vy_.data() + markers.first,
                vz_.data() + markers.first, nodes.size(), nodes.data(), profile.padded(), profile.layers(),
                shade_.data() + markers.first);
    }
  }
}

}  // namespace dendrofit::igm
