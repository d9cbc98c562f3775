// SPDX-License-Identifier: GPL-3.0-or-later
#include "forward/leaves/candidates.h"

#include "core/parallel.h"
#include "core/tree_topology.h"
#include "forward/leaves/clearance.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include <Eigen/Geometry>

namespace dendrofit {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kSlide = 0.35;  // blade lengths
enum Stream : std::uint64_t { kPlace = 1, kPose, kTurn, kShuffleLength, kShuffleAngle, kShuffleShape };

double radians(double degrees) {
  return degrees * kPi / 180;
}

Vec3 rotated(const Vec3& v, const Vec3& about, double angle) {
  return Eigen::AngleAxisd(angle, about) * v;
}

/// Change of a pose against the one drawn.
struct Change {
  double turn = 0;    ///< of petiole and blade about the twig
  double yaw = 0;     ///< of the blade about its normal
  double swing = 0;   ///< of blade and petiole about the vertical
  double slide = 0;   ///< along the cylinder, in blade lengths
  double roll = 0;    ///< of the blade about its midrib
  double pitch = 0;   ///< of the blade about its across axis
  double shrink = 1;  ///< of its length, kept above the law's lower end
};

/// Those that leave the inclination alone come first, those that change the size last.
constexpr std::array<Change, CandidateSource::kPoses> kChanges = {Change{},
                                                                  {.yaw = 0.6},
                                                                  {.yaw = -0.6},
                                                                  {.slide = kSlide},
                                                                  {.slide = -kSlide},
                                                                  {.turn = 0.9},
                                                                  {.turn = -0.9},
                                                                  {.swing = 0.8},
                                                                  {.pitch = 0.45},
                                                                  {.roll = 0.5},
                                                                  {.yaw = 0.4, .shrink = 0.8},
                                                                  {.turn = 0.5, .shrink = 0.65}};

LengthLaw::Kind kind_of(const LengthLaw& law) {
  return law.max_m > law.min_m ? law.kind : LengthLaw::Kind::constant;
}

TabulatedLaw tabulated(const LengthLaw& law) {
  if (kind_of(law) == LengthLaw::Kind::constant)
    return TabulatedLaw(law.mean_m, law.mean_m, [](double) { return 1.0; });
  return TabulatedLaw(law.min_m, law.max_m, [&](double x) { return law.density(x); });
}

}  // namespace

Shuffle::Shuffle(std::uint64_t n, Random key) : n_(n), half_bits_(1) {
  while ((std::uint64_t{1} << (2 * half_bits_)) < n) ++half_bits_;
  for (std::uint64_t& k : keys_) k = key.bits();
}

std::uint64_t Shuffle::operator()(std::uint64_t i) const {
  const std::uint64_t mask = (std::uint64_t{1} << half_bits_) - 1;
  do {
    std::uint64_t left = i >> half_bits_, right = i & mask;
    for (const std::uint64_t key : keys_) {
      std::uint64_t z = (right + 1) * 0x9e3779b97f4a7c15ULL ^ key;
      z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ULL;
      z ^= z >> 29;
      const std::uint64_t mixed = left ^ (z & mask);
      left = right;
      right = mixed;
    }
    i = (left << half_bits_) | right;
  } while (i >= n_);
  return i;
}

