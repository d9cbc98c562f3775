// SPDX-License-Identifier: GPL-3.0-or-later
#include "forward/leaves/placement.h"

#include "core/parallel.h"
#include "forward/leaves/leaf_drift.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace dendrofit {
namespace {

constexpr std::size_t kFewLeft = 512;    // from here on one by one, to stop right at the target
constexpr double kFullBelow = 0.1;       // a bin that takes fewer of its candidates is full
constexpr std::size_t kJudgeAfter = 64;  // candidates
constexpr int kMostRounds = 300;

struct Placed {
  std::uint64_t block;
  std::uint64_t priority;
  std::uint32_t index;
};

}  // namespace

Placement::Placement(const Tree& tree, const LeafOptions& options, const BearingWood& wood,
                     const CandidateSource& source, bool by_count)
    : tree_(tree),
      options_(options),
      wood_(wood),
      source_(source),
      by_count_(by_count),
      wood_index_(tree, std::max(0.02, source.reach_m())),
      leaf_index_(source.reach_m(), source.half_extent_m(), tree.start.front()),
      ground_z_(options.on_ground ? options.ground_z_m.value_or(wood.foot_z)
                                  : -std::numeric_limits<double>::infinity()),
      tried_(tree.size(), 0),
      placed_(tree.size(), 0),
      bins_(source.bins()) {
  for (const LeafShapeShare& s : options.traits.shapes) unit_area_.push_back(s.shape.unit_area());
}

double Placement::value(const Leaf& leaf) const {
  return by_count_ ? 1 : unit_area_[leaf.shape] * leaf.length_m * leaf.length_m;
}

/// More leaves than this have never fitted: twelve layers of a strip two leaves wide along all bearing wood.
double Placement::capacity() const {
  const double strip = 2 * options_.traits.length.mean_m * wood_.length_m;
  return std::max(1000.0, 12 * strip / mean_area_m2());
}

Placement::Refusal Placement::check(const Scratch& scratch, Tally& tally, LeafBody& other) const {
  const LeafBody& body = scratch.body;
  const double gap = options_.clearance_m;
  if (body.lo.z() < ground_z_ + gap) return Refusal::ground;
  const Vec3 centre = 0.5 * (body.lo + body.hi);
  const double half = 0.5 * (body.hi - body.lo).norm();
  for (const std::int32_t w : scratch.wood) {
    const SolidCylinder& c = wood_index_.cylinder(w);
    const double touch = half + c.radius + gap;
    if (distance2_to_segment(centre, c.base, c.axis, c.length) > touch * touch) continue;
    ++tally.wood;
    if (!cylinder_clear(body, c, gap)) return Refusal::wood;
  }
  const bool free = leaf_index_.each_near(body.lo, body.hi, gap, [&](std::uint32_t slot) {
    const Leaf& leaf = leaves_[slot];
    ++tally.leaf_pairs;
    other.set(leaf, options_.traits.shapes[leaf.shape].shape);
    return leaves_clear(body, other, gap);
  });
  return free ? Refusal::none : Refusal::leaf;
}

bool Placement::try_candidate(const Candidate& c, std::uint32_t slot, Scratch& scratch, Tally& tally) {
  wood_index_.near(source_.foot(c), source_.reach_of(c) + options_.clearance_m, scratch.wood);
  Leaf leaf;
  for (int k = 0; k < CandidateSource::kPoses; ++k) {
    if (!source_.pose(c, round_, k, leaf)) continue;
    ++tally.poses;
    scratch.body.set(leaf, options_.traits.shapes[leaf.shape].shape);
    switch (check(scratch, tally, scratch.other)) {
      case Refusal::none:
        leaves_[slot] = leaf;
        leaf_index_.insert(slot, scratch.body.lo, scratch.body.hi);
        return true;
      case Refusal::wood:
        ++tally.refused[c.bin][0];
        break;
      case Refusal::leaf:
        ++tally.refused[c.bin][1];
        break;
      case Refusal::ground:
        ++tally.refused[c.bin][2];
        break;
    }
  }
  return false;
}

void Placement::assign_slots(std::size_t count) {
  slots_.clear();
  while (slots_.size() < count && !free_.empty()) {
    slots_.push_back(free_.back());
    free_.pop_back();
  }
  const std::size_t more = count - slots_.size();
  for (std::size_t k = 0; k < more; ++k) slots_.push_back(static_cast<std::uint32_t>(leaves_.size() + k));
  leaves_.resize(leaves_.size() + more);
  piece_.resize(leaves_.size());
  along_.resize(leaves_.size());
  leaf_index_.resize(leaves_.size());
}

