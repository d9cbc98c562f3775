// SPDX-License-Identifier: GPL-3.0-or-later
#include "forward/leaves/leaf_drift.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

namespace dendrofit {

void LeafDrift::Property::add(Histogram& histogram, double x, double weight) const {
  const double at = hi > lo ? (x - lo) / (hi - lo) * static_cast<double>(kFine) : 0;
  histogram[static_cast<std::size_t>(std::clamp(std::floor(at), 0.0, static_cast<double>(kFine - 1)))] +=
      weight;
}

LeafDrift::LeafDrift(const BearingWood& wood, const CandidateSource& source, const LeafOptions& options)
    : wood_(wood) {
  for (const LeafShapeShare& s : options.traits.shapes) unit_area_.push_back(s.shape.unit_area());
  for (std::size_t k = 0; k < kPlaces; ++k)
    for (const Piece& p : wood.pieces) places_[k].add(places_[k].requested, p.place[k], p.share);
  const auto from_law = [](Property& property, const TabulatedLaw& law, double lo, double hi) {
    property.lo = lo;
    property.hi = hi;
    for (std::size_t b = 0; b < kFine; ++b) {
      const auto edge = [&](std::size_t k) {
        return lo + (hi - lo) * static_cast<double>(k) / static_cast<double>(kFine);
      };
      property.requested[b] = law.cdf(edge(b + 1)) - law.cdf(edge(b));
    }
  };
  const LengthLaw& length = options.traits.length;
  if (length.kind == LengthLaw::Kind::constant || !(length.max_m > length.min_m)) {
    // One size: all of it in the one bin that holds it.
    length_.lo = 0;
    length_.hi = 2 * length.mean_m;
    length_.add(length_.requested, length.mean_m * (1 + 1e-6), 1);
  } else {
    from_law(length_, source.length_law(), length.min_m, length.max_m);
  }
  from_law(inclination_, source.inclination_law(), 0, std::numbers::pi / 2);
}

void LeafDrift::add_candidates(const std::vector<Candidate>& candidates) {
  for (const Candidate& c : candidates) {
    const Piece& piece = wood_.pieces[c.piece];
    for (std::size_t k = 0; k < kPlaces; ++k) places_[k].add(places_[k].candidates, piece.place[k], 1);
    length_.add(length_.candidates, c.length_m * (1 + 1e-6), 1);
    inclination_.add(inclination_.candidates, c.inclination, 1);
    candidates_ += 1;
  }
}

void LeafDrift::add_leaf(const Leaf& leaf, std::uint32_t piece) {
  const double area = unit_area_[leaf.shape] * leaf.length_m * leaf.length_m;
  for (std::size_t k = 0; k < kPlaces; ++k)
    places_[k].add(places_[k].achieved, wood_.pieces[piece].place[k], area);
  length_.add(length_.achieved, leaf.length_m * (1 + 1e-6), 1);
  inclination_.add(inclination_.achieved, std::acos(std::clamp(std::abs(leaf.normal.z()), 0.0, 1.0)), 1);
  leaves_ += 1;
  area_ += area;
  area_squares_ += area * area;
}

LeafDistribution LeafDrift::describe(const std::string& name, const std::string& unit,
                                     const Property& p) const {
  LeafDistribution d;
  d.name = name;
  d.unit = unit;
  for (std::size_t k = 0; k <= kShown; ++k)
    d.edges.push_back(p.lo + (p.hi - p.lo) * static_cast<double>(k) / static_cast<double>(kShown));
  const auto shown = [](const Histogram& fine) {
    const double total = std::accumulate(fine.begin(), fine.end(), 0.0);
    std::vector<double> coarse(kShown, 0);
    for (std::size_t k = 0; k < kFine; ++k)
      if (total > 0) coarse[k * kShown / kFine] += fine[k] / total;
    return coarse;
  };
  d.requested = shown(p.requested);
  d.candidates = shown(p.candidates);
  d.achieved = shown(p.achieved);
  const auto all = [](const Histogram& h) { return std::vector<double>(h.begin(), h.end()); };
  const bool by_area = &p != &length_ && &p != &inclination_;
  const double effective = by_area && area_squares_ > 0 ? area_ * area_ / area_squares_ : leaves_;
  d.before = kolmogorov_smirnov_binned(all(p.requested), all(p.candidates), candidates_);
  d.after = kolmogorov_smirnov_binned(all(p.requested), all(p.achieved), effective);
  return d;
}

std::vector<LeafDistribution> LeafDrift::report(const Foliage& foliage) const {
  std::vector<LeafDistribution> out;
  if (foliage.leaves.empty()) return out;
  const auto in_units = [](Property p, double scale) {
    p.lo *= scale;
    p.hi *= scale;
    return p;
  };
  const std::array<const char*, kPlaces> units = {"m", "1", "deg", "m", "1", "m"};
  for (std::size_t k = 0; k < kPlaces; ++k)
    out.push_back(describe(kPlaceNames[k], units[k], in_units(places_[k], k == 2 ? 360 : wood_.scale[k])));
  out.push_back(describe("length", "m", length_));
  LeafDistribution inclination = describe("inclination", "deg", inclination_);
  for (double& edge : inclination.edges) edge *= 180 / std::numbers::pi;
  out.push_back(inclination);
  return out;
}

}  // namespace dendrofit
