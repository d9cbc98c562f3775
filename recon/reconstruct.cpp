// SPDX-License-Identifier: GPL-3.0-or-later
#include "recon/reconstruct.h"

#include "core/errors.h"
#include "recon/align_scans.h"
#include "recon/build_tree.h"
#include "recon/crossings.h"
#include "recon/foot.h"
#include "recon/forks.h"
#include "recon/graph.h"
#include "recon/intervals.h"
#include "recon/mend.h"
#include "recon/preprocess.h"
#include "recon/radii.h"
#include "recon/scan_intervals.h"
#include "recon/sections.h"
#include "recon/side_shoots.h"
#include "recon/skeleton.h"
#include "recon/stems.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <ctime>
#include <iomanip>
#include <sstream>

#include <Eigen/Eigenvalues>

namespace dendrofit {
namespace {

/// Notes wall and processor time between its construction and the next mark.
class StageClock {
 public:
  explicit StageClock(std::vector<StageTime>& stages) : stages_(stages) { start(); }
  void mark(const char* stage) {
    const double wall = std::chrono::duration<double>(std::chrono::steady_clock::now() - wall_).count();
    stages_.push_back({stage, wall, static_cast<double>(std::clock() - cpu_) / CLOCKS_PER_SEC});
    start();
  }

 private:
  void start() {
    wall_ = std::chrono::steady_clock::now();
    cpu_ = std::clock();
  }
  std::vector<StageTime>& stages_;
  std::chrono::steady_clock::time_point wall_;
  std::clock_t cpu_ = 0;
};

/// Keeps the raw points `leaves` of the cloud as they are, and says so.
void set_leaves_aside(const PointCloud& cloud, const std::vector<std::uint32_t>& leaves, std::size_t reached,
                      Reconstruction& result) {
  std::vector<char> keep(cloud.size(), 0);
  for (const std::uint32_t i : leaves) keep[i] = 1;
  result.leaf_points = cloud.subset(keep);
  result.wood_share = 1 - static_cast<double>(leaves.size()) / static_cast<double>(reached);
  result.warnings.push_back(
      "the tree bears leaves: " + std::to_string(std::lround(100 * (1 - result.wood_share))) +
      " % of its points were set aside; twigs hidden in the foliage are missing");
}

/// Says that there are more stems than one, where there are.
void tell_of_stems(Reconstruction& result) {
  if (!result.other_trees.empty()) {
    std::ostringstream text;
    text << std::fixed << std::setprecision(1) << result.other_trees.size() + 1
         << " trees stand in this scan: the model is of the one at " << result.foot.x() << " "
         << result.foot.y() << "; " << result.other_points
         << " points went to its neighbours. Where crowns touch, the border is a guess. --tree-at takes "
            "another, such as "
         << result.other_trees.front().x() << ',' << result.other_trees.front().y();
    result.warnings.push_back(text.str());
  } else if (result.other_points > 0) {
    result.warnings.push_back(std::to_string(result.other_points) +
                              " points of something lower that stands beside the tree were left out");
  }
  if (result.stems > 1)
    result.warnings.push_back("the tree has " + std::to_string(result.stems) +
                              " stems from one stool; its DBH is that of the thickest");
}

/// Throws SolverError where all points lie on one line: nothing there has a surface.
void refuse_a_line(const std::vector<Vec3>& points) {
  constexpr double kThinnest_m = 0.002;  // root mean square distance from the line
  if (points.empty()) return;
  Vec3 mean = Vec3::Zero();
  for (const Vec3& p : points) mean += p / static_cast<double>(points.size());
  Eigen::Matrix3d square = Eigen::Matrix3d::Zero();
  for (const Vec3& p : points) square += (p - mean) * (p - mean).transpose();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(square / static_cast<double>(points.size()),
                                                            Eigen::EigenvaluesOnly);
  if (std::sqrt(std::max(0.0, axes.eigenvalues()[1])) < kThinnest_m && points.size() >= 20)
    throw SolverError(
        "all points lie on one line, wood has a surface: is this a cable, a single scan line, or a cloud "
        "with "
        "a column missing? Check the columns (--columns) and give the whole tree");
}

std::vector<Vec3> in_frame_of(const Tree& tree, const PointCloud& cloud) {
  std::vector<Vec3> points = cloud.points;
  for (Vec3& p : points) p += cloud.origin_shift - tree.origin_shift;
  return points;
}

}  // namespace

void ReconstructOptions::validate() const {
  require(std::isfinite(dbh_height_m) && dbh_height_m > 0, "dbh_height_m", dbh_height_m, "must be positive");
  PreprocessOptions{.voxel_size_m = voxel_size_m}.validate();
  GraphOptions{.neighbors = neighbors, .max_gap_m = max_gap_m, .threads = threads}.validate();
  SkeletonOptions{.shortest_limb_m = shortest_limb_m}.validate();
  RadiusOptions{.twig_diameter_m = twig_diameter_m}.validate();
}

Reconstruction reconstruct(const PointCloud& cloud, const ReconstructOptions& options, Progress& progress) {
  options.validate();
  Reconstruction result;
  StageClock clock(result.stages);
  const PreprocessOptions preprocess{.voxel_size_m = options.voxel_size_m};
  const GraphOptions graph_options{
      .neighbors = options.neighbors, .max_gap_m = options.max_gap_m, .threads = options.threads};

  CleanScan scan = clean_scan(cloud, preprocess, progress);
  result.raw_points = scan.raw_points;
  result.clean_points = scan.points.size();
  refuse_a_line(scan.points);
  clock.mark("clean");

  const Ground ground = find_ground(scan.points, preprocess);
  result.ground_found = ground.present;
  result.ground_points = remove_ground(scan, ground);
  clock.mark("ground");

  PointGraph graph = neighbor_graph(scan.points, graph_options, progress);
  result.spacing_m = graph.typical_spacing_m;
  clock.mark("neighbours");

  std::vector<char> open(scan.points.size(), 1);
  const std::vector<double> height = heights_above_foot(scan.points, connected_parts(graph, open), ground);
  const std::vector<Foot> feet = find_feet(scan.points, graph, height, ground);
  const std::vector<Stem> stems = tell_stems(scan.points, graph, height, feet);
  Stool tree_feet;
  for (const Stem& stem : stems) tree_feet.push_back(stem.foot);
  result.ground_points += close_low_vegetation(scan.points, graph, height, ground, tree_feet, open);
  clock.mark("foot");

  const Parts parts = connected_parts(graph, open);
  std::vector<Bridge> bridges = bridge_gaps(scan.points, graph, parts, graph_options, progress);
  clock.mark("gaps");

  if (stems.size() > 1 || options.tree_at) {
    std::optional<Eigen::Vector2d> at;
    if (options.tree_at) at = *options.tree_at - scan.origin_shift.head<2>();
    KeptTree kept = keep_tree(scan.points, graph, bridges, stems, at, scan.origin_shift, open, progress);
    tree_feet = std::move(kept.stool);
    for (const Foot& foot : kept.other_trees) result.other_trees.push_back(scan.origin_shift + foot.position);
    result.other_points = kept.other_points;
    if (kept.other_points > 0) {
      keep_points(scan, open, tree_feet);
      graph = neighbor_graph(scan.points, graph_options, progress);
      open.assign(scan.points.size(), 1);
      bridges = bridge_gaps(scan.points, graph, connected_parts(graph, open), graph_options, progress);
    }
    clock.mark("other trees");
  }
  result.foot = scan.origin_shift + tree_feet.front().position;
  result.stems = tree_feet.size();
  tell_of_stems(result);
  Paths paths = shortest_paths(scan.points, graph, bridges, open, ring_of(tree_feet), progress);
  clock.mark("paths");

  WoodLeaf verdict;
  if (options.leaves_possible) verdict = separate_leaves(scan.points, graph, paths, {}, progress);
  result.leaf_on = verdict.leaves_present;
  result.leafy_share = verdict.leafy_share;
  result.straight_share = verdict.straight_share;
  std::size_t unreached = 0;
  if (result.leaf_on) {
    unreached = scan.points.size() - paths.order.size();
    set_leaves_aside(cloud, take_out_leaves(scan, paths, verdict, tree_feet), paths.order.size(), result);
    graph = neighbor_graph(scan.points, graph_options, progress);
    open.assign(scan.points.size(), 1);
    bridges = bridge_gaps(scan.points, graph, connected_parts(graph, open), graph_options, progress);
    paths = shortest_paths(scan.points, graph, bridges, open, ring_of(tree_feet), progress);
  }
  clock.mark("wood and leaves");

  std::vector<Section> sections = cut_sections(scan.points, graph, paths, tree_feet, progress);
  clock.mark("sections");

  const std::vector<Bridge> mended =
      mend_cut_branches(scan.points, sections, graph.typical_spacing_m, options.max_gap_m);
  const std::vector<Gate> gates = gates_at_crossings(sections, graph.typical_spacing_m);
  if (!mended.empty() || !gates.empty()) {
    bridges.insert(bridges.end(), mended.begin(), mended.end());
    paths = shortest_paths(scan.points, graph, bridges, open, ring_of(tree_feet), progress, gates);
    sections = cut_sections(scan.points, graph, paths, tree_feet, progress);
  }
  result.tree_points = paths.order.size() + result.leaf_points.size();
  result.stray_points = unreached + scan.points.size() - paths.order.size();
  clock.mark("mending");

  const SkeletonOptions skeleton_options{.shortest_limb_m = options.shortest_limb_m};
  std::vector<Limb> limbs = make_limbs(scan.points, sections, graph.typical_spacing_m, skeleton_options);
  clock.mark("skeleton");

  const RadiusOptions radius_options{.twig_diameter_m = options.twig_diameter_m, .in_leaf = result.leaf_on};
  SightOptions seeing{.noise_m = std::clamp(0.25 * graph.typical_spacing_m, 0.001, 0.006),
                      .threads = options.threads};
  progress.begin("centre lines", 0, "limbs");
  Sights sights = look_at_limbs(scan.points, limbs, seeing, progress);
  seeing.noise_m = scan_noise(limbs, sights, seeing.noise_m, radius_options);
  centre_limbs(limbs, sights, seeing);
  result.scan_shifts = align_scans(scan.points, scan.source, limbs, seeing.noise_m);
  divide_long_stretches(scan.points, limbs, graph.typical_spacing_m);
  lead_limbs_back(scan.points, limbs, graph.typical_spacing_m);
  hand_over_points(scan.points, graph, limbs, seeing.noise_m);
  grow_side_shoots(scan.points, graph, paths, limbs, seeing.noise_m, skeleton_options);
  centre_limbs(limbs, look_at_limbs(scan.points, limbs, seeing, progress), seeing);
  const std::vector<char> changed = hand_over_points(scan.points, graph, limbs, seeing.noise_m);
  centre_limbs(limbs, look_at_some_limbs(scan.points, limbs, changed, seeing, progress), seeing);
  progress.end();
  clock.mark("centre lines");

  sights = look_at_limbs(scan.points, limbs, seeing, progress);
  result.noise_m = scan_noise(limbs, sights, seeing.noise_m, radius_options);
  settle_radii(limbs, sights, result.noise_m, radius_options);
  clock.mark("radii");

  result.tree = build_tree(limbs, tree_feet, scan.origin_shift);
  if (result.tree.empty()) throw SolverError("no wood could be followed from the stem's foot upwards");
  const std::vector<Vec3> foliage = in_frame_of(result.tree, result.leaf_points);
  result.metrics = measure(result.tree, MetricsOptions{.dbh_height_m = options.dbh_height_m}, foliage);
  result.metrics.wood_share = result.wood_share;
  result.metrics.leaf_profile = leaf_layers(foliage, tree_feet.front().position.z());
  if (result.leaf_on)
    result.metrics.height_m =
        height_in_leaf(result.metrics.height_m, foliage, tree_feet.front().position.z());
  seeing.noise_m = result.noise_m;
  SubsampleOptions halves{.seed = options.seed, .seeing = seeing, .radii = radius_options};
  std::optional<SliceDiameter> breast_height;
  if (result.metrics.dbh_m) {
    const double breast = tree_feet.front().position.z() + options.dbh_height_m;
    halves.breast_z_m = breast;
    const std::optional<SliceDiameter> slice = slice_diameter(scan.points, limbs, breast, result.noise_m);
    if (slice) {
      result.metrics.dbh_m = slice->diameter_m;
      result.metrics.dbh_coverage = slice->coverage;
      if (slice->ellipse) result.metrics.dbh_ellipse_m = {slice->ellipse->longest, slice->ellipse->shortest};
    }
    if (slice && slice->coverage < 0.6)
      result.warnings.push_back("the stem at breast height is seen from one side: its diameter rests on " +
                                std::to_string(static_cast<int>(std::lround(100 * slice->coverage))) +
                                " % of the girth");
    if (!slice)
      result.warnings.push_back("no clear circle at breast height: the diameter there is interpolated");
    breast_height = slice;
  }
  clock.mark("tree");

  Visibility seen = how_well_seen(limbs, result.leaf_on);
  seen.spread = subsample(scan.points, limbs, sights, halves, progress);
  estimate_scan_intervals(result.tree, breast_height, seen, result.noise_m, graph.typical_spacing_m,
                          result.metrics);
  for (const Section& s : sections) result.bridged_gaps += s.after_gap;
  clock.mark("intervals");
  return result;
}

}  // namespace dendrofit
