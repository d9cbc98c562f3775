// SPDX-License-Identifier: GPL-3.0-or-later
// Puts candidates on the tree, round by round, until the target is met or nothing more fits.
#pragma once

#include "core/progress.h"
#include "core/tree.h"
#include "forward/leaves/bearing.h"
#include "forward/leaves/candidates.h"
#include "forward/leaves/clearance.h"
#include "forward/leaves/leaf_index.h"
#include "forward/leaves/wood_index.h"

#include <cstdint>
#include <string>
#include <vector>

namespace dendrofit {

class LeafDrift;

/// A height bin's account; `wanted` and `have` in the target's unit (square metres, or leaves).
struct BinState {
  double wanted = 0;
  double have = 0;
  double area_m2 = 0;
  std::size_t tried = 0, placed = 0;
  std::size_t by_wood = 0, by_leaf = 0, by_ground = 0;
  std::size_t tried_lately = 0, placed_lately = 0;
  bool full = false;
};

struct PlacementCounters {
  std::size_t candidates = 0, poses = 0, leaf_pairs = 0, wood = 0;
};

class Placement {
 public:
  Placement(const Tree& tree, const LeafOptions& options, const BearingWood& wood,
            const CandidateSource& source, bool by_count);

  /// Throws Cancelled.
  void fill(double target, Progress& progress);

  double have() const { return have_; }
  double mean_area_m2() const { return source_.mean_area_m2(); }
  int rounds() const { return round_; }
  const std::vector<BinState>& bins() const { return bins_; }
  const PlacementCounters& counters() const { return counters_; }
  const std::string& stopped_because() const { return stopped_because_; }
  /// Of the first round, before anything was refused.
  const std::vector<Candidate>& first_candidates() const { return first_; }
  /// The leaves, by cylinder and along it, told to `drift`; leaves this object without them.
  std::vector<Leaf> take_leaves(LeafDrift& drift);

 private:
  enum class Refusal : std::uint8_t { none, wood, leaf, ground };
  struct Scratch {
    LeafBody body, other;
    std::vector<std::int32_t> wood;
  };
  struct Tally {
    std::size_t poses = 0, leaf_pairs = 0, wood = 0;
    std::vector<std::array<std::uint32_t, 3>> refused;  // a bin: by wood, leaf, ground
  };

  bool try_candidate(const Candidate& c, std::uint32_t slot, Scratch& scratch, Tally& tally);
  Refusal check(const Scratch& scratch, Tally& tally, LeafBody& other) const;
  void run_round(const std::vector<Candidate>& round, Progress& progress);
  void run_last(const std::vector<Candidate>& round, double target);
  void assign_slots(std::size_t count);
  void account(const Candidate& c, std::uint32_t slot, bool placed);
  void merge(const Tally& tally);
  std::size_t next_count(double remaining) const;
  bool weigh_bins(std::vector<double>& weight) const;
  double value(const Leaf& leaf) const;
  double capacity() const;

  const Tree& tree_;
  const LeafOptions& options_;
  const BearingWood& wood_;
  const CandidateSource& source_;
  bool by_count_;
  WoodIndex wood_index_;
  LeafIndex leaf_index_;
  double ground_z_;
  std::vector<double> unit_area_;
  std::vector<Leaf> leaves_;          // by slot; length 0 where free
  std::vector<std::uint32_t> piece_;  // of the leaf in a slot
  std::vector<float> along_;          // where on its cylinder
  std::vector<std::uint32_t> free_, slots_;
  std::vector<std::uint32_t> tried_, placed_;  // by node
  std::vector<Candidate> first_;
  std::vector<BinState> bins_;
  PlacementCounters counters_;
  std::string stopped_because_;
  double have_ = 0;
  int round_ = 0;
};

}  // namespace dendrofit
