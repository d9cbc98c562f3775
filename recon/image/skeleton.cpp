// SPDX-License-Identifier: GPL-3.0-or-later
#include "recon/image/skeleton.h"

#include "core/errors.h"
#include "recon/image/cover.h"
#include "recon/image/distance.h"
#include "recon/image/lines.h"
#include "recon/image/radii.h"
#include "recon/image/rooting.h"
#include "recon/image/thinning.h"

#include <algorithm>
#include <cmath>

namespace dendrofit {
namespace {

/// A path on the pixel grid without its steps: every point the mean of its neighbours up to a radius (at most
/// six pixels) away, ends kept.
std::vector<Eigen::Vector2d> smoothed(const std::vector<Eigen::Vector2d>& path,
                                      const std::vector<float>& distance) {
  const std::size_t n = path.size();
  std::vector<Eigen::Vector2d> smooth = path;
  for (std::size_t i = 1; i + 1 < n; ++i) {
    const auto wanted = static_cast<std::size_t>(std::clamp(std::lround(distance[i]), 2L, 6L));
    const std::size_t reach = std::min({wanted, i, n - 1 - i});
    Eigen::Vector2d sum = Eigen::Vector2d::Zero();
    for (std::size_t k = i - reach; k <= i + reach; ++k) sum += path[k];
    smooth[i] = sum / static_cast<double>(2 * reach + 1);
  }
  return smooth;
}

/// Appends the nodes of one grown edge.
class NodeWriter {
 public:
  NodeWriter(const Silhouette& silhouette, const PlaneGraph& graph, double spacing_px, PlaneSkeleton& out)
      : silhouette_(silhouette),
        solid_(solid_distance(silhouette)),
        graph_(graph),
        spacing_px_(spacing_px),
        out_(out) {}

  /// Nodes along the edge, hung on node `parent`; the edge's last node. A side branch (not the main
  /// continuation of its bearer) begins where its line leaves the bearer's disc.
  std::int32_t write(const GrownEdge& grown, std::int32_t parent, bool main) {
    const PlaneGraph::Edge& edge = graph_.edges[static_cast<std::size_t>(grown.edge)];
    std::vector<float> distance = edge.radius;
    std::vector<std::uint8_t> bridge = edge.bridge;
    std::vector<Eigen::Vector2d> path = edge.path;
    if (grown.from != edge.a) {
      std::reverse(path.begin(), path.end());
      std::reverse(distance.begin(), distance.end());
      std::reverse(bridge.begin(), bridge.end());
    }
    const std::vector<double> radius = path_radii(silhouette_, solid_, path, distance);
    path = smoothed(path, distance);
    if (parent < 0)
      parent = add(path[0], radius[std::min<std::size_t>(1, radius.size() - 1)], -1, false, false);
    bool continues = main;
    const double disc = main ? 0 : distance[0];
    double run = spacing_px_;
    bool over_gap = false;
    for (std::size_t i = 1; i < path.size(); ++i) {
      run += (path[i] - path[i - 1]).norm();
      over_gap = over_gap || bridge[i];
      const bool last = i + 1 == path.size();
      if (!last && (run < std::max(spacing_px_, 0.5 * radius[i]) || (path[i] - path[0]).norm() < disc))
        continue;
      if ((path[i] - out_.px[static_cast<std::size_t>(parent)]).norm() < 0.5) continue;
      parent = add(path[i], radius[i], parent, over_gap, continues);
      continues = true;
      run = 0;
      over_gap = false;
    }
    return parent;
  }

 private:
  std::int32_t add(const Eigen::Vector2d& px, double radius, std::int32_t parent, bool bridge,
                   bool continues) {
    out_.px.push_back(px);
    out_.radius_px.push_back(radius);
    out_.parent.push_back(parent);
    out_.bridge.push_back(bridge ? 1 : 0);
    // An edge too short for a node of its own leaves two that would go on from one node.
    continued_.resize(out_.px.size(), 0);
    continues = continues && parent >= 0 && !continued_[static_cast<std::size_t>(parent)];
    if (continues) continued_[static_cast<std::size_t>(parent)] = 1;
    out_.continues.push_back(continues ? 1 : 0);
    return static_cast<std::int32_t>(out_.px.size() - 1);
  }

