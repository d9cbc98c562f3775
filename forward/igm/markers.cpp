// SPDX-License-Identifier: GPL-3.0-or-later
#include "forward/igm/markers.h"

#include "core/errors.h"
#include "core/point_cloud.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace dendrofit::igm {
namespace {

constexpr double kLeastLight = 0.1;  // darker markers pull nothing
constexpr double kMostCells = 1 << 27;

}  // namespace

MarkerField::MarkerField(const std::vector<Vec3>& position, const std::vector<Fixed>& shade,
                         const VoxelFrame& frame, double cell_m)
    : frame_(frame), cell_(cell_m / frame.edge_m) {
  if (position.empty()) return;
  const Bounds bounds = bounds_of(position);
  lo_ = (bounds.lo - frame.origin) / frame.edge_m;
  const Vec3 size = bounds.size() / cell_m;
  if ((size + Vec3::Ones()).prod() > kMostCells)
    throw InputError("trees stand too far apart to share one light field; grow them in separate runs");
  nx_ = static_cast<int>(size.x()) + 1;
  ny_ = static_cast<int>(size.y()) + 1;
  nz_ = static_cast<int>(size.z()) + 1;

  const std::size_t n = position.size();
  std::vector<std::uint32_t> cell(n);
  cells_.assign(static_cast<std::size_t>(nx_) * static_cast<std::size_t>(ny_) * static_cast<std::size_t>(nz_),
                {});
  for (std::size_t i = 0; i < n; ++i) {
    const Vec3 p = (position[i] - frame.origin) / frame.edge_m;
    cell[i] = static_cast<std::uint32_t>(
        (static_cast<std::size_t>(cell_of(p.x(), lo_.x(), nx_)) * static_cast<std::size_t>(ny_) +
         static_cast<std::size_t>(cell_of(p.y(), lo_.y(), ny_))) *
            static_cast<std::size_t>(nz_) +
        static_cast<std::size_t>(cell_of(p.z(), lo_.z(), nz_)));
    ++cells_[cell[i]].last;
  }
  std::uint32_t total = 0;
  for (Range& range : cells_) {
    const std::uint32_t count = range.last;
    range = {total, total};
    total += count;
  }
  x_.resize(n), y_.resize(n), z_.resize(n);
  vx_.resize(n), vy_.resize(n), vz_.resize(n);
  shade_.resize(n);
  for (std::size_t i = 0; i < n; ++i) {
    const std::size_t at = cells_[cell[i]].last++;
    const Vec3 p = (position[i] - frame.origin) / frame.edge_m;
    const Voxel v = frame.at(position[i]);
    x_[at] = static_cast<float>(p.x()), y_[at] = static_cast<float>(p.y()),
    z_[at] = static_cast<float>(p.z());
    vx_[at] = v.x, vy_[at] = v.y, vz_[at] = v.z;
    shade_[at] = shade[i];
  }
}

int MarkerField::cell_of(double coordinate, double lo, int count) const {
  return std::clamp(static_cast<int>(std::floor((coordinate - lo) / cell_)), 0, count - 1);
}

bool MarkerField::pull(const Vec3& at, const Vec3& heading, double near_m, double far_m, double cone,
                       Vec3& direction) {
  if (cells_.empty()) return false;
  const Vec3 p = (at - frame_.origin) / frame_.edge_m;
  const auto px = static_cast<float>(p.x()), py = static_cast<float>(p.y()), pz = static_cast<float>(p.z());
  const double reach = far_m / frame_.edge_m;
  const auto near2 = static_cast<float>((near_m / frame_.edge_m) * (near_m / frame_.edge_m));
  const auto far2 = static_cast<float>(reach * reach);
  const auto hx = static_cast<float>(heading.x()), hy = static_cast<float>(heading.y()),
             hz = static_cast<float>(heading.z());
  const auto cosine = static_cast<float>(cone);
  double sx = 0, sy = 0, sz = 0;
  const int cx0 = cell_of(p.x() - reach, lo_.x(), nx_), cx1 = cell_of(p.x() + reach, lo_.x(), nx_);
  const int cy0 = cell_of(p.y() - reach, lo_.y(), ny_), cy1 = cell_of(p.y() + reach, lo_.y(), ny_);
  const int cz0 = cell_of(p.z() - reach, lo_.z(), nz_), cz1 = cell_of(p.z() + reach, lo_.z(), nz_);
  for (int cx = cx0; cx <= cx1; ++cx)
    for (int cy = cy0; cy <= cy1; ++cy)
      for (int cz = cz0; cz <= cz1; ++cz) {
        Range& range = cells_[(static_cast<std::size_t>(cx) * static_cast<std::size_t>(ny_) +
                               static_cast<std::size_t>(cy)) *
                                  static_cast<std::size_t>(nz_) +
                              static_cast<std::size_t>(cz)];
        for (std::size_t i = range.first; i < range.last;) {
          const float dx = x_[i] - px, dy = y_[i] - py, dz = z_[i] - pz;
          const float d2 = dx * dx + dy * dy + dz * dz;
          if (d2 > far2) {
            ++i;
            continue;
          }
          if (d2 <= near2) {  // taken: the cell's last marker moves here
            const std::size_t last = --range.last;
            x_[i] = x_[last], y_[i] = y_[last], z_[i] = z_[last];
            vx_[i] = vx_[last], vy_[i] = vy_[last], vz_[i] = vz_[last];
            shade_[i] = shade_[last];
            continue;
          }
          const float along = dx * hx + dy * hy + dz * hz;
          if (along > 0 && along * along >= cosine * cosine * d2) {
            const double light = 1.0 - to_light(shade_[i]);
            if (light >= kLeastLight) {
              const double weight = std::min(light, 1.0) / std::sqrt(static_cast<double>(d2));
              sx += weight * dx, sy += weight * dy, sz += weight * dz;
            }
          }
          ++i;
        }
      }
  direction = Vec3(sx, sy, sz);
  const double norm = direction.norm();
  if (!(norm > 1e-9)) return false;
  direction /= norm;
  return true;
}

void MarkerField::cast(const Voxel& node, const ShadeProfile& profile) {
  if (cells_.empty()) return;
  const int cx0 = cell_of(node.x - kPyramidLayers - 1, lo_.x(), nx_),
            cx1 = cell_of(node.x + kPyramidLayers + 1, lo_.x(), nx_);
  const int cy0 = cell_of(node.y - kPyramidLayers - 1, lo_.y(), ny_),
            cy1 = cell_of(node.y + kPyramidLayers + 1, lo_.y(), ny_);
  const int cz0 = cell_of(node.z - profile.layers(), lo_.z(), nz_), cz1 = cell_of(node.z + 1, lo_.z(), nz_);
  for (int cx = cx0; cx <= cx1; ++cx)
    for (int cy = cy0; cy <= cy1; ++cy)
      for (int cz = cz0; cz <= cz1; ++cz) {
        const Range range = cells_[(static_cast<std::size_t>(cx) * static_cast<std::size_t>(ny_) +
                                    static_cast<std::size_t>(cy)) *
                                       static_cast<std::size_t>(nz_) +
                                   static_cast<std::size_t>(cz)];
        for (std::size_t i = range.first; i < range.last; ++i)
          shade_[i] += profile.at(vx_[i] - node.x, vy_[i] - node.y, node.z - vz_[i]);
      }
}

}  // namespace dendrofit::igm
