// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/report/sample.h"

#include "cli/report/render.h"
#include "core/random.h"

#include <cmath>
#include <numbers>

#include <Eigen/Geometry>

namespace dendrofit::test {
namespace {

void grow(Tree& tree, std::int32_t parent, const Vec3& from, const Vec3& direction, double length,
          double radius, std::int32_t order, int levels, int cycle, std::int32_t& axes, Random random) {
  const std::int32_t axis = axes++;
  Vec3 at = from;
  Vec3 along = direction;
  const int pieces = 5;
  for (int k = 0; k < pieces; ++k) {
    TreeNode node;
    node.start = at;
    node.end = at + along * (length / pieces);
    node.parent = parent;
    node.radius = radius * (1 - 0.12 * k);
    node.axis = axis;
    node.order = order;
    node.birth_cycle = cycle + k;
    node.quality = static_cast<RadiusQuality>(std::min(levels > 2 ? 0 : 3 - levels, 3));
    node.radius_se = 0.03 * node.radius;
    parent = tree.add(node);
    at = node.end;
    along = (along + 0.12 * random.direction() + 0.05 * Vec3::UnitZ()).normalized();
    if (levels > 0 && k >= (order == 0 ? 1 : 0)) {
      const double turn = 2.4 * (k + 3 * order) + random.uniform();
      const Vec3 across = along.unitOrthogonal();
      const Vec3 out = std::cos(turn) * across + std::sin(turn) * along.cross(across);
      grow(tree, parent, at, (0.6 * along + 0.8 * out).normalized(), 0.62 * length, 0.5 * node.radius,
           order + 1, levels - 1, cycle + k + 1, axes, random.child({static_cast<std::uint64_t>(k)}));
    }
  }
}

}  // namespace

Tree branching_tree(int levels, std::uint64_t seed, const Vec3& foot) {
  Tree tree;
  tree.origin_shift = foot;
  std::int32_t axes = 0;
  grow(tree, -1, Vec3::Zero(), Vec3::UnitZ(), 3.2, 0.09, 0, levels, 1, axes, Random(seed));
  return tree;
}

PointCloud scattered_scan(const Tree& tree, std::size_t points) {
  PointCloud cloud;
  cloud.origin_shift = tree.origin_shift;
  double total = 0;
  for (std::size_t i = 0; i < tree.size(); ++i) total += tree.radius[i] * tree.length(i);
  Random random(7);
  for (std::size_t i = 0; i < tree.size(); ++i) {
    const double share = static_cast<double>(points) * tree.radius[i] * tree.length(i) / total;
    const Vec3 along = tree.direction(i);
    const Vec3 across = along.unitOrthogonal();
    const Vec3 beside = along.cross(across);
    for (double k = random.uniform(); k < share; ++k) {
      const double angle = random.uniform(0, 2 * std::numbers::pi);
      cloud.points.push_back(tree.start[i] + random.uniform() * tree.length(i) * along +
                             tree.radius[i] * (std::cos(angle) * across + std::sin(angle) * beside));
    }
  }
  return cloud;
}

Foliage diamond_leaves(const Tree& tree, std::size_t leaves) {
  Foliage foliage;
  foliage.origin_shift = tree.origin_shift;
  foliage.species = "diamond";
  LeafShape shape;
  shape.name = "diamond";
  shape.vertices = {{0, 0, 0}, {0.3, 0.45, 0.02}, {0, 1, 0}, {-0.3, 0.45, 0.02}};
  shape.triangles = {{0, 1, 2}, {0, 2, 3}};
  foliage.shapes = {shape};
  std::vector<std::size_t> thin;
  for (std::size_t i = 0; i < tree.size(); ++i)
    if (tree.radius[i] < 0.012) thin.push_back(i);
  Random random(11);
  for (std::size_t k = 0; k < leaves && !thin.empty(); ++k) {
    const std::size_t node = thin[random.below(thin.size())];
    Leaf leaf;
    leaf.direction = random.direction();
    leaf.normal = leaf.direction.unitOrthogonal();
    leaf.petiole_foot = tree.start[node] + random.uniform() * (tree.end[node] - tree.start[node]);
    leaf.origin = leaf.petiole_foot + 0.02 * leaf.direction;
    leaf.length_m = random.uniform(0.05, 0.09);
    leaf.node = static_cast<std::int32_t>(node);
    foliage.leaves.push_back(leaf);
  }
  return foliage;
}

Sample::Sample(std::size_t scan_points, std::size_t leaf_count) {
  model = branching_tree(4, 1, Vec3(486000.25, 5432000.5, 412.75));
  regrown = branching_tree(4, 2);
  scan = scattered_scan(model, scan_points);
  foliage = diamond_leaves(regrown, leaf_count);
  model_metrics = measure(model);
  regrown_metrics = measure(regrown);
  model_metrics.intervals["height_m"] = {model_metrics.height_m, model_metrics.height_m - 0.04,
                                         model_metrics.height_m + 0.06};
  model_metrics.intervals["dbh_m"] = {*model_metrics.dbh_m, *model_metrics.dbh_m - 0.003,
                                      *model_metrics.dbh_m + 0.003};
  data.title = "B\xc3\xa4ume \"<b>no. 7</b>\" & 'Sons' </script><script>document.title='broken'</script>";
  data.scan = &scan;
  data.model = &model;
  data.regrown = &regrown;
  data.foliage = &foliage;
  data.model_metrics = &model_metrics;
  data.regrown_metrics = &regrown_metrics;
  data.measured_taper = {{0.2, 0.181}, {0.7, 0.172}, {1.3, 0.158}, {1.9, 0.141}};
  data.growth_model = "IGM, logistic equation";
  data.fit_status = "Stopped after 400 evaluations: no better tree in the last 100.";
  data.parameters = {
      {"xm", "Xm", "", "upper asymptote of the growth curve", 61.5, 55.0, 68.0, 20.0, 120.0, true, false},
      {"r", "r", "1/cycle", "growth rate", 0.082, 0.071, 0.095, 0.01, 0.4, true, false},
      {"lambda", "\xce\xbb", "", "apical control", 0.52, 0.31, 0.88, 0.3, 0.9, false, false},
      {"rho_m", "\xcf\x81", "m", "internode length", 0.05, {}, {}, {}, {}, true, true}};
  ReportCurve height{"height", "m", "cycle", {}, {}, {}, {}, {}, {{14, model_metrics.height_m}}};
  for (int cycle = 1; cycle <= 14; ++cycle) {
    const double full = 3.6 / (1 + 12 * std::exp(-0.45 * cycle));
    height.time.push_back(cycle);
    height.cap.push_back(0.45 * full * (1 - full / 3.6));
    height.value.push_back(0.95 * full);
    height.lo.push_back(0.85 * full);
    height.hi.push_back(1.02 * full);
  }
  data.curves = {height};
  data.descriptors = {
      {"height", 0.9, 0.02}, {"volume by order", 1.4, 0.31}, {"branch angles <deg>", {}, 0.22}};
  for (int k = 0; k < 40; ++k)
    data.cost_by_evaluation.emplace_back(10 * k + 1, 4.0 * std::exp(-0.12 * k) + 0.35);
  data.leaf_facts = {{"Leaf area", "3.1 m2"}, {"Leaves", std::to_string(foliage.size())}};
  data.warnings = {"The crown's top was seen from one side only: thin wood there is drawn by allometry.",
                   "<img src=x onerror=alert(1)> is only a file name"};
  data.provenance.version = "0.1.0";
  data.provenance.seed = 1;
  data.provenance.command_line = "dendrofit run \"B\xc3\xa4ume <7>.las\" -o out";
  data.provenance.input_name = "B\xc3\xa4ume <7>.las";
  data.provenance.input_checksum = "crc32:00000000";
  data.provenance.options = {{"voxel", "5mm"}, {"species", "a\"b<c>"}};
  data.provenance.stages = {{"reconstruct", 3.21}, {"fit", 42.0}, {"leaves", 1.5}};
  RenderOptions picture;
  picture.threads = 1;
  picture.panel_width_px = 360;
  picture.height_px = 620;
  data.side_by_side_png = encode_png(side_by_side({&scan, &model, &regrown, &foliage, false}, picture));
}

}  // namespace dendrofit::test
