// SPDX-License-Identifier: GPL-3.0-or-later
#include "forward/igm/markers.h"

#include "core/errors.h"
#include "core/point_cloud.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>

// The two inner loops in the machine's own vector width; integers and separately rounded floats give the same
// bits in each version.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(__SANITIZE_ADDRESS__) && \
    defined(__gnu_linux__)
#define DENDROFIT_VECTORISED __attribute__((target_clones("avx512f", "avx2", "default"), optimize("O3")))
#else
#define DENDROFIT_VECTORISED
#endif

namespace dendrofit::igm {
namespace {

constexpr double kLeastLight = 0.1;  // darker markers pull nothing
constexpr double kMostCells = 1 << 28;
constexpr float kTakenPosition = 1e9F;
constexpr std::int32_t kTakenVoxel = 1 << 28;

// shade[i] += weight[q] where the marker lies in the node's shadow; weight[layers] is 0.
DENDROFIT_VECTORISED
void shade_run(std::size_t n, const std::int32_t* __restrict vx, const std::int32_t* __restrict vy,
               const std::int32_t* __restrict vz, Voxel node, const Fixed* __restrict weight,
               std::int32_t layers, Fixed* __restrict shade) {
  for (std::size_t i = 0; i < n; ++i) {
    const std::int32_t q = node.z - vz[i];
    const std::int32_t away = std::max(std::abs(vx[i] - node.x), std::abs(vy[i] - node.y));
    const std::int32_t half = std::min(q, kPyramidLayers);  // below 0 where q is
    const std::int32_t in = -static_cast<std::int32_t>(away <= half) & -static_cast<std::int32_t>(q < layers);
    shade[i] += weight[(q & in) | (layers & ~in)];
  }
}

DENDROFIT_VECTORISED
void distance_run(std::size_t n, const float* __restrict x, const float* __restrict y,
                  const float* __restrict z, float px, float py, float pz, float* __restrict d2) {
  for (std::size_t i = 0; i < n; ++i) {
    const float dx = x[i] - px, dy = y[i] - py, dz = z[i] - pz;
    d2[i] = dx * dx + dy * dy + dz * dz;
  }
}

}  // namespace

MarkerField::MarkerField(const std::vector<Vec3>& position, const std::vector<Fixed>& shade,
                         const VoxelFrame& frame, double cell_m)
    : frame_(frame), cell_(Vec3(cell_m, 0.5 * cell_m, cell_m) / frame.edge_m) {
  if (position.empty()) return;
  const Bounds bounds = bounds_of(position);
  lo_ = (bounds.lo - frame.origin) / frame.edge_m;
  if (((bounds.size() / frame.edge_m).cwiseQuotient(cell_) + Vec3::Ones()).prod() > kMostCells)
    throw InputError("trees stand too far apart to share one light field; grow them in separate runs");
  for (int axis = 0; axis < 3; ++axis)
    count_[axis] = static_cast<int>(bounds.size()[axis] / frame.edge_m / cell_[axis]) + 1;

  const std::size_t n = position.size();
  std::vector<std::uint32_t> cell(n);
  first_.assign(static_cast<std::size_t>(count_[0]) * static_cast<std::size_t>(count_[1]) *
                        static_cast<std::size_t>(count_[2]) +
                    1,
                0);
  for (std::size_t i = 0; i < n; ++i) {
    const Vec3 p = (position[i] - frame.origin) / frame.edge_m;
    cell[i] = static_cast<std::uint32_t>((cell_of(p.z(), 2) * count_[0] + cell_of(p.x(), 0)) * count_[1] +
                                         cell_of(p.y(), 1));
    ++first_[cell[i] + 1];
  }
  for (std::size_t c = 1; c < first_.size(); ++c) first_[c] += first_[c - 1];
  x_.resize(n), y_.resize(n), z_.resize(n);
  vx_.resize(n), vy_.resize(n), vz_.resize(n);
  shade_.resize(n);
  std::vector<std::uint32_t> next(first_.begin(), first_.end() - 1);
  for (std::size_t i = 0; i < n; ++i) {
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
  return std::clamp(static_cast<int>(std::floor((coordinate - lo_[axis]) / cell_[axis])), 0,
                    count_[axis] - 1);
}

MarkerField::Run MarkerField::run(int x, int y0, int y1, int z) const {
  const std::size_t row =
      (static_cast<std::size_t>(z) * static_cast<std::size_t>(count_[0]) + static_cast<std::size_t>(x)) *
      static_cast<std::size_t>(count_[1]);
  return {first_[row + static_cast<std::size_t>(y0)], first_[row + static_cast<std::size_t>(y1) + 1]};
}

// Squeezes out the markers that are gone once they are a quarter of all.
void MarkerField::squeeze() {
  if (4 * taken_ < x_.size()) return;
  std::uint32_t to = 0;
  for (std::size_t c = 0; c + 1 < first_.size(); ++c) {
    const std::uint32_t from = first_[c], end = first_[c + 1];
    first_[c] = to;
    for (std::uint32_t i = from; i < end; ++i) {
      if (vx_[i] == kTakenVoxel) continue;
      x_[to] = x_[i], y_[to] = y_[i], z_[to] = z_[i];
      vx_[to] = vx_[i], vy_[to] = vy_[i], vz_[to] = vz_[i];
      shade_[to] = shade_[i];
      ++to;
    }
  }
  first_.back() = to;
  const auto resize = [to](auto&... column) { (column.resize(to), ...); };
  resize(x_, y_, z_, vx_, vy_, vz_, shade_);
  taken_ = 0;
}

bool MarkerField::pull(const Vec3& at, const Vec3& heading, double near_m, double far_m, double cone,
                       Vec3& direction) {
  if (x_.empty()) return false;
  const Vec3 p = (at - frame_.origin) / frame_.edge_m, local = p - lo_;
  const auto px = static_cast<float>(local.x()), py = static_cast<float>(local.y()),
             pz = static_cast<float>(local.z());
  const double reach = far_m / frame_.edge_m;
  const auto near2 = static_cast<float>((near_m / frame_.edge_m) * (near_m / frame_.edge_m));
  const auto far2 = static_cast<float>(reach * reach);
  const auto hx = static_cast<float>(heading.x()), hy = static_cast<float>(heading.y()),
             hz = static_cast<float>(heading.z());
  const auto cone2 = static_cast<float>(cone * cone);
  const int cx0 = cell_of(p.x() - reach, 0), cx1 = cell_of(p.x() + reach, 0);
  const int cy0 = cell_of(p.y() - reach, 1), cy1 = cell_of(p.y() + reach, 1);
  const int cz0 = cell_of(p.z() - reach, 2), cz1 = cell_of(p.z() + reach, 2);
  double sx = 0, sy = 0, sz = 0;
  std::array<float, 256> d2;
  for (int cz = cz0; cz <= cz1; ++cz)
    for (int cx = cx0; cx <= cx1; ++cx) {
      const Run markers = run(cx, cy0, cy1, cz);
      for (std::size_t first = markers.first; first < markers.last; first += d2.size()) {
        const std::size_t n = std::min(d2.size(), markers.last - first);
        distance_run(n, x_.data() + first, y_.data() + first, z_.data() + first, px, py, pz, d2.data());
        for (std::size_t j = 0; j < n; ++j) {
          if (d2[j] > far2) continue;
          const std::size_t i = first + j;
          if (d2[j] <= near2) {
            x_[i] = kTakenPosition;
            vx_[i] = kTakenVoxel;
            ++taken_;
            continue;
          }
          const float dx = x_[i] - px, dy = y_[i] - py, dz = z_[i] - pz;
          const float along = dx * hx + dy * hy + dz * hz;
          if (along <= 0 || along * along < cone2 * d2[j]) continue;
          const double light = 1.0 - to_light(shade_[i]);
          if (light < kLeastLight) continue;
          const double weight = std::min(light, 1.0) / std::sqrt(static_cast<double>(d2[j]));
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

void MarkerField::cast(const Voxel& node, const ShadeProfile& profile) {
  squeeze();
  if (x_.empty()) return;
  const int deepest = profile.layers() - 1;
  const int cz0 = cell_of(node.z - deepest - 0.5, 2), cz1 = cell_of(node.z + 0.5, 2);
  for (int cz = cz0; cz <= cz1; ++cz) {
    // The shadow's width at the bottom of this layer of cells.
    const double bottom = lo_.z() + cz * cell_.z();
    const int half = std::clamp(static_cast<int>(std::ceil(node.z - bottom + 0.5)), 0, kPyramidLayers);
    const int cx0 = cell_of(node.x - half - 0.5, 0), cx1 = cell_of(node.x + half + 0.5, 0);
    const int cy0 = cell_of(node.y - half - 0.5, 1), cy1 = cell_of(node.y + half + 0.5, 1);
    for (int cx = cx0; cx <= cx1; ++cx) {
      const Run markers = run(cx, cy0, cy1, cz);
      shade_run(markers.last - markers.first, vx_.data() + markers.first, vy_.data() + markers.first,
                vz_.data() + markers.first, node, profile.padded(), profile.layers(),
                shade_.data() + markers.first);
    }
  }
}

}  // namespace dendrofit::igm