CandidateSource::CandidateSource(const Tree& tree, const LeafOptions& options, const BearingWood& wood)
    : tree_(tree),
      options_(options),
      wood_(wood),
      inclination_(options.traits.inclination),
      length_(tabulated(options.traits.length)),
      azimuth_(UnitDistribution::von_mises(0.5, options.traits.azimuth.kind == AzimuthLaw::Kind::uniform
                                                    ? 0
                                                    : options.traits.azimuth.concentration)) {
  const LeafTraits& traits = options.traits;
  double shares = 0;
  for (const LeafShapeShare& s : traits.shapes) {
    shape_share_.push_back(shares += s.share);
    unit_area_.push_back(s.shape.unit_area());
    blade_reach_.push_back(BodyPlan(s.shape).reach);
  }
  for (double& s : shape_share_) s /= shares;
  mean_area_ = traits.mean_leaf_area_m2();
  const bool constant = kind_of(traits.length) == LengthLaw::Kind::constant;
  Candidate longest;
  longest.length_m = static_cast<float>(constant ? traits.length.mean_m : traits.length.max_m) * 1.0001f;
  for (std::size_t k = 0; k < traits.shapes.size(); ++k) {
    longest.shape = static_cast<std::uint16_t>(k);
    // Two points of a leaf are at most as far apart as two of its blade, or petiole and blade in one line.
    const double line = traits.petiole_max_m + blade_reach_[k] * longest.length_m;
    half_extent_ =
        std::max({half_extent_, 0.5 * line, 0.5 * BodyPlan(traits.shapes[k].shape).width * longest.length_m});
    reach_ = std::max(reach_, reach_of(longest) + wood.radius_m);
  }
  half_extent_ += 1e-3;

  const std::vector<Axis> axes = axes_of(tree);
  side_.resize(tree.size());
  axis_end_.assign(tree.size(), 0);
  for (std::size_t a = 0; a < axes.size(); ++a) {
    Vec3 side = Vec3::UnitX();
    bool first = true;
    for (const std::int32_t node : axes[a].nodes) {
      const auto i = static_cast<std::size_t>(node);
      const Vec3 along = tree.direction(i);
      const Vec3 level = along.cross(Vec3::UnitZ());
      if (traits.phyllotaxis.two_rows_level && level.norm() > 0.17) {
        // The same of the two level sides all along, however the axis bends.
        side = !first && level.dot(side) < 0 ? Vec3(-level.normalized()) : Vec3(level.normalized());
      } else if (first) {
        const double phase = Random(options.seed).child({kTurn, a}).uniform(0, 2 * kPi);
        side = rotated(along.unitOrthogonal(), along, phase);
      } else {
        const Vec3 carried = side - along * along.dot(side);
        side = carried.norm() > 1e-6 ? Vec3(carried.normalized()) : Vec3(along.unitOrthogonal());
      }
      first = false;
      side_[i] = side;
    }
    if (!axes[a].nodes.empty()) axis_end_[static_cast<std::size_t>(axes[a].nodes.back())] = 1;
  }
}

std::size_t CandidateSource::bin_of(const Piece& piece) const {
  return std::min(kBins - 1, static_cast<std::size_t>(piece.place[0] * static_cast<double>(kBins)));
}

void CandidateSource::draw_traits(std::uint64_t i, std::uint64_t n, int round, const Shuffle shuffles[3],
                                  Candidate& c) const {
  // Stratified: each n-th of a law is drawn from once, in shuffled order.
  Random draw = Random(options_.seed).child({kPlace, static_cast<std::uint64_t>(round), i});
  const auto stratum = [&](int k) {
    return std::min(1 - 1e-12,
                    (static_cast<double>(shuffles[k](i)) + draw.uniform()) / static_cast<double>(n));
  };
  c.length_m = static_cast<float>(length_.quantile(stratum(0)));
  c.inclination = static_cast<float>(inclination_.quantile(stratum(1)));
  const double u = stratum(2);
  c.shape = static_cast<std::uint16_t>(std::min<std::ptrdiff_t>(
      std::upper_bound(shape_share_.begin(), shape_share_.end(), u) - shape_share_.begin(),
      static_cast<std::ptrdiff_t>(shape_share_.size()) - 1));
  c.number = static_cast<std::uint32_t>(i);
}

void CandidateSource::place(double u, const std::vector<double>& cumulative, Candidate& c) const {
  const double at = u * cumulative.back();
  const auto found = std::upper_bound(cumulative.begin(), cumulative.end(), at);
  const std::size_t k = std::min(static_cast<std::size_t>(found - cumulative.begin()), cumulative.size() - 1);
  const double before = k ? cumulative[k - 1] : 0, share = cumulative[k] - before;
  const Piece& piece = wood_.pieces[k];
  const double within = share > 0 ? std::clamp((at - before) / share, 0.0, 1.0) : 0.5;
  c.node = piece.node;
  c.piece = static_cast<std::uint32_t>(k);
  c.t = static_cast<float>(piece.t0 + within * (piece.t1 - piece.t0));
  c.bin = static_cast<std::uint16_t>(bin_of(piece));
}

