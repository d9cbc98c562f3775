// SPDX-License-Identifier: GPL-3.0-or-later
#include "forward/igm/shoots.h"

#include "core/random.h"
#include "forward/igm/markers.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <Eigen/Geometry>

namespace dendrofit::igm {
namespace {

constexpr double kPi = std::numbers::pi;
// Distances in internodes: markers nearer than the first are taken, those within the second pull.
constexpr double kNear = 2, kFar = 4;
constexpr double kMarkerCell = 4;                    // of the grid that finds them
constexpr double kConeCosine = 0.86602540378443865;  // 30 degrees
constexpr double kTrunkTurn = 135 * kPi / 180;       // from one trunk lateral to the next
constexpr double kLowest = 2;                        // internodes above the root: laterals go no lower

// What random draws are for; part of their key.
enum Draw : std::uint64_t { kOrder, kMarkers, kFirstSide, kTreeOrder };

Random draws(std::uint64_t seed, int tree, int cycle, std::uint32_t id, Draw purpose) {
  return Random(seed).child(
      {static_cast<std::uint64_t>(tree), static_cast<std::uint64_t>(cycle), id, purpose});
}

Vec3 unit(const Vec3& v) {
  const double norm = v.norm();
  return norm > 0 ? Vec3(v / norm) : Vec3::UnitZ();
}

Vec3 from_angles(double polar, double azimuth) {
  return {std::sin(polar) * std::cos(azimuth), std::sin(polar) * std::sin(azimuth), std::cos(polar)};
}

class Shooting {
 public:
  Shooting(Stand& stand, int cycle, const Obstacles& obstacles, const std::vector<ShadeProfile>& profiles,
           std::uint64_t seed)
      : stand_(stand), cycle_(cycle), obstacles_(obstacles), profiles_(profiles), seed_(seed) {}

  void scatter(const std::vector<Sprout>& sprouts, LightField& light);
  void grow(const Sprout& sprout);

 private:
  Vec3 lateral_heading(std::size_t node);
  void shoot(const Sprout& sprout, bool extend);

