// SPDX-License-Identifier: GPL-3.0-or-later
// Leaves that might be: where on which twig, how large, how steep; and the poses each may try.
#pragma once

#include "core/foliage.h"
#include "core/random.h"
#include "core/tree.h"
#include "forward/leaves/bearing.h"
#include "forward/leaves/insert_leaves.h"

#include <cstdint>
#include <vector>

namespace dendrofit {

struct Candidate {
  std::int32_t node = 0;
  std::uint16_t shape = 0;
  std::uint16_t bin = 0;  ///< height bin of the budget
  float t = 0;            ///< along the cylinder
  float turn = 0;         ///< about the cylinder from its reference side, radians
  float length_m = 0;
  float inclination = 0;     ///< radians
  std::uint32_t number = 0;  ///< its key, with the round's
  std::uint32_t piece = 0;   ///< of the bearing wood
};

/// A bijection of {0, ..., n-1} drawn by a key (a Feistel network, walked until it lands inside).
class Shuffle {
 public:
  Shuffle(std::uint64_t n, Random key);
  std::uint64_t operator()(std::uint64_t i) const;

 private:
  std::uint64_t n_;
  int half_bits_;
  std::uint64_t keys_[4];
};

/// Everything about the leaves to be that does not depend on other leaves.
class CandidateSource {
 public:
  CandidateSource(const Tree& tree, const LeafOptions& options, const BearingWood& wood);

  /// The first round: `count` leaves in phyllotactic order along the axes.
  std::vector<Candidate> in_order(std::size_t count, int threads) const;
  /// A later round: `count` leaves at random places; bin_weight scales the share of each height bin,
  /// node_weight of each cylinder within it.
  std::vector<Candidate> at_random(std::size_t count, int round, const std::vector<double>& bin_weight,
                                   const std::vector<double>& node_weight) const;

  static constexpr int kPoses = 12;
  /// Pose 0 is as drawn; the others in an order of the candidate's own. False where this pose does not exist.
  bool pose(const Candidate& candidate, int round, int k, Leaf& leaf) const;

  double mean_area_m2() const { return mean_area_; }
  double area_m2(const Candidate& c) const { return unit_area_[c.shape] * c.length_m * c.length_m; }
  double reach_m() const { return reach_; }              ///< of any vertex from foot(), in any pose
  double half_extent_m() const { return half_extent_; }  ///< of any leaf's box
  std::size_t bins() const { return kBins; }
  std::size_t bin_of(const Piece& piece) const;
  const TabulatedLaw& inclination_law() const { return inclination_; }
  const TabulatedLaw& length_law() const { return length_; }
  /// Where it was drawn, on the cylinder's axis.
  Vec3 foot(const Candidate& candidate) const;
  /// Of this leaf's vertices from foot(), in any pose (metres).
  double reach_of(const Candidate& candidate) const;

 private:
  static constexpr std::size_t kBins = 20;
  void draw_traits(std::uint64_t i, std::uint64_t n, int round, const Shuffle shuffles[3],
                   Candidate& c) const;
  void place(double u, const std::vector<double>& cumulative, Candidate& c) const;
  Vec3 side_of(std::size_t node) const;

  const Tree& tree_;
  const LeafOptions& options_;
  const BearingWood& wood_;
  TabulatedLaw inclination_;
  TabulatedLaw length_;
  TabulatedLaw azimuth_;    // about its mean, in turns
  std::vector<Vec3> side_;  // reference side of every cylinder, carried along its axis
  std::vector<char> axis_end_;
  std::vector<double> shape_share_;  // cumulative
  std::vector<double> unit_area_;
  double mean_area_ = 0;
  double reach_ = 0;
  double half_extent_ = 0;
  std::vector<double> blade_reach_;
};

}  // namespace dendrofit
