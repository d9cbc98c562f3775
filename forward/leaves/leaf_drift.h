// SPDX-License-Identifier: GPL-3.0-or-later
// How far refusals and other poses moved the leaves' distributions from those requested.
#pragma once

#include "forward/leaves/candidates.h"
#include "forward/leaves/leaf_report.h"

#include <array>
#include <vector>

namespace dendrofit {

class LeafDrift {
 public:
  LeafDrift(const BearingWood& wood, const CandidateSource& source, const LeafOptions& options);

  void add_candidates(const std::vector<Candidate>& candidates);
  void add_leaf(const Leaf& leaf, std::uint32_t piece);
  std::vector<LeafDistribution> report(const Foliage& foliage) const;

  static constexpr std::size_t kFine = 100;  ///< bins compared
  static constexpr std::size_t kShown = 20;  ///< bins reported

 private:
  using Histogram = std::array<double, kFine>;
  struct Property {
    double lo = 0, hi = 1;
    Histogram requested{}, candidates{}, achieved{};
    void add(Histogram& histogram, double x, double weight) const;
  };
  LeafDistribution describe(const std::string& name, const std::string& unit, const Property& property) const;

  const BearingWood& wood_;
  std::vector<double> unit_area_;
  std::array<Property, kPlaces> places_;  ///< weighted by leaf area
  Property length_, inclination_;         ///< by leaves
  double candidates_ = 0, leaves_ = 0, area_ = 0, area_squares_ = 0;
};

}  // namespace dendrofit
