// SPDX-License-Identifier: GPL-3.0-or-later
// The integrated growth model: trees that grow cycle by cycle under a growth equation, sharing light and
// space (Yi et al. 2018, Computer Graphics Forum 37; gaps filled from the authors' published program).
#pragma once

#include "core/progress.h"
#include "core/tree.h"
#include "forward/environment/obstacles.h"
#include "forward/igm/parameters.h"

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace dendrofit {

/// One tree of a stand: its stems' feet, and its own parameters where it differs from the others.
struct IgmTreeSite {
  std::vector<Vec3> roots;  ///< several: a shrub, one pool of resource each
  std::optional<IgmParameters> parameters;
};

/// Where trees grow. Without trees, one tree at the origin. The ground is the height of the lowest root.
struct IgmSite {
  Vec3 origin_shift = Vec3::Zero();  ///< world = origin_shift + local
  std::vector<IgmTreeSite> trees;
  Solids solids;

  /// Throws InputError naming tree, field, value and limit.
  void validate() const;
};

/// One row of growth.csv: one tree after one cycle.
struct GrowthRecord {
  int cycle = 0;
  double height_m = 0;               ///< highest node above the tree's lowest foot
  std::optional<double> dbh_m;       ///< stem diameter at 1.3 m, of the thickest stem
  int stem_internodes = 0;           ///< on the longest trunk
  std::int64_t internodes = 0;       ///< living
  std::int64_t axes = 0;             ///< living, trunks included
  std::int64_t living_buds = 0;      ///< nodes that may still sprout
  std::int64_t shed_internodes = 0;  ///< dropped in this cycle
  double light_mean = 0;             ///< mean light l over living nodes, 0..1
  double length_m = 0;
  double volume_m3 = 0;
  int tree = 0;  ///< which of the site's trees
};

struct IgmOptions {
  std::uint64_t seed = 1;
  /// Past the parameters' `cycles`, until nothing sprouts any more (at most 1,000 cycles).
  bool until_stop = false;
  /// Goes on from this tree (grown or scanned; its world frame is the site's, origin_shift included). Its
  /// stems take the place of the first tree's roots.
  std::optional<Tree> start;
  /// The cycle `start` is at; none: its largest birth_cycle, or where unknown the age at which the growth
  /// equation has its height.
  std::optional<int> start_cycle;
  /// Called after every cycle with the trees so far, when set.
  std::function<void(int cycle, const Tree& tree)> on_cycle;
  double max_memory_gib = 16;  ///< of the light field

  void validate() const;
};

/// A grown stand. `tree` holds every tree, stems as roots in the order of the site.
struct IgmGrowth {
  Tree tree;
  std::vector<std::int32_t> tree_of_axis;  ///< which of the site's trees each axis belongs to
  std::vector<GrowthRecord> series;        ///< cycle by cycle (cycle 0 first), within it tree by tree
  int last_cycle = 0;                      ///< the last cycle in which wood was added
  std::string stop_reason;
};

/// Throws InputError from the validate() of parameters, site and options, for a root inside a solid, or for
/// trees too far apart to share a light field. Same parameters, site and seed: the same tree.
IgmGrowth grow_igm(const IgmParameters& parameters, const IgmSite& site = {}, const IgmOptions& options = {},
                   Progress& progress = no_progress());

/// The nodes of one of the stand's trees.
Tree tree_of(const IgmGrowth& growth, int tree);

}  // namespace dendrofit