  Stand& stand_;
  int cycle_;
  const Obstacles& obstacles_;
  const std::vector<ShadeProfile>& profiles_;
  std::uint64_t seed_;
  MarkerField markers_;
};

// 150 - 4 (T+1) points a sprouting node, fewer where a tree would exceed its total; in the half ball about
// the node's direction, between 2 and cap + 4 internodes away. Polar angles are uniform, denser about the
// axis than directions uniform on the half ball, as in the authors' program: the latter leave trees of cycle
// 20 at 7.06 +- 0.28 m (6 seeds) where theirs reach 7.5 to 8.3.
void Shooting::scatter(const std::vector<Sprout>& sprouts, LightField& light) {
  std::vector<double> sprouting(stand_.parameters.size(), 0), cap;
  for (const IgmParameters& p : stand_.parameters) cap.push_back(p.cap(cycle_));
  const auto tree_of = [&](const Sprout& s) {
    return static_cast<std::size_t>(
        stand_.tree_of_axis(static_cast<std::size_t>(stand_.nodes.axis[static_cast<std::size_t>(s.node)])));
  };
  for (const Sprout& sprout : sprouts) sprouting[tree_of(sprout)] += 1;

  std::vector<Vec3> position;
  std::vector<Voxel> voxel;
  double cell = 0;
  for (const Sprout& sprout : sprouts) {
    const std::size_t tree = tree_of(sprout);
    const IgmParameters& p = stand_.parameters[tree];
    cell = std::max(cell, kMarkerCell * p.rho_m);
    const auto i = static_cast<std::size_t>(sprout.node);
    Random random = draws(seed_, static_cast<int>(tree), cycle_, stand_.nodes.id[i], kMarkers);
    const double fair = std::min(std::max(150.0 - 4.0 * (cycle_ + 1), 10.0), p.max_markers / sprouting[tree]);
    const int count = static_cast<int>(fair + random.uniform());
    const Vec3 ahead = unit(stand_.internode(i));
    const Vec3 side = ahead.unitOrthogonal(), up = ahead.cross(side);
    for (int m = 0; m < count; ++m) {
      const double polar = random.uniform(0, kPi / 2), turn = random.uniform(0, 2 * kPi);
      const Vec3 direction =
          std::cos(polar) * ahead + std::sin(polar) * (std::cos(turn) * side + std::sin(turn) * up);
      const Vec3 at =
          stand_.nodes.position[i] + p.rho_m * random.uniform(kNear, cap[tree] + kFar) * direction;
      const Voxel v = stand_.frame.at(at);
      if (v.z < 0 || obstacles_.solid(v)) continue;
      position.push_back(at);
      voxel.push_back(v);
    }
  }
  std::vector<Fixed> shade(voxel.size());
  light.read(voxel, shade);
  if (!obstacles_.empty())
    for (std::size_t m = 0; m < voxel.size(); ++m) shade[m] += obstacles_.shade(voxel[m]);
  markers_ = MarkerField(position, shade, stand_.frame, cell > 0 ? cell : 1.0);
}

// Phyllotaxis and branching angle, from the authors' program.
Vec3 Shooting::lateral_heading(std::size_t node) {
  const auto axis = static_cast<std::size_t>(stand_.nodes.axis[node]);
  const Vec3 along = unit(stand_.internode(node));
  const double polar = std::acos(std::clamp(along.z(), -1.0, 1.0));
  if (stand_.axes.order[axis] == 1) {
    Plant& plant = stand_.plants[static_cast<std::size_t>(stand_.axes.plant[axis])];
    const double azimuth = kTrunkTurn * ++plant.trunk_laterals;
    return from_angles(polar + stand_.parameters_of_axis(axis).branch_angle_deg * kPi / 180, azimuth);
  }
  const bool first_left =
      draws(seed_, stand_.tree_of_axis(axis), 0, stand_.axes.id[axis], kFirstSide).uniform() < 0.5;
  const double side = (stand_.axes.sides[axis]++ % 2 == 0) == first_left ? 1 : -1;
  const double azimuth = std::atan2(along.y(), along.x()) + side * std::atan2(1.0, std::sin(polar));
  return from_angles(std::sin(polar) < 1e-6 ? polar + kPi / 4 : polar, azimuth);
}

void Shooting::shoot(const Sprout& sprout, bool extend) {
  const auto start = static_cast<std::size_t>(sprout.node);
  const std::int32_t bearer = stand_.nodes.axis[start];
  const auto bearing_axis = static_cast<std::size_t>(bearer);
  const std::int32_t plant = stand_.axes.plant[bearing_axis];
  const int tree = stand_.plants[static_cast<std::size_t>(plant)].tree;
  const IgmParameters& p = stand_.parameters[static_cast<std::size_t>(tree)];
  const ShadeProfile& profile = profiles_[static_cast<std::size_t>(tree)];
  const int order = stand_.axes.order[bearing_axis] + (extend ? 0 : 1);
  const bool lateral = order > 1;
  const double v = p.stretch_by_node ? sprout.share * sprout.shoots : sprout.share;
  const double step = p.stretch_internodes ? p.rho_m * v / std::floor(v) : p.rho_m;
  const double lowest = stand_.plants[static_cast<std::size_t>(plant)].root.z() + kLowest * p.rho_m;
  const double pipe = std::pow(p.tip_radius_m, p.pipe_exponent);
  // Vt = -z / (Tend + 6 - T): droops later and later.
  const Vec3 tropism = Vec3(0, 0, -1.0 / std::max(1, p.schedule_cycles + 6 - cycle_));

  Vec3 heading = extend ? unit(stand_.internode(start)) : lateral_heading(start);
  Vec3 at = stand_.nodes.position[start];
  std::int32_t axis = extend ? bearer : -1;
  const std::size_t first_new = stand_.nodes.size();
  for (int step_count = 0; step_count < sprout.internodes; ++step_count) {
    Vec3 optimal;
    if (!markers_.pull(at, heading, kNear * p.rho_m, kFar * p.rho_m, kConeCosine, optimal)) break;
    Vec3 direction = heading + p.mu * optimal;
    if (lateral) direction += (cycle_ < p.late_cycle ? p.gamma : p.gamma_late) * tropism;
    Vec3 move = step * unit(direction);
    const double floor = std::min(lowest, at.z());
    if (lateral && at.z() + move.z() < floor) {  // along the ground, not into it
      const double flat = std::hypot(move.x(), move.y()), drop = floor - at.z();
      if (flat < 1e-6 * step) break;
      const double stretch = std::sqrt(step * step - drop * drop) / flat;
      move = Vec3(move.x() * stretch, move.y() * stretch, drop);
    }
    if (obstacles_.blocks(at, at + move)) break;
    at += move;
    if (axis < 0) axis = stand_.add_axis(sprout.node, plant, order);
    stand_.add_node(axis, at, cycle_, pipe);
    heading = move / step;
  }
  if (!obstacles_.empty())
    for (std::size_t i = first_new; i < stand_.nodes.size(); ++i)
      stand_.nodes.obstacle_shade[i] = obstacles_.shade(stand_.nodes.voxel[i]);
  markers_.cast(std::span(stand_.nodes.voxel).subspan(first_new), profile);
}

void Shooting::grow(const Sprout& sprout) {
  const bool tip = stand_.is_tip(static_cast<std::size_t>(sprout.node));
  for (int s = 0; s < sprout.shoots; ++s) shoot(sprout, tip && s == 0);
}

}  // namespace

void grow_shoots(Stand& stand, const std::vector<Sprout>& sprouts, int cycle, LightField& light,
                 const Obstacles& obstacles, const std::vector<ShadeProfile>& profiles, std::uint64_t seed,
                 Progress& progress) {
  Shooting shooting(stand, cycle, obstacles, profiles, seed);
  shooting.scatter(sprouts, light);

  struct Turn {
    std::uint64_t tree, node;
    std::size_t sprout;
  };
  std::vector<Turn> turns;
  turns.reserve(sprouts.size());
  for (std::size_t s = 0; s < sprouts.size(); ++s) {
    const auto node = static_cast<std::size_t>(sprouts[s].node);
    const int tree = stand.tree_of_axis(static_cast<std::size_t>(stand.nodes.axis[node]));
    turns.push_back({draws(seed, tree, cycle, 0, kTreeOrder).bits(),
                     draws(seed, tree, cycle, stand.nodes.id[node], kOrder).bits(), s});
  }
  std::sort(turns.begin(), turns.end(), [](const Turn& a, const Turn& b) {
    return a.tree != b.tree ? a.tree < b.tree : a.node != b.node ? a.node < b.node : a.sprout < b.sprout;
  });
  for (std::size_t t = 0; t < turns.size(); ++t) {
    if (t % 256 == 0) progress.check();
    shooting.grow(sprouts[turns[t].sprout]);
  }
}

}  // namespace dendrofit::igm