std::vector<Candidate> CandidateSource::in_order(std::size_t count, int threads) const {
  const Phyllotaxis& order = options_.traits.phyllotaxis;
  const auto per_node = static_cast<std::size_t>(order.leaves_per_node);
  const std::size_t nodes = (count + per_node - 1) / per_node;
  const Random root(options_.seed);
  const Shuffle shuffles[3] = {Shuffle(count, root.child({kShuffleLength})),
                               Shuffle(count, root.child({kShuffleAngle})),
                               Shuffle(count, root.child({kShuffleShape}))};
  std::vector<Candidate> out(count);
  parallel_blocks(count, 4096, threads, [&](std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i) {
      Candidate& c = out[i];
      draw_traits(i, count, 0, shuffles, c);
      const std::size_t node = i / per_node, member = i % per_node;
      const double jitter = 0.3 * (Random(options_.seed).child({kTurn, 0, node}).uniform() - 0.5);
      place((static_cast<double>(node) + 0.5 + jitter) / static_cast<double>(nodes), wood_.cumulative, c);
      Random turn = Random(options_.seed).child({kTurn, 1, i});
      // The turn runs on with the nodes, from cylinder to cylinder; each axis has a side of its own to start
      // from.
      const double angle = std::fmod(radians(order.divergence_deg) * static_cast<double>(node), 2 * kPi) +
                           2 * kPi * static_cast<double>(member) / static_cast<double>(per_node) +
                           radians(order.jitter_deg) * turn.normal();
      c.turn = static_cast<float>(angle);
    }
  });
  return out;
}

std::vector<Candidate> CandidateSource::at_random(std::size_t count, int round,
                                                  const std::vector<double>& bin_weight,
                                                  const std::vector<double>& node_weight) const {
  // Within its bin a piece keeps its share, scaled by how well its cylinder takes leaves.
  std::vector<double> in_bin(kBins, 0);
  for (const Piece& p : wood_.pieces)
    in_bin[bin_of(p)] += p.share * node_weight[static_cast<std::size_t>(p.node)];
  std::vector<double> cumulative(wood_.pieces.size());
  double sum = 0;
  for (std::size_t k = 0; k < wood_.pieces.size(); ++k) {
    const Piece& p = wood_.pieces[k];
    const std::size_t b = bin_of(p);
    if (in_bin[b] > 0)
      sum += bin_weight[b] * p.share * node_weight[static_cast<std::size_t>(p.node)] / in_bin[b];
    cumulative[k] = sum;
  }
  if (!(sum > 0)) return {};
  const auto key = static_cast<std::uint64_t>(round);
  const Random root = Random(options_.seed).child({kShuffleShape, key});
  const Shuffle shuffles[3] = {Shuffle(count, root.child({1})), Shuffle(count, root.child({2})),
                               Shuffle(count, root.child({3}))};
  const Shuffle places(count, root.child({4}));
  std::vector<Candidate> out(count);
  for (std::size_t i = 0; i < count; ++i) {
    draw_traits(i, count, round, shuffles, out[i]);
    Random turn = Random(options_.seed).child({kTurn, 2, key, i});
    place((static_cast<double>(places(i)) + turn.uniform()) / static_cast<double>(count), cumulative, out[i]);
    out[i].turn = static_cast<float>(turn.uniform(0, 2 * kPi));
  }
  return out;
}

Vec3 CandidateSource::foot(const Candidate& c) const {
  const auto i = static_cast<std::size_t>(c.node);
  return tree_.start[i] + static_cast<double>(c.t) * (tree_.end[i] - tree_.start[i]);
}

double CandidateSource::reach_of(const Candidate& c) const {
  const double radius = tree_.radius.empty() ? 0 : tree_.radius[static_cast<std::size_t>(c.node)];
  // Out to the surface, along by the slide (or to the end's disc), off it by clearance and half a stalk's
  // width.
  const LeafShape& shape = options_.traits.shapes[c.shape].shape;
  return 1.5 * radius + 2 * options_.clearance_m + 1e-5 + options_.traits.petiole_max_m +
         c.length_m * (kSlide + shape.petiole_width + blade_reach_[c.shape]);
}

