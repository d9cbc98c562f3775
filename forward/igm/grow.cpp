// SPDX-License-Identifier: GPL-3.0-or-later
#include "forward/igm/grow.h"

#include "core/errors.h"
#include "core/tree_topology.h"
#include "forward/environment/light_field.h"
#include "forward/igm/allocate.h"
#include "forward/igm/record.h"
#include "forward/igm/shed.h"
#include "forward/igm/shoots.h"
#include "forward/igm/stand.h"
#include "forward/igm/start.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <sstream>

namespace dendrofit {
namespace {

using namespace igm;

constexpr int kMostCycles = 1000;
constexpr int kFirstShedding = 4;                     // cycle
constexpr int kShedPasses = 5, kLastShedPasses = 10;  // the authors' program

std::string tree_name(std::size_t i) {
  return "tree " + std::to_string(i + 1);
}

// What stands on a root must be in the open for so many internodes; of a mesh all but the first one, which
// may stand in the voxels of a ground surface.
void check_root(const Vec3& root, double rho_m, int internodes, const Solids& solids,
                const Obstacles& obstacles, const VoxelFrame& frame, const std::string& name) {
  const auto refuse = [&](const std::string& body) {
    std::ostringstream message;
    message << name << " root (" << root.x() << ", " << root.y() << ", " << root.z()
            << "): " << (internodes > 0 ? "its seedling" : "it") << " stands in " << body
            << "; move the root or the obstacle";
    throw InputError(message.str());
  };
  const Vec3 tip = root + Vec3(0, 0, internodes * rho_m);
  for (std::size_t i = 0; i < solids.boxes.size(); ++i) {
    const SolidBox& box = solids.boxes[i];
    if ((tip.array() > box.min.array()).all() && (root.array() < box.max.array()).all())
      refuse("box " + std::to_string(i + 1));
  }
  for (std::size_t i = 0; i < solids.half_spaces.size(); ++i)
    for (const Vec3& at : {root, tip})
      if ((at - solids.half_spaces[i].point).dot(solids.half_spaces[i].normal) < -1e-9)
        refuse("halfspace " + std::to_string(i + 1));
  if (solids.meshes.empty()) return;
  for (Voxel v = frame.at(root + Vec3(0, 0, rho_m)); v.z <= frame.at(tip).z; ++v.z)
    if (obstacles.solid(v)) refuse("an obstacle");
}

// The state of the whole simulation between cycles.
struct Simulation {
  Stand stand;
  Obstacles obstacles;
  LightField light;
  int cycle = 0;  // the last one done

