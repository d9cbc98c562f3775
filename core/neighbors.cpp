// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/neighbors.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include <nanoflann.hpp>

namespace dendrofit {
namespace {

struct Coordinates {
  std::vector<std::array<float, 3>> values;
  std::size_t kdtree_get_point_count() const { return values.size(); }
  float kdtree_get_pt(std::size_t i, std::size_t axis) const { return values[i][axis]; }
  template <class Box>
  bool kdtree_get_bbox(Box&) const {
    return false;
  }
};

using KdTree = nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<float, Coordinates>,
                                                   Coordinates, 3, std::uint32_t>;

// nanoflann 1.5 (Ubuntu 24.04) renamed what 1.4 (Debian 12) calls pair and SearchParams.
#if NANOFLANN_VERSION >= 0x150
using Match = nanoflann::ResultItem<std::uint32_t, float>;
using SearchSettings = nanoflann::SearchParameters;
#else
using Match = std::pair<std::uint32_t, float>;
using SearchSettings = nanoflann::SearchParams;
#endif

std::array<float, 3> single(const Vec3& p) {
  return {static_cast<float>(p.x()), static_cast<float>(p.y()), static_cast<float>(p.z())};
}

/// Keeps the nearest of the points that are wanted; nanoflann's interface.
class NearestWanted {
 public:
  NearestWanted(float within_squared, const std::function<bool(std::uint32_t)>& wanted)
      : best_{0, within_squared}, wanted_(wanted) {}
  std::size_t size() const { return found_ ? 1 : 0; }
  bool full() const { return found_; }
  float worstDist() const { return best_.second; }
  bool addPoint(float distance, std::uint32_t index) {
    if (distance < best_.second && wanted_(index)) {
      best_ = {index, distance};
      found_ = true;
    }
    return true;
  }
  void sort() {}
  std::optional<Neighbor> best() const {
    return found_ ? std::optional(Neighbor{best_.first, best_.second}) : std::nullopt;
  }

 private:
  std::pair<std::uint32_t, float> best_;
  bool found_ = false;
  const std::function<bool(std::uint32_t)>& wanted_;
};

void sort_by_distance(std::vector<Neighbor>& out) {
  std::sort(out.begin(), out.end(), [](const Neighbor& a, const Neighbor& b) {
    return a.distance_squared != b.distance_squared ? a.distance_squared < b.distance_squared
                                                    : a.index < b.index;
  });
}

}  // namespace

struct Neighbors::Index {
  Coordinates coordinates;
  std::unique_ptr<KdTree> tree;
};

Neighbors::Neighbors(const std::vector<Vec3>& points) : index_(std::make_unique<Index>()) {
  index_->coordinates.values.reserve(points.size());
  for (const Vec3& p : points) index_->coordinates.values.push_back(single(p));
  index_->tree =
      std::make_unique<KdTree>(3, index_->coordinates, nanoflann::KDTreeSingleIndexAdaptorParams(16));
  if (!points.empty()) index_->tree->buildIndex();
}

Neighbors::~Neighbors() = default;
Neighbors::Neighbors(Neighbors&&) noexcept = default;
Neighbors& Neighbors::operator=(Neighbors&&) noexcept = default;

std::size_t Neighbors::size() const {
  return index_->coordinates.values.size();
}

void Neighbors::nearest(const Vec3& query, std::size_t k, std::vector<Neighbor>& out) const {
  out.clear();
  k = std::min(k, size());
  if (k == 0) return;
  thread_local std::vector<std::uint32_t> indices;
  thread_local std::vector<float> distances;
  indices.resize(k);
  distances.resize(k);
  const std::array<float, 3> q = single(query);
  const std::size_t found = index_->tree->knnSearch(q.data(), k, indices.data(), distances.data());
  out.resize(found);
  for (std::size_t i = 0; i < found; ++i) out[i] = {indices[i], distances[i]};
  sort_by_distance(out);
}

std::optional<Neighbor> Neighbors::nearest_where(const Vec3& query, double radius,
                                                 const std::function<bool(std::uint32_t)>& wanted) const {
  if (size() == 0 || !(radius >= 0)) return std::nullopt;
  const std::array<float, 3> q = single(query);
  // The search leaves out what is exactly as far as the bound.
  const auto square = static_cast<float>(radius * radius);
  NearestWanted result(std::nextafter(square, std::numeric_limits<float>::infinity()), wanted);
  index_->tree->findNeighbors(result, q.data(), SearchSettings());
  return result.best();
}

void Neighbors::within(const Vec3& query, double radius, std::vector<Neighbor>& out) const {
  out.clear();
  if (size() == 0 || !(radius >= 0)) return;
  thread_local std::vector<Match> matches;
  const std::array<float, 3> q = single(query);
  nanoflann::RadiusResultSet<float, std::uint32_t> result(static_cast<float>(radius * radius), matches);
  index_->tree->findNeighbors(result, q.data(), SearchSettings());
  out.reserve(matches.size());
  for (const auto& [index, distance] : matches) out.push_back({index, distance});
  sort_by_distance(out);
}

}  // namespace dendrofit
