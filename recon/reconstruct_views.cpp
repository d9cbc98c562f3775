// SPDX-License-Identifier: GPL-3.0-or-later
#include "recon/reconstruct_views.h"

#include "core/errors.h"
#include "recon/image_carve.h"
#include "recon/image_poses.h"
#include "recon/image_settle.h"
#include "core/tree_topology.h"
#include <cstdio>
#include <cstdlib>
#include <ctime>
namespace dendrofit {

void ViewsOptions::validate() const { cloud.validate(); }
static double clk() { static clock_t t0 = clock(); clock_t t = clock(); double d = double(t - t0) / CLOCKS_PER_SEC; t0 = t; return d; }
ViewsReconstruction reconstruct_views(const ViewSet& set, const ViewsOptions& options, Progress& progress) {
  options.validate();
  ViewsReconstruction result;
  std::vector<Camera> cameras;
  std::vector<Outline> outlines;
  clk();
  for (const View& v : set.views) {
    cameras.push_back(v.camera);
    outlines.emplace_back(v.photo.mask, v.photo.width, v.photo.height);
  }
  fprintf(stderr, "outlines %.1f s\n", clk());
  CarveOptions carving{.cell_m = carving_cell_m(cameras, outlines), .threads = options.cloud.threads};
  if (getenv("TAU")) carving.tolerance_px = atof(getenv("TAU"));
  if (getenv("MISS")) carving.misses_allowed = atoi(getenv("MISS"));
  if (getenv("CELL")) carving.cell_m *= atof(getenv("CELL"));
  ReconstructOptions ro = options.cloud;
  if (getenv("VOX")) ro.voxel_size_m = atof(getenv("VOX"));
  if (getenv("GAP")) ro.max_gap_m = atof(getenv("GAP"));
  const Hull hull = carve(cameras, outlines, carving, progress);
  fprintf(stderr, "cell %.4f cells %zu %.1f s\n", hull.cell_m, hull.cells.size(), clk());
  auto e = explained_shares(hull, cameras, outlines, 0, options.cloud.threads);
  for (double x : e) fprintf(stderr, "%.3f ", x);
  fprintf(stderr, " %.1f s\n", clk());
  PointCloud cloud;
  cloud.origin_shift = set.origin_shift;
  cloud.points = hull.cells;
  result.model = reconstruct(cloud, ro, progress);
  fprintf(stderr, "reconstruct %zu cyl %.1f s\n", result.model.tree.size(), clk());
  result.cell_m = hull.cell_m;
  if (getenv("RAW")) return result;
  Tree tree = result.model.tree;
  const Vec3 back = tree.origin_shift - set.origin_shift;
  for (std::size_t i = 0; i < tree.size(); ++i) tree.start[i] += back, tree.end[i] += back;
  tree.origin_shift = set.origin_shift;
  int rounds = getenv("ROUNDS") ? atoi(getenv("ROUNDS")) : 2;
  int least = getenv("LEAST") ? atoi(getenv("LEAST")) : 3;
  for (int k = 0; k < rounds; ++k) {
    Sightings s = sight_cylinders(tree, cameras, outlines, 4, options.cloud.threads, progress);
    auto keep = supported(tree, s, least);
    std::size_t kept = 0; for (char c : keep) kept += c;
    fprintf(stderr, "supported %zu of %zu\n", kept, tree.size());
    if (kept < tree.size()) { tree = subset(tree, keep); s = sight_cylinders(tree, cameras, outlines, 4, options.cloud.threads, progress); }
    centre_on_views(tree, s);
    s = sight_cylinders(tree, cameras, outlines, 2, options.cloud.threads, progress);
    settle_radii_from_views(tree, s);
    std::size_t n[4] = {}; for (auto q : tree.quality) ++n[int(q)];
    fprintf(stderr, "quality m %zu i %zu a %zu e %zu; offsets", n[0], n[1], n[2], n[3]);
    for (double x : median_offsets_px(s, cameras.size())) fprintf(stderr, " %.2f", x);
    fprintf(stderr, " %.1f s\n", clk());
  }
  assign_axes_by_thickness(tree);
  result.model.tree = tree;
  return result;
}

}  // namespace dendrofit
