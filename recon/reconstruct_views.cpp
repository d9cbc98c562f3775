// SPDX-License-Identifier: GPL-3.0-or-later
#include "recon/reconstruct_views.h"

#include "core/errors.h"
#include "core/tree_topology.h"
#include "recon/image/agreement.h"
#include "recon/image/foot.h"
#include "recon/image/poses.h"
#include "recon/image/redundancy.h"
#include "recon/image/settle.h"
#include "recon/image/tips.h"
#include "recon/image/view_checks.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace dendrofit {
namespace {

constexpr double kMaskTolerance = 0.7;              // pixels: half a pixel, and some blur
constexpr std::array<double, 2> kLooser{1.3, 3.3};  // pixels more
constexpr int kRefinements = 2;                     // with new carving
constexpr int kAdjustments = 4;                     // of tree and poses in turn, without
constexpr double kReachPx = 4;         // how far beside an axis its stretch of mask is looked for
constexpr double kGoodShare = 0.92;    // of each mask explained: the poses need no refinement
constexpr double kMuchLost = 0.05;     // of the masks, by a tight carving
constexpr double kWorthwhile = 0.005;  // more of the masks explained: refined poses are kept

/// What the reconstruction works on: the views in use.
struct Work {
  std::vector<std::size_t> of;  // index into the set
  std::vector<Camera> cameras;
  std::vector<Outline> outlines;
  void drop(std::size_t view) {
    const auto at = static_cast<std::ptrdiff_t>(view);
    of.erase(of.begin() + at);
    cameras.erase(cameras.begin() + at);
    outlines.erase(outlines.begin() + at);
  }
};

/// The tree in the frame of the cameras.
Tree in_frame_of(const Tree& tree, const Vec3& origin_shift) {
  Tree moved = tree;
  const Vec3 by = tree.origin_shift - origin_shift;
  for (std::size_t i = 0; i < tree.size(); ++i) {
    moved.start[i] += by;
    moved.end[i] += by;
  }
  moved.origin_shift = origin_shift;
  return moved;
}

/// The hull's skin above the ground.
PointCloud surface_of(const Hull& hull, const Work& work, const Vec3& origin_shift) {
  if (hull.cells.empty())
    throw SolverError("no place lies inside all masks: the poses or the masks do not belong together");
  PointCloud cloud;
  cloud.origin_shift = origin_shift;
  const std::optional<MaskFoot> foot = foot_of_masks(work.cameras, work.outlines);
  for (const Vec3& cell : hull.cells)
    if (!foot || cell.z() >= foot->position.z()) cloud.points.push_back(cell);
  return cloud;
}

/// The surface's tree. It is wood all over: masks hold no leaves.
Reconstruction tree_of(const PointCloud& surface, const ViewsOptions& options, Progress& progress) {
  ReconstructOptions wood = options.cloud;
  wood.leaves_possible = false;
  return reconstruct(surface, wood, progress);
}

/// Views that look at a tree from few sides need all of them to agree.
int least_support(std::size_t views) {
  return static_cast<int>(std::min<std::size_t>(3, views));
}

/// Tree and poses in turn, until both fit the masks.
std::vector<Camera> adjust(Tree tree, const Work& work, const ViewsOptions& options, Progress& progress) {
  std::vector<Camera> cameras = work.cameras;
  double reach = 2 * kReachPx;
  for (int k = 0; k < kAdjustments; ++k) {
    centre_on_views(tree,
                    sight_cylinders(tree, cameras, work.outlines, reach, options.cloud.threads, progress));
    const Sightings seen =
        sight_cylinders(tree, cameras, work.outlines, reach, options.cloud.threads, progress);
    cameras = refine_poses(tree, seen, cameras, {.threads = options.cloud.threads});
    reach = kReachPx;
  }
  return cameras;
}

/// Leaves out the views that contradict the others, and says so.
bool drop_odd_views(Work& work, const ViewSet& set, const CarveOptions& carving, ViewsReconstruction& result,
                    Progress& progress) {
  const std::vector<OddView> odd = find_odd_views(work.cameras, work.outlines, carving, progress);
  for (auto one = odd.rbegin(); one != odd.rend(); ++one) {
    const std::size_t view = work.of[one->view];
    result.views[view].used = false;
    result.views[view].explained_share = one->explained;
    result.model.warnings.push_back(odd_view_warning(set, view, one->explained, one->missing));
    work.drop(one->view);
  }
  return !odd.empty();
}

/// Carves with the poses as told. Where the masks are not explained well, leaves out views that contradict
/// the others, refines the poses on the tree of a looser carving, and keeps what explains more of the masks.
Agreement settle_poses(Work& work, const ViewSet& set, const ViewsOptions& options,
                       const CarveOptions& carving, ViewsReconstruction& result, Progress& progress) {
  Agreement best = agreement(work.cameras, work.outlines, carving, progress);
  if (best.least() >= kGoodShare) return best;
  if (drop_odd_views(work, set, carving, result, progress))
    best = agreement(work.cameras, work.outlines, carving, progress);
  if (best.least() >= kGoodShare || !options.refine_poses) return best;
  Agreement loose = best;
  for (const double looser : kLooser) {
    if (loose.mean() >= kGoodShare) break;
    CarveOptions wider = carving;
    wider.tolerance_px += looser;  // only starts the refinement: coarse cells do
    wider.most_coarse_cells = wider.most_cells;
    loose = agreement(work.cameras, work.outlines, wider, progress);
  }
  for (int round = 0; round < kRefinements && !loose.hull.cells.empty(); ++round) {
    const Reconstruction rough = tree_of(surface_of(loose.hull, work, set.origin_shift), options, progress);
    Work tried = work;
    tried.cameras = adjust(in_frame_of(rough.tree, set.origin_shift), work, options, progress);
    Agreement now = agreement(tried.cameras, tried.outlines, carving, progress);
    if (now.mean() <= best.mean() + kWorthwhile) break;
    work.cameras = tried.cameras;
    result.poses_refined = true;
    best = now;
    loose = std::move(now);
    if (best.least() >= kGoodShare) break;
  }
  // A fatter hull is worth it only where the tight one loses much.
  return loose.mean() > best.mean() + kMuchLost ? loose : best;
}

/// Drops what too few views support, and settles axes and radii on the pictures.
Tree settle_on_views(Tree tree, const Work& work, const ViewsOptions& options, ViewsReconstruction& result,
                     Progress& progress) {
  const auto sight = [&](double reach) {
    return sight_cylinders(tree, work.cameras, work.outlines, reach, options.cloud.threads, progress);
  };
  const std::size_t carved = tree.size();
  for (int round = 0; round < 2; ++round) {
    tree = subset(tree, supported(tree, sight(kReachPx), least_support(work.cameras.size())));
    tree = subset(tree, needed_by_views(tree, work.cameras, options.cloud.threads));
    assign_axes_by_thickness(tree);
    if (round == 0) result.shadows = carved - tree.size();
    centre_on_views(tree, sight(kReachPx));
    settle_radii_from_views(tree, sight(0.5 * kReachPx));
    if (round == 0) extend_tips(tree, work.cameras, work.outlines, options.cloud.threads);
  }
  extend_tips(tree, work.cameras, work.outlines, options.cloud.threads);
  assign_axes_by_thickness(tree);
  return tree;
}

}  // namespace

