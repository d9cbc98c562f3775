// SPDX-License-Identifier: GPL-3.0-or-later
// Leaves a CPU second, from 10^3 to 10^6 leaves on a tree of about 20,000 cylinders.
//
// usage: leaves_bench [--most N | --area M2] [--threads N] [--length-m L] [--species NAME] [--branches N]
// [--write FOLDER]
//   --branches: of the stem (60: 19,770 cylinders, 20: about a third)
//   --write: the last leaves and their tree, for scripts/check_leaves FOLDER/leaves.obj FOLDER/qsm.csv
//            --leaves FOLDER/leaves.csv --petioles FOLDER/petioles.obj
#include "core/random.h"
#include "core/tree.h"
#include "forward/leaves/insert_leaves.h"
#include "io/write_mesh.h"
#include "io/write_tree.h"

#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <numbers>
#include <optional>
#include <string>

#include <Eigen/Geometry>
#include <sys/resource.h>

namespace {

using namespace dendrofit;

struct Maker {
  Tree tree;
  std::int32_t axes = 0;
  Random random{7};

  /// A wavy axis of `count` cylinders; returns its nodes' first index.
  std::size_t axis(std::int32_t parent, Vec3 at, Vec3 along, double length, int count, double radius,
                   std::int32_t order) {
    const std::size_t first = tree.size();
    const std::int32_t id = axes++;
    for (int k = 0; k < count; ++k) {
      along = (along + 0.08 * random.direction() + Vec3(0, 0, 0.02)).normalized();
      TreeNode node;
      node.start = at;
      node.end = at = at + along * (length / count);
      node.parent = parent;
      node.radius = radius * (1 - 0.7 * k / count);
      node.axis = id;
      node.order = order;
      parent = tree.add(node);
    }
    return first;
  }

  void side_axes(std::size_t first, std::size_t last, int per_axis, double from, double length, int count,
                 double thinner, std::int32_t order, int deepest) {
    for (int k = 0; k < per_axis; ++k) {
      const double at = from + (1 - from) * (k + 0.5) / per_axis;
      const auto node = first + static_cast<std::size_t>(at * static_cast<double>(last - first));
      const Vec3 along = tree.direction(node);
      const Vec3 out = Eigen::AngleAxisd(k * 2.4 + 0.3 * random.normal(), along) * along.unitOrthogonal();
      const double own = length * (1.2 - 0.7 * at);
      const std::size_t begin =
          axis(static_cast<std::int32_t>(node), tree.end[node], (0.5 * along + out).normalized(), own, count,
               tree.radius[node] * thinner, order);
      const std::size_t end = tree.size();
      if (order < deepest) {
        if (order == 1) side_axes(begin, end, 15, 0.15, 1.3, 5, 0.5, 2, deepest);
        if (order == 2) side_axes(begin, end, 5, 0.1, 0.45, 3, 0.6, 3, deepest);
      }
    }
  }
};

Tree bench_tree(int branches) {
  Maker maker;
  maker.axis(-1, Vec3::Zero(), Vec3::UnitZ(), 18, 90, 0.2, 0);
  maker.side_axes(0, 90, branches, 0.2, 4.5, 28, 0.35, 1, 3);
  for (double& r : maker.tree.radius) r = std::max(r, 0.0015);
  return maker.tree;
}

double cpu_seconds() {
  return static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}

}  // namespace

int main(int argc, char** argv) {
  std::size_t most = 1'000'000;
  double length = 0.029;
  std::string folder;
  int branches = 60;
  std::optional<double> area;
  LeafOptions options;
  options.threads = 1;
  for (int i = 1; i + 1 < argc; i += 2) {
    const std::string key = argv[i];
    if (key == "--most") most = std::strtoull(argv[i + 1], nullptr, 10);
    if (key == "--threads") options.threads = std::atoi(argv[i + 1]);
    if (key == "--branches") branches = std::atoi(argv[i + 1]);
    if (key == "--area") area = std::atof(argv[i + 1]);
    if (key == "--write") folder = argv[i + 1];
    if (key == "--length-m") length = std::atof(argv[i + 1]);
    if (key == "--species") options.traits = leaf_traits(argv[i + 1]);
  }
  LengthLaw& law = options.traits.length;
  const double scale = length / law.mean_m;
  law = {law.kind, law.mean_m * scale, law.sd_m * scale, law.min_m * scale, law.max_m * scale};
  options.traits.petiole_min_m *= scale;
  options.traits.petiole_max_m *= scale;
  const Tree tree = bench_tree(branches);
  double wood = 0;
  for (std::size_t i = 0; i < tree.size(); ++i) wood += tree.length(i);
  std::printf("%zu cylinders, %.0f m of wood, threads %d\n", tree.size(), wood, options.threads);
  std::printf("%10s %10s %9s %9s %9s %12s %9s %9s  %s\n", "leaves", "placed", "m2", "CPU s", "wall s",
              "leaves/CPU s", "poses", "MB", "largest drift (KS)");
  for (std::size_t n = area ? most : 1000; n <= most; n *= 10) {
    if (area)
      options.area_m2 = area;
    else
      options.count = n;
    const double begin = cpu_seconds();
    const LeafResult result = insert_leaves(tree, options);
    const double seconds = cpu_seconds() - begin;
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    const LeafDistribution* moved = nullptr;
    for (const LeafDistribution& d : result.report.distributions)
      if (!moved || d.after.distance > moved->after.distance) moved = &d;
    std::printf(
        "%10zu %10zu %9.3f %9.2f %9.2f %12.0f %9zu %9ld  %s %.3f\n", area ? result.report.requested_count : n,
        result.foliage.size(), result.report.achieved_area_m2, seconds, result.report.seconds,
        static_cast<double>(result.foliage.size()) / seconds, result.report.poses, usage.ru_maxrss / 1024,
        moved ? moved->name.c_str() : "none", moved ? moved->after.distance : 0.0);
    std::fflush(stdout);
    if (folder.empty() || 10 * n <= most) continue;
    write_qsm_csv(folder + "/qsm.csv", tree);
    write_leaves_csv(folder + "/leaves.csv", result.foliage);
    write_foliage_obj(folder + "/leaves.obj", result.foliage);
    write_petioles_obj(folder + "/petioles.obj", result.foliage);
  }
  return 0;
}
