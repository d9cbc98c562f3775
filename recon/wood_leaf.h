// SPDX-License-Identifier: GPL-3.0-or-later
// Wood and leaves told apart, without training, by the paths that lead through them.
#pragma once

#include "core/progress.h"
#include "core/types.h"
#include "recon/foot.h"
#include "recon/graph.h"
#include "recon/preprocess.h"

#include <cstdint>
#include <vector>

namespace dendrofit {

struct WoodLeafOptions {
  double window_m = 0.1;  ///< a path's straightness is judged this far both ways; longer than most leaves
  double shortest_wood_m = 0.2;  ///< wood bears at least this much way beyond it
  /// Above this share of points in leaf-like places the tree bears leaves. Of 48 virtual leaf-off scans all
  /// but one (a failed one, with a point every 9 cm) had 0.07 at most, of 19 leaf-on scans all 0.23 and more.
  double leaf_on_share = 0.20;
  /// In between (a pine with its needles has 0.13, a sparse leaf-off scan 0.14) the paths decide: below this
  /// share of straight ones among those that bear something the tree bears leaves.
  double doubtful_share = 0.10;
  double straight_share = 0.82;
  void validate() const;
};

struct WoodLeaf {
  bool leaves_present = false;  ///< a verdict on the whole scan
  double leafy_share = 0;       ///< what it rests on: the share of points that are away from every path that
                                ///< bears anything, and whose neighbours form no line
  double straight_share = 1;    ///< and the share of straight paths among those that bear something
  std::vector<char> leaf;       ///< 1 for a leaf point; all 0 on a leaf-off scan
};

/// Shortest paths from everywhere to the foot gather on the wood (Vicari et al. 2019, TLSeparation) and run
/// straight there. Where a path bears `shortest_wood_m` and is about as straight as those on the tree's own
/// trunk, it lies on wood, and so does all of it down to the foot. Points about such a path are wood, out to
/// a distance that grows with what hangs on it, because thick wood carries its paths on one side. All other
/// reached points are leaves, unless the scan has none.
WoodLeaf separate_leaves(const std::vector<Vec3>& points, const PointGraph& graph, const Paths& paths,
                         const WoodLeafOptions& options = {}, Progress& = no_progress());

/// Leaves only the wood that the paths reach in the scan, and the feet's points with their new numbers.
/// Returns the raw points (CleanScan::source) of what was taken out as leaves.
std::vector<std::uint32_t> take_out_leaves(CleanScan& scan, const Paths& paths, const WoodLeaf& verdict,
                                           std::vector<Foot>& feet);

}  // namespace dendrofit