void Placement::account(const Candidate& c, std::uint32_t slot, bool placed) {
  BinState& bin = bins_[c.bin];
  ++counters_.candidates;
  ++bin.tried;
  ++bin.tried_lately;
  ++tried_[static_cast<std::size_t>(c.node)];
  if (!placed) {
    free_.push_back(slot);
    return;
  }
  ++bin.placed;
  ++bin.placed_lately;
  ++placed_[static_cast<std::size_t>(c.node)];
  piece_[slot] = c.piece;
  along_[slot] = c.t;
  const double worth = value(leaves_[slot]);
  have_ += worth;
  bin.have += worth;
  bin.area_m2 += unit_area_[leaves_[slot].shape] * leaves_[slot].length_m * leaves_[slot].length_m;
}

void Placement::merge(const Tally& tally) {
  counters_.poses += tally.poses;
  counters_.leaf_pairs += tally.leaf_pairs;
  counters_.wood += tally.wood;
  for (std::size_t b = 0; b < bins_.size(); ++b) {
    bins_[b].by_wood += tally.refused[b][0];
    bins_[b].by_leaf += tally.refused[b][1];
    bins_[b].by_ground += tally.refused[b][2];
  }
}

void Placement::run_round(const std::vector<Candidate>& round, Progress& progress) {
  assign_slots(round.size());
  std::vector<Vec3> feet(round.size());
  std::vector<Placed> order(round.size());
  const Random root = Random(options_.seed).child({0x6f72646572, static_cast<std::uint64_t>(round_)});
  for (std::size_t i = 0; i < round.size(); ++i) {
    feet[i] = source_.foot(round[i]);
    order[i] = {leaf_index_.block_of(feet[i]), root.child({i}).bits(), static_cast<std::uint32_t>(i)};
  }
  leaf_index_.prepare(feet);
  feet = {};
  std::sort(order.begin(), order.end(), [](const Placed& a, const Placed& b) {
    if (a.block != b.block) return a.block < b.block;
    return a.priority != b.priority ? a.priority < b.priority : a.index < b.index;
  });
  // Blocks of one colour never meet: all of a colour at once, colour after colour.
  std::array<std::vector<std::pair<std::size_t, std::size_t>>, 8> blocks;
  for (std::size_t k = 0; k < order.size();) {
    std::size_t end = k;
    while (end < order.size() && order[end].block == order[k].block) ++end;
    blocks[static_cast<std::size_t>(leaf_index_.colour_of(order[k].block))].emplace_back(k, end);
    k = end;
  }
  std::vector<char> placed(round.size(), 0);
  for (const auto& colour : blocks) {
    std::vector<Tally> tallies(colour.size());
    parallel_blocks(colour.size(), 1, options_.threads, [&](std::size_t first, std::size_t last) {
      Scratch scratch;
      for (std::size_t b = first; b < last; ++b) {
        progress.check();
        tallies[b].refused.resize(bins_.size(), {0, 0, 0});
        for (std::size_t k = colour[b].first; k < colour[b].second; ++k) {
          const std::uint32_t i = order[k].index;
          placed[i] = try_candidate(round[i], slots_[i], scratch, tallies[b]);
        }
        progress.advance(static_cast<double>(colour[b].second - colour[b].first));
      }
    });
    for (const Tally& tally : tallies) merge(tally);
  }
  for (std::size_t i = 0; i < round.size(); ++i) account(round[i], slots_[i], placed[i] != 0);
}

void Placement::run_last(const std::vector<Candidate>& round, double target) {
  assign_slots(round.size());
  std::vector<Vec3> feet;
  feet.reserve(round.size());
  for (const Candidate& c : round) feet.push_back(source_.foot(c));
  leaf_index_.prepare(feet);
  Scratch scratch;
  Tally tally;
  tally.refused.resize(bins_.size(), {0, 0, 0});
  const double half_a_leaf = by_count_ ? 0.5 : 0.5 * mean_area_m2();
  for (std::size_t i = 0; i < round.size(); ++i) {
    const bool wanted = target - have_ > half_a_leaf;
    if (wanted)
      account(round[i], slots_[i], try_candidate(round[i], slots_[i], scratch, tally));
    else
      free_.push_back(slots_[i]);
  }
  merge(tally);
}

