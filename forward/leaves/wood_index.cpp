// SPDX-License-Identifier: GPL-3.0-or-later
#include "forward/leaves/wood_index.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace dendrofit {
namespace {

constexpr std::int64_t kOffset = 1 << 20;  // 21 bits a coordinate
constexpr double kHalfDiagonal = 0.8660254037844387;

struct CellRange {
  std::array<std::int64_t, 3> lo, hi;
};

CellRange cells_of(const Vec3& lo, const Vec3& hi, const Vec3& origin, double cell) {
  CellRange range{};
  for (int k = 0; k < 3; ++k) {
    range.lo[static_cast<std::size_t>(k)] = static_cast<std::int64_t>(std::floor((lo[k] - origin[k]) / cell));
    range.hi[static_cast<std::size_t>(k)] = static_cast<std::int64_t>(std::floor((hi[k] - origin[k]) / cell));
  }
  return range;
}

template <class Visit>
void for_cells(const CellRange& r, const Visit& visit) {
  for (std::int64_t x = r.lo[0]; x <= r.hi[0]; ++x)
    for (std::int64_t y = r.lo[1]; y <= r.hi[1]; ++y)
      for (std::int64_t z = r.lo[2]; z <= r.hi[2]; ++z) visit(x, y, z);
}

}  // namespace

double distance2_to_segment(const Vec3& p, const Vec3& a, const Vec3& axis, double length) {
  const Vec3 d = p - a;
  return (d - std::clamp(d.dot(axis), 0.0, length) * axis).squaredNorm();
}

std::uint64_t WoodIndex::key(std::int64_t x, std::int64_t y, std::int64_t z) const {
  return (static_cast<std::uint64_t>(x + kOffset) << 42) | (static_cast<std::uint64_t>(y + kOffset) << 21) |
         static_cast<std::uint64_t>(z + kOffset);
}

WoodIndex::WoodIndex(const Tree& tree, double cell_m) : cell_(cell_m) {
  Vec3 lo = Vec3::Constant(1e300), hi = Vec3::Constant(-1e300);
  cylinders_.reserve(tree.size());
  for (std::size_t i = 0; i < tree.size(); ++i) {
    cylinders_.push_back(solid_cylinder(tree.start[i], tree.end[i], tree.radius[i]));
    lo = lo.cwiseMin(tree.start[i].cwiseMin(tree.end[i]));
    hi = hi.cwiseMax(tree.start[i].cwiseMax(tree.end[i]));
  }
  if (cylinders_.empty()) return;
  lo_ = lo;
  // A stand of any extent stays within the keys' 21 bits a coordinate.
  cell_ = std::max(cell_, (hi - lo).maxCoeff() / 500000);
  std::vector<std::pair<std::uint64_t, std::int32_t>> pairs;
  for (std::size_t i = 0; i < cylinders_.size(); ++i) {
    const SolidCylinder& c = cylinders_[i];
    const Vec3 tip = c.base + c.length * c.axis;
    const Vec3 wide = Vec3::Constant(c.radius);
    const double touch = c.radius + kHalfDiagonal * cell_;
    for_cells(cells_of(c.base.cwiseMin(tip) - wide, c.base.cwiseMax(tip) + wide, lo_, cell_),
              [&](std::int64_t x, std::int64_t y, std::int64_t z) {
                const Vec3 centre = lo_ + cell_ * (Vec3(static_cast<double>(x), static_cast<double>(y),
                                                        static_cast<double>(z)) +
                                                   Vec3::Constant(0.5));
                if (distance2_to_segment(centre, c.base, c.axis, c.length) <= touch * touch)
                  pairs.emplace_back(key(x, y, z), static_cast<std::int32_t>(i));
              });
  }
  std::sort(pairs.begin(), pairs.end());
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    if (k == 0 || pairs[k].first != pairs[k - 1].first) {
      cell_of_.emplace(pairs[k].first, static_cast<std::uint32_t>(first_.size()));
      first_.push_back(static_cast<std::uint32_t>(k));
    }
    entry_.push_back(pairs[k].second);
  }
  first_.push_back(static_cast<std::uint32_t>(pairs.size()));
}

void WoodIndex::near(const Vec3& centre, double reach, std::vector<std::int32_t>& out) const {
  out.clear();
  const Vec3 wide = Vec3::Constant(reach);
  for_cells(cells_of(centre - wide, centre + wide, lo_, cell_),
            [&](std::int64_t x, std::int64_t y, std::int64_t z) {
              const auto found = cell_of_.find(key(x, y, z));
              if (found == cell_of_.end()) return;
              for (std::uint32_t k = first_[found->second]; k < first_[found->second + 1]; ++k) {
                const SolidCylinder& c = cylinders_[static_cast<std::size_t>(entry_[k])];
                const double touch = reach + c.radius;
                if (distance2_to_segment(centre, c.base, c.axis, c.length) <= touch * touch)
                  out.push_back(entry_[k]);
              }
            });
  std::sort(out.begin(), out.end());
  out.erase(std::unique(out.begin(), out.end()), out.end());
}

}  // namespace dendrofit