bool CandidateSource::pose(const Candidate& c, int round, int k, Leaf& leaf) const {
  const LeafTraits& traits = options_.traits;
  const auto i = static_cast<std::size_t>(c.node);
  const Vec3 along = tree_.direction(i);
  const double length = tree_.length(i), radius = tree_.radius[i];
  Random draw =
      Random(options_.seed)
          .child({kPose, static_cast<std::uint64_t>(c.node), static_cast<std::uint64_t>(round), c.number});

  // Drawn once a leaf, whatever the pose.
  const double petiole = draw.uniform(traits.petiole_min_m, traits.petiole_max_m);
  const double insertion = radians(traits.insertion_deg + traits.insertion_sd_deg * draw.normal());
  const double azimuth_offset = 2 * kPi * (azimuth_.quantile(draw.uniform()) - 0.5);
  const bool mirrored = draw.uniform() < 0.5;
  const double end_rho = std::sqrt(draw.uniform());

  Change change = kChanges[static_cast<std::size_t>(k)];
  if (mirrored) {
    for (double* angle : {&change.turn, &change.yaw, &change.swing, &change.roll, &change.pitch})
      *angle = -*angle;
    change.slide = -change.slide;
  }
  leaf.length_m = c.length_m;
  if (change.shrink < 1) {
    leaf.length_m = std::max(std::min<double>(c.length_m, traits.length.min_m), change.shrink * c.length_m);
    if (kind_of(traits.length) == LengthLaw::Kind::constant) leaf.length_m = c.length_m;
  }
  double t = c.t;
  if (change.slide != 0) {
    const double slid = std::clamp(t + change.slide * c.length_m / length, 0.0, 1.0);
    if (slid == t) return false;
    t = slid;
  }
  leaf.node = c.node;
  leaf.shape = c.shape;

  const Vec3 out = rotated(side_[i], along, static_cast<double>(c.turn) + change.turn);
  // Toward the tip of an axis leaves lean forward, the last along it.
  const double to_tip = wood_.axis_tip_m[i] + (1 - t) * length;
  const double forward = std::clamp(0.25 + to_tip / std::max(0.03, 0.5 * c.length_m), 0.0, 1.0);
  const double lean = std::clamp(insertion * forward, 0.0, kPi);
  Vec3 stalk = std::cos(lean) * along + std::sin(lean) * out;
  // Petioles turn up toward the light.
  const Vec3 risen = stalk + traits.petiole_rise * (Vec3::UnitZ() - stalk);
  if (risen.norm() > 0.05) stalk = risen.normalized();
  if (change.swing != 0) stalk = rotated(stalk, Vec3::UnitZ(), change.swing);

  // Azimuth of the upper side: outward from the twig unless the law says otherwise.
  double azimuth;  // clockwise from north
  if (traits.azimuth.kind == AzimuthLaw::Kind::towards)
    azimuth = radians(traits.azimuth.mean_deg);
  else
    azimuth = std::atan2(stalk.x(), stalk.y());
  azimuth += azimuth_offset;
  const double steep = c.inclination;
  Vec3 normal(std::sin(steep) * std::sin(azimuth), std::sin(steep) * std::cos(azimuth), std::cos(steep));
  if (change.swing != 0 && traits.azimuth.kind != AzimuthLaw::Kind::outward)
    normal = rotated(normal, Vec3::UnitZ(), change.swing);
  Vec3 direction = stalk - stalk.dot(normal) * normal;
  direction = direction.norm() > 0.05 ? Vec3(direction.normalized()) : Vec3(normal.unitOrthogonal());
  if (change.yaw != 0) direction = rotated(direction, normal, change.yaw);
  if (change.roll != 0) normal = rotated(normal, direction, change.roll);
  if (change.pitch != 0) {
    const Vec3 across = direction.cross(normal);
    direction = rotated(direction, across, change.pitch);
    normal = rotated(normal, across, change.pitch);
  }
  // Exactly perpendicular and of length 1 again.
  normal = (normal - normal.dot(direction) * direction).normalized();
  leaf.direction = direction;
  leaf.normal = normal;

  // The foot: off the surface by twice the clearance, and by what the stalk's own width would take back.
  const double half_width = 0.5 * options_.traits.shapes[c.shape].shape.petiole_width * leaf.length_m;
  if (axis_end_[i] && c.t > 1 - radius / (radius + 2 * length)) {
    // On the disc that ends an axis (Akerblom et al. 2018: by its share of the surface).
    if (stalk.dot(along) < 0.3) stalk = (stalk + (0.6 - stalk.dot(along)) * along).normalized();
    leaf.petiole_foot =
        tree_.end[i] + end_rho * radius * out + (2 * options_.clearance_m + half_width) * along;
  } else {
    const double across = std::abs(stalk.cross(normal).normalized().dot(out));
    const double off = 2 * options_.clearance_m + (std::isfinite(across) ? across : 1.0) * half_width;
    leaf.petiole_foot = tree_.start[i] + t * length * along + (radius + off) * out;
  }
  leaf.origin = leaf.petiole_foot + petiole * stalk;
  return true;
}

}  // namespace dendrofit
