// SPDX-License-Identifier: GPL-3.0-or-later
#include "recon/image/rooting.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

namespace dendrofit {
namespace {

/// One of four arms about a crossing.
struct Arm {
  std::int32_t end = -1;  ///< as in Passes
  Eigen::Vector2d direction = Eigen::Vector2d::Zero();
  double radius = 0;
};

struct Pairing {
  std::array<std::size_t, 4> order;  ///< 0 goes on as 1, 2 as 3
  double turn = std::numeric_limits<double>::max();
};

double turn_between(const Arm& in, const Arm& out) {
  return std::acos(std::clamp(-in.direction.dot(out.direction), -1.0, 1.0));
}

/// The straightest of the three pairings, if both pairs hold.
Pairing pair_arms(const std::array<Arm, 4>& arms, double most_turn) {
  static constexpr std::array<std::array<std::size_t, 4>, 3> ways = {
      {{0, 1, 2, 3}, {0, 2, 1, 3}, {0, 3, 1, 2}}};
  Pairing best{};
  for (const auto& way : ways) {
    double sum = 0;
    bool holds = true;
    for (std::size_t k = 0; k < 4; k += 2) {
      const Arm &one = arms[way[k]], &two = arms[way[k + 1]];
      const double turn = turn_between(one, two);
      const double ratio = std::min(one.radius, two.radius) / std::max({one.radius, two.radius, 0.5});
      holds = holds && turn < most_turn && ratio > 0.6;
      sum += turn;
    }
    if (holds && sum < best.turn) best = {way, sum};
  }
  return best;
}

/// Edges that can be reached from the root under the passes.
std::size_t reachable(const PlaneGraph& graph, std::int32_t root, const Passes& passes) {
  std::vector<char> seen(2 * graph.edges.size(), 0);  // by the end an edge is entered at
  std::vector<std::int32_t> stack;
  std::vector<char> edge_seen(graph.edges.size(), 0);
  std::size_t count = 0;
  const auto enter = [&](std::int32_t end) {
    if (passes.consumed[static_cast<std::size_t>(end / 2)] || seen[static_cast<std::size_t>(end)]) return;
    seen[static_cast<std::size_t>(end)] = 1;
    if (!edge_seen[static_cast<std::size_t>(end / 2)]) ++count;
    edge_seen[static_cast<std::size_t>(end / 2)] = 1;
    stack.push_back(end);
  };
  const auto enter_from = [&](std::int32_t vertex) {
    for (const std::int32_t e : graph.at[static_cast<std::size_t>(vertex)]) {
      const std::int32_t end = 2 * e + (graph.edges[static_cast<std::size_t>(e)].b == vertex ? 1 : 0);
      if (passes.partner[static_cast<std::size_t>(end)] < 0) enter(end);
    }
  };
  enter_from(root);
  while (!stack.empty()) {
    const std::int32_t in = stack.back();
    stack.pop_back();
    const std::int32_t out = in ^ 1;
    const std::int32_t partner = passes.partner[static_cast<std::size_t>(out)];
    const PlaneGraph::Edge& edge = graph.edges[static_cast<std::size_t>(in / 2)];
    if (partner >= 0)
      enter(partner);
    else
      enter_from(out % 2 ? edge.b : edge.a);
  }
  return count;
}

class CrossingFinder {
 public:
  CrossingFinder(const PlaneGraph& graph, std::int32_t root, double turn_deg)
      : graph_(graph), root_(root), most_turn_(turn_deg * std::numbers::pi / 180) {
    passes_.partner.assign(2 * graph.edges.size(), -1);
    passes_.consumed.assign(graph.edges.size(), 0);
  }

  Passes run() {
    reachable_ = reachable(graph_, root_, passes_);
    for (std::size_t v = 0; v < graph_.vertex.size(); ++v)
      if (graph_.at[v].size() == 4) {
        std::vector<Arm> arms;
        add_arms(static_cast<std::int32_t>(v), -1, graph_.vertex_radius[v], arms);
        consider(arms, -1);
      }
    for (std::size_t e = 0; e < graph_.edges.size(); ++e) {
      const PlaneGraph::Edge& edge = graph_.edges[e];
      if (!edge.alive || edge.a == edge.b || graph_.degree(edge.a) != 3 || graph_.degree(edge.b) != 3)
        continue;
      const double radius = *std::max_element(edge.radius.begin(), edge.radius.end());
      if (edge.length > 3 * radius + 2) continue;
      std::vector<Arm> arms;
      add_arms(edge.a, static_cast<std::int32_t>(e), radius, arms);
      add_arms(edge.b, static_cast<std::int32_t>(e), radius, arms);
      consider(arms, static_cast<std::int32_t>(e));
    }
    return std::move(passes_);
  }

 private:
  void add_arms(std::int32_t v, std::int32_t without, double radius, std::vector<Arm>& arms) const {
    const double unit = std::max(1.0, radius);
    for (const std::int32_t e : graph_.at[static_cast<std::size_t>(v)]) {
      if (e == without) continue;
      const PlaneGraph::Edge& edge = graph_.edges[static_cast<std::size_t>(e)];
      Arm arm;
      arm.end = 2 * e + (edge.b == v ? 1 : 0);
      const double near = std::min(3 * unit, 0.4 * edge.length);
      arm.direction = arm_direction(edge, v, near, std::max(8 * unit, near + 5), &arm.radius);
      arms.push_back(arm);
    }
  }

  void consider(const std::vector<Arm>& list, std::int32_t shared) {
    if (list.size() != 4) return;
    std::array<Arm, 4> arms;
    for (std::size_t i = 0; i < 4; ++i) {
      arms[i] = list[i];
      const bool known = arms[i].direction.norm() > 0;
      const bool free = passes_.partner[static_cast<std::size_t>(arms[i].end)] < 0;
      if (!known || !free || passes_.consumed[static_cast<std::size_t>(arms[i].end / 2)]) return;
      for (std::size_t j = 0; j < i; ++j)
        if (arms[i].end / 2 == arms[j].end / 2) return;  // a loop on one vertex
    }
    const Pairing pairing = pair_arms(arms, most_turn_);
    if (pairing.turn == std::numeric_limits<double>::max()) return;
    Passes trial = passes_;
    for (std::size_t k = 0; k < 4; k += 2) {
      const std::int32_t one = arms[pairing.order[k]].end, two = arms[pairing.order[k + 1]].end;
      trial.partner[static_cast<std::size_t>(one)] = two;
      trial.partner[static_cast<std::size_t>(two)] = one;
    }
    if (shared >= 0) trial.consumed[static_cast<std::size_t>(shared)] = 1;
    const std::size_t lost = shared >= 0 ? 1 : 0;
    const std::size_t now = reachable(graph_, root_, trial);
    if (now + lost < reachable_) return;  // a part of the tree hangs on this junction
    trial.count = passes_.count + 1;
    passes_ = std::move(trial);
    reachable_ = now;
  }

  const PlaneGraph& graph_;
  std::int32_t root_;
  double most_turn_;
  Passes passes_;
  std::size_t reachable_ = 0;
};

}  // namespace

Passes find_passes(const PlaneGraph& graph, std::int32_t root, double turn_deg) {
  return CrossingFinder(graph, root, turn_deg).run();
}

}  // namespace dendrofit