  std::vector<ShadeProfile> profiles_of(int at_cycle) const {
    std::vector<ShadeProfile> profiles;
    for (const IgmParameters& p : stand.parameters) profiles.emplace_back(p.shading_base(at_cycle));
    return profiles;
  }
  void cast_nodes(std::size_t from, int sign, const std::vector<char>* only_axes = nullptr);
  void read_light(std::size_t known);
  void shed(int passes, std::vector<std::int64_t>& count);
};

// Shadows of the nodes from `from` on (of the flagged axes), each with the b of its birth.
void Simulation::cast_nodes(std::size_t from, int sign, const std::vector<char>* only_axes) {
  std::map<double, std::vector<Voxel>> by_base;
  for (std::size_t i = from; i < stand.nodes.size(); ++i) {
    const auto axis = static_cast<std::size_t>(stand.nodes.axis[i]);
    if (only_axes && !(*only_axes)[axis]) continue;
    by_base[stand.parameters_of_axis(axis).shading_base(stand.nodes.birth[i])].push_back(
        stand.nodes.voxel[i]);
  }
  for (const auto& [b, voxels] : by_base) light.cast(voxels, ShadeProfile(b), sign);
}

// Brings shade up to date; the first `known` nodes have that of the last time.
void Simulation::read_light(std::size_t known) {
  for (std::size_t i = 0; i < known; ++i) stand.nodes.shade[i] -= stand.nodes.obstacle_shade[i];
  light.update(stand.nodes.voxel, stand.nodes.shade, known);
  for (std::size_t i = 0; i < stand.nodes.size(); ++i) stand.nodes.shade[i] += stand.nodes.obstacle_shade[i];
}

void Simulation::shed(int passes, std::vector<std::int64_t>& count) {
  const std::vector<char> dropped = shed_axes(stand, passes, count);
  if (std::find(dropped.begin(), dropped.end(), 1) == dropped.end()) return;
  const bool restore = std::any_of(stand.parameters.begin(), stand.parameters.end(),
                                   [](const IgmParameters& p) { return p.restore_light; });
  if (restore) {
    std::vector<char> given_back(dropped.size());
    for (std::size_t axis = 0; axis < dropped.size(); ++axis)
      given_back[axis] = dropped[axis] && stand.parameters_of_axis(axis).restore_light;
    cast_nodes(0, -1, &given_back);
  }
  stand.drop(dropped);
  stand.index_axes();
  if (restore) read_light(stand.nodes.size());
}

Simulation begin(const IgmParameters& parameters, const IgmSite& site, const IgmOptions& options) {
  Simulation sim{{}, {}, LightField(options.max_memory_gib), 0};
  Stand& stand = sim.stand;
  std::vector<IgmTreeSite> trees = site.trees;
  if (trees.empty()) trees.push_back({{Vec3::Zero()}, std::nullopt});
  for (const IgmTreeSite& tree : trees) stand.parameters.push_back(tree.parameters.value_or(parameters));

  const Vec3 start_shift =
      options.start ? Vec3(options.start->origin_shift - site.origin_shift) : Vec3::Zero();
  std::vector<Vec3> roots;
  for (std::size_t t = 0; t < trees.size(); ++t) {
    if (t == 0 && options.start) {
      for (std::size_t i = 0; i < options.start->size(); ++i)
        if (options.start->parent[i] < 0) roots.push_back(options.start->start[i] + start_shift);
    } else {
      roots.insert(roots.end(), trees[t].roots.begin(), trees[t].roots.end());
    }
  }
  // Voxels of half an internode, one of them centred on the first root; layer 0 holds the lowest root.
  stand.frame.origin = roots.empty() ? Vec3(Vec3::Zero()) : roots.front();
  stand.frame.edge_m = 1e300;
  for (const Vec3& root : roots) stand.frame.origin.z() = std::min(stand.frame.origin.z(), root.z());
  for (const IgmParameters& p : stand.parameters)
    stand.frame.edge_m = std::min(stand.frame.edge_m, p.rho_m / 2);
  sim.obstacles = Obstacles(site.solids, stand.frame, site.origin_shift);

  for (std::size_t t = 0; t < trees.size(); ++t) {
    const int tree = static_cast<int>(t);
    if (t == 0 && options.start) {
      sim.cycle = plant_tree(stand, tree, *options.start, start_shift, options.start_cycle);
      for (const Plant& plant : stand.plants)
        check_root(plant.root, stand.parameters[t].rho_m, 0, site.solids, sim.obstacles, stand.frame,
                   tree_name(t));
      continue;
    }
    for (const Vec3& root : trees[t].roots) {
      check_root(root, stand.parameters[t].rho_m, kSeedlingInternodes, site.solids, sim.obstacles,
                 stand.frame, tree_name(t));
      plant_seedling(stand, tree, root, sim.cycle);
    }
  }
  for (const Vec3& root : roots) sim.light.darken(stand.frame.at(root), kFullLight);
  if (!sim.obstacles.empty())
    for (std::size_t i = 0; i < stand.nodes.size(); ++i)
      stand.nodes.obstacle_shade[i] = sim.obstacles.shade(stand.nodes.voxel[i]);
  sim.cast_nodes(0, 1);
  thicken(stand);
  sim.read_light(0);
  stand.index_axes();
  return sim;
}

// Whether a later cycle may allow what this one does not: some tree's cap is still rising.
bool cap_rises(const Stand& stand, int cycle) {
  return std::any_of(stand.parameters.begin(), stand.parameters.end(),
                     [&](const IgmParameters& p) { return p.cap(cycle + 1) > p.cap(cycle); });
}

// Two stems cannot share a foot.
void check_roots_apart(const std::vector<IgmTreeSite>& trees) {
  std::map<std::array<double, 3>, std::string> taken;
  for (std::size_t t = 0; t < trees.size(); ++t)
    for (const Vec3& root : trees[t].roots) {
      const auto [place, is_new] = taken.emplace(std::array{root.x(), root.y(), root.z()}, tree_name(t));
      if (is_new) continue;
      std::ostringstream message;
      message << tree_name(t) << " root (" << root.x() << ", " << root.y() << ", " << root.z()
              << "): a stem of " << place->second << " stands there already; move one of them";
      throw InputError(message.str());
    }
}

}  // namespace

void IgmSite::validate() const {
  if (!origin_shift.allFinite()) throw InputError("origin_shift: not a finite number");
  for (std::size_t t = 0; t < trees.size(); ++t) {
    if (trees[t].roots.empty()) throw InputError(tree_name(t) + ": no root; give at least one position");
    for (const Vec3& root : trees[t].roots)
      if (!root.allFinite()) throw InputError(tree_name(t) + " root: a coordinate is not a finite number");
    if (trees[t].parameters) trees[t].parameters->validate();
  }
  check_roots_apart(trees);
  solids.validate();
}

void IgmOptions::validate() const {
  require(max_memory_gib > 0, "max_memory_gib", max_memory_gib, "must be positive");
  if (start_cycle) require(*start_cycle >= 0, "start_cycle", *start_cycle, "must not be negative");
}

IgmGrowth grow_igm(const IgmParameters& parameters, const IgmSite& site, const IgmOptions& options,
                   Progress& progress) {
  parameters.validate();
  site.validate();
  options.validate();

  Simulation sim = begin(parameters, site, options);
  Stand& stand = sim.stand;
  IgmGrowth growth;
  growth.last_cycle = sim.cycle;
  std::vector<std::int64_t> shed(stand.parameters.size(), 0);
  record(stand, sim.cycle, shed, growth.series);

  int last = 0;
  for (const IgmParameters& p : stand.parameters) last = std::max(last, p.cycles);
  if (options.until_stop) last = kMostCycles;
  growth.stop_reason = sim.cycle > last ? "it was past cycle " + std::to_string(last) + " already"
                                        : "reached cycle " + std::to_string(last);
  progress.begin("growing", options.until_stop ? 0 : std::max(0, last - sim.cycle), "cycles");
  bool stopped = false;
  while (sim.cycle < last && !stopped) {
    const int T = ++sim.cycle;
    progress.check();
    const Decision decision = decide(stand, T);
    const std::size_t old_nodes = stand.nodes.size();
    if (!decision.sprouts.empty())
      grow_shoots(stand, decision.sprouts, T, sim.light, sim.obstacles, sim.profiles_of(T), options.seed,
                  progress);
    if (stand.nodes.size() > old_nodes) {
      growth.last_cycle = T;
    } else if (!(decision.held_by_cap && cap_rises(stand, T))) {
      stopped = true;
      growth.stop_reason = decision.sprouts.empty() && decision.held_by_cap
                               ? "the growth equation allows no further internode"
                           : decision.sprouts.empty() ? "no bud gets enough light"
                                                      : "no bud finds free space in the light";
    }
    sim.cast_nodes(old_nodes, 1);
    thicken(stand);
    sim.read_light(old_nodes);
    stand.index_axes();
    std::fill(shed.begin(), shed.end(), 0);
    if (T >= kFirstShedding) sim.shed(stopped || T == last ? kLastShedPasses : kShedPasses, shed);
    record(stand, T, shed, growth.series);
    if (options.on_cycle) {
      std::vector<std::int32_t> owners;
      options.on_cycle(T, to_tree(stand, site.origin_shift, owners));
    }
    progress.advance(1);
  }
  progress.end();
  growth.tree = to_tree(stand, site.origin_shift, growth.tree_of_axis);
  return growth;
}

Tree tree_of(const IgmGrowth& growth, int tree) {
  std::vector<char> keep(growth.tree.size());
  for (std::size_t i = 0; i < keep.size(); ++i)
    keep[i] = growth.tree_of_axis[static_cast<std::size_t>(growth.tree.axis[i])] == tree;
  return subset(growth.tree, keep);
}

}  // namespace dendrofit