  const Silhouette& silhouette_;
  std::vector<float> solid_;
  const PlaneGraph& graph_;
  double spacing_px_;
  PlaneSkeleton& out_;
  std::vector<char> continued_;  // by node
};

/// For every grown edge whether it continues its bearer: of those that leave it, the one that is thick,
/// straight on and bears much (thickness, times the square root of the length beyond, times how straight it
/// goes on).
std::vector<char> main_edges(const PlaneGraph& graph, const std::vector<GrownEdge>& order) {
  std::vector<double> beyond(order.size(), 0);
  for (std::size_t i = order.size(); i-- > 0;) {
    beyond[i] += graph.edges[static_cast<std::size_t>(order[i].edge)].length;
    if (order[i].parent >= 0) beyond[static_cast<std::size_t>(order[i].parent)] += beyond[i];
  }
  std::vector<std::int32_t> best(order.size() + 1, -1);  // by bearer; the root's last
  std::vector<double> best_score(order.size() + 1, -1);
  for (std::size_t i = 0; i < order.size(); ++i) {
    const double unit = std::max(1.0f, graph.vertex_radius[static_cast<std::size_t>(order[i].from)]);
    const PlaneGraph::Edge& edge = graph.edges[static_cast<std::size_t>(order[i].edge)];
    double radius = 0, straight = 1;
    const Eigen::Vector2d out = arm_direction(edge, order[i].from, unit, 4 * unit + 6, &radius);
    if (order[i].parent >= 0) {
      const GrownEdge& bearer = order[static_cast<std::size_t>(order[i].parent)];
      const PlaneGraph::Edge& in_edge = graph.edges[static_cast<std::size_t>(bearer.edge)];
      const Eigen::Vector2d in = -arm_direction(in_edge, in_edge.other(bearer.from), unit, 4 * unit + 6);
      straight = 0.55 + 0.45 * in.dot(out);
    }
    const std::size_t at = order[i].parent < 0 ? order.size() : static_cast<std::size_t>(order[i].parent);
    const double score = std::max(radius, 0.3) * std::sqrt(beyond[i]) * straight;
    if (score <= best_score[at]) continue;
    best_score[at] = score;
    best[at] = static_cast<std::int32_t>(i);
  }
  std::vector<char> main(order.size(), 0);
  for (const std::int32_t i : best)
    if (i >= 0) main[static_cast<std::size_t>(i)] = 1;
  return main;
}

/// A side branch is no thicker than its bearer goes on (the mean of its next nodes), and thinner at its base.
void bound_branches(PlaneSkeleton& skeleton) {
  constexpr int ahead = 5;
  std::vector<std::int32_t> next(skeleton.size(), -1);
  for (std::size_t i = 1; i < skeleton.size(); ++i)
    if (skeleton.continues[i])
      next[static_cast<std::size_t>(skeleton.parent[i])] = static_cast<std::int32_t>(i);
  for (std::size_t i = 1; i < skeleton.size(); ++i) {
    if (skeleton.continues[i]) continue;
    const auto bearer = static_cast<std::size_t>(skeleton.parent[i]);
    double sum = 0;
    int count = 0;
    for (std::int32_t k = next[bearer]; k >= 0 && count < ahead;
         k = next[static_cast<std::size_t>(k)], ++count)
      sum += skeleton.radius_px[static_cast<std::size_t>(k)];
    if (count == 0) continue;
    const double most = sum / count;
    for (auto k = static_cast<std::int32_t>(i); k >= 0; k = next[static_cast<std::size_t>(k)]) {
      double& radius = skeleton.radius_px[static_cast<std::size_t>(k)];
      radius = std::min(radius, most);
    }
    double& base = skeleton.radius_px[i];
    base = std::min(base, 0.999 * skeleton.radius_px[static_cast<std::size_t>(next[bearer])]);
  }
}

/// Counts the pieces of lines that no grown edge reaches, and the share of the silhouette about them. `dots`
/// are pieces of one pixel.
void count_dropped(const PlaneGraph& graph, const std::vector<GrownEdge>& order, std::size_t dots,
                   PlaneSkeleton& result) {
  double kept = 0, lost = static_cast<double>(dots);
  result.dropped_pieces = dots;
  std::vector<char> seen(graph.edges.size(), 0);
  std::vector<std::int32_t> stack;
  const auto area_with = [&](std::int32_t start) {
    double area = 0;
    stack.assign(1, start);
    seen[static_cast<std::size_t>(start)] = 1;
    while (!stack.empty()) {
      const PlaneGraph::Edge& edge = graph.edges[static_cast<std::size_t>(stack.back())];
      stack.pop_back();
      for (const float r : edge.radius) area += 2 * r;
      for (const std::int32_t v : {edge.a, edge.b})
        for (const std::int32_t e : graph.at[static_cast<std::size_t>(v)])
          if (!seen[static_cast<std::size_t>(e)]) {
            seen[static_cast<std::size_t>(e)] = 1;
            stack.push_back(e);
          }
    }
    return area;
  };
  if (!order.empty()) kept = area_with(order.front().edge);
  for (std::size_t e = 0; e < graph.edges.size(); ++e) {
    if (!graph.edges[e].alive || seen[e]) continue;
    lost += area_with(static_cast<std::int32_t>(e));
    ++result.dropped_pieces;
  }
  result.dropped_share = kept + lost > 0 ? lost / (kept + lost) : 0;
}

}  // namespace

void ImageSkeletonOptions::validate() const {
  const auto positive = [](const char* field, double value) {
    require(std::isfinite(value) && value > 0, field, value, "must be positive");
  };
  positive("spur_radii", spur_radii);
  positive("gap_radii", gap_radii);
  positive("gap_px", gap_px);
  positive("gap_turn_deg", gap_turn_deg);
  positive("crossing_turn_deg", crossing_turn_deg);
  positive("node_spacing_px", node_spacing_px);
}

PlaneSkeleton skeletonise(const Silhouette& silhouette, const ImageSkeletonOptions& options) {
  options.validate();
  const std::vector<std::uint8_t> sharp = sharpened(silhouette);
  LineImage lines{silhouette.width, silhouette.height, thin(sharp, silhouette.width, silhouette.height),
                  distance_inside(sharp, silhouette.width, silhouette.height)};
  PlaneSkeleton result;
  result.joined_pieces = join_pieces(lines, options.gap_px, options.gap_radii, options.gap_turn_deg);
  PlaneGraph graph = trace(lines);
  const auto dots = static_cast<std::size_t>(
      std::count_if(graph.at.begin(), graph.at.end(), [](const auto& edges) { return edges.empty(); }));
  drop_spurs(graph, options.spur_radii);
  const std::int32_t root = find_root(graph, lines, options.root_px);
  const Passes passes = find_passes(graph, root, options.crossing_turn_deg);
  result.crossings = passes.count;
  const std::vector<GrownEdge> order = grow_order(graph, root, passes);

  const std::vector<char> main = main_edges(graph, order);
  count_dropped(graph, order, dots, result);

  NodeWriter writer(silhouette, graph, options.node_spacing_px, result);
  std::vector<std::int32_t> last(order.size(), -1);
  for (std::size_t i = 0; i < order.size(); ++i) {
    const std::int32_t parent = order[i].parent;
    const std::int32_t node =
        parent >= 0 ? last[static_cast<std::size_t>(parent)] : (result.size() > 0 ? 0 : -1);
    last[i] = writer.write(order[i], node, main[i]);
  }
  bound_branches(result);
  if (result.size() < 2) throw SolverError("no tree found: the silhouette holds no line to follow");
  return result;
}

double foot_radius_px(const PlaneSkeleton& skeleton) {
  double radius = skeleton.radius_px.front(), run = 0;
  std::size_t at = 0;
  for (std::size_t i = 1; i < skeleton.size() && run <= 2 * radius; ++i) {
    const bool on = static_cast<std::size_t>(skeleton.parent[i]) == at && skeleton.continues[i];
    if (at != 0 ? !on : skeleton.parent[i] != 0) continue;
    run += (skeleton.px[i] - skeleton.px[at]).norm();
    radius = std::max(radius, skeleton.radius_px[i]);
    at = i;
  }
  return radius;
}

}  // namespace dendrofit