void ViewsOptions::validate() const {
  cloud.validate();
  if (pose_error_px)
    require(std::isfinite(*pose_error_px) && *pose_error_px >= 0 && *pose_error_px <= 50, "pose_error_px",
            *pose_error_px, "must lie between 0 and 50 pixels");
}

ViewsReconstruction reconstruct_views(const ViewSet& set, const ViewsOptions& options, Progress& progress) {
  options.validate();
  check_views(set);
  ViewsReconstruction result;
  result.model.warnings = set.warnings;
  Work work;
  for (std::size_t v = 0; v < set.views.size(); ++v) {
    work.of.push_back(v);
    work.cameras.push_back(set.views[v].camera);
    work.outlines.push_back(outline_of(set.views[v], result.model.warnings));
    result.views.push_back({.name = set.views[v].photo.name});
    result.cameras.push_back(set.views[v].camera);
  }
  check_depth(work.cameras, work.outlines);
  warn_of_borders(set, work.outlines, result.model.warnings);

  const double pose_error = options.pose_error_px.value_or(set.pose_error_px.value_or(0));
  const CarveOptions carving{.cell_m = carving_cell_m(work.cameras, work.outlines),
                             .tolerance_px = kMaskTolerance + 2 * pose_error,
                             .threads = options.cloud.threads};
  const Agreement agreed = settle_poses(work, set, options, carving, result, progress);
  if (!agreed.good()) result.model.warnings.push_back(disagreement_warning(set, work.of, agreed.shares));
  result.tolerance_px = agreed.tolerance_px;
  result.cell_m = agreed.hull.cell_m;
  if (result.cell_m > 3 * carving.cell_m) result.model.warnings.push_back(coarse_warning(result.cell_m));

  result.surface = surface_of(agreed.hull, work, set.origin_shift);
  Reconstruction carved = tree_of(result.surface, options, progress);
  Tree tree = settle_on_views(in_frame_of(carved.tree, set.origin_shift), work, options, result, progress);

  const Sightings seen =
      sight_cylinders(tree, work.cameras, work.outlines, kReachPx, options.cloud.threads, progress);
  const std::vector<double> offsets = median_offsets_px(seen, work.cameras.size());
  const std::vector<double> covered =
      covered_shares(tree, work.cameras, work.outlines, options.cloud.threads);
  for (std::size_t k = 0; k < work.of.size(); ++k) {
    ViewQuality& quality = result.views[work.of[k]];
    quality.explained_share = agreed.shares[k];
    quality.offset_px = offsets[k];
    quality.covered_share = covered[k];
    result.cameras[work.of[k]] = work.cameras[k];
  }
  std::vector<std::string> warnings = std::move(result.model.warnings);
  result.model = std::move(carved);
  result.model.tree = std::move(tree);
  result.model.warnings = std::move(warnings);
  measure_from_views(result.model, work.cameras, options.cloud.dbh_height_m);
  return result;
}

}  // namespace dendrofit