/// What each height bin lacks; once the bins that lack something are full, the rest goes to those that are
/// not.
bool Placement::weigh_bins(std::vector<double>& weight) const {
  weight.assign(bins_.size(), 0);
  const double leaf = by_count_ ? 1 : mean_area_m2();
  double sum = 0;
  for (std::size_t b = 0; b < bins_.size(); ++b)
    if (!bins_[b].full) sum += weight[b] = std::max(0.0, bins_[b].wanted - bins_[b].have);
  if (sum > 0.5 * leaf) return true;
  sum = 0;
  for (std::size_t b = 0; b < bins_.size(); ++b)
    if (!bins_[b].full) sum += weight[b] = bins_[b].wanted;
  return sum > 0;
}

std::size_t Placement::next_count(double remaining) const {
  const double leaf = by_count_ ? 1 : mean_area_m2();
  const double count = std::max(1.0, std::floor(remaining / leaf + 1e-9));
  const double most = round_ == 0 ? capacity() : std::max(1000.0, 0.25 * capacity());
  return static_cast<std::size_t>(std::min(count, most));
}

void Placement::fill(double target, Progress& progress) {
  for (const Piece& p : wood_.pieces) bins_[source_.bin_of(p)].wanted += p.share * target;
  const double half_a_leaf = by_count_ ? 0.5 : 0.5 * mean_area_m2();
  progress.begin("leaves", by_count_ ? target : target / mean_area_m2(), "leaves");
  std::vector<double> bin_weight, node_weight(tree_.size(), 1);
  while (target - have_ > half_a_leaf) {
    progress.check();
    if (round_ >= kMostRounds) {
      stopped_because_ = "stopped after " + std::to_string(kMostRounds) + " rounds";
      break;
    }
    const std::size_t count = next_count(target - have_);
    if (round_ == 0) {
      first_ = source_.in_order(count, options_.threads);
      if (!by_count_) {
        // Sizes are drawn: leave out leaves, evenly spread, until the drawn sum does not pass the target.
        double sum = 0;
        for (const Candidate& c : first_) sum += source_.area_m2(c);
        const Shuffle evenly(count, Random(options_.seed).child({0x6c656176}));
        std::vector<char> drop(count, 0);
        for (std::size_t k = 0; k < count && sum > target + half_a_leaf; ++k) {
          const auto i = static_cast<std::size_t>(evenly(k));
          drop[i] = 1;
          sum -= source_.area_m2(first_[i]);
        }
        std::size_t i = 0;
        std::erase_if(first_, [&](const Candidate&) { return drop[i++] != 0; });
      }
      run_round(first_, progress);
    } else {
      if (!weigh_bins(bin_weight)) {
        stopped_because_ = "no more leaves fit";
        break;
      }
      for (std::size_t i = 0; i < node_weight.size(); ++i)
        node_weight[i] = (placed_[i] + 1.0) / (tried_[i] + 1.0);
      if (count > kFewLeft)
        run_round(source_.at_random(count, round_, bin_weight, node_weight), progress);
      else
        run_last(source_.at_random(8 * count + 64, round_, bin_weight, node_weight), target);
    }
    for (BinState& bin : bins_)
      if (bin.tried_lately >= kJudgeAfter) {
        bin.full =
            static_cast<double>(bin.placed_lately) < kFullBelow * static_cast<double>(bin.tried_lately);
        bin.tried_lately = bin.placed_lately = 0;
      }
    ++round_;
  }
  progress.end();
}

std::vector<Leaf> Placement::take_leaves(LeafDrift& drift) {
  std::vector<std::uint32_t> order;
  for (std::size_t s = 0; s < leaves_.size(); ++s)
    if (leaves_[s].length_m > 0) order.push_back(static_cast<std::uint32_t>(s));
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    if (leaves_[a].node != leaves_[b].node) return leaves_[a].node < leaves_[b].node;
    return along_[a] != along_[b] ? along_[a] < along_[b] : a < b;
  });
  std::vector<Leaf> leaves;
  leaves.reserve(order.size());
  for (const std::uint32_t s : order) {
    leaves.push_back(leaves_[s]);
    drift.add_leaf(leaves_[s], piece_[s]);
  }
  leaves_ = {};
  return leaves;
}

}  // namespace dendrofit
