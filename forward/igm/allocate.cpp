// SPDX-License-Identifier: GPL-3.0-or-later
#include "forward/igm/allocate.h"

#include <algorithm>
#include <cmath>

namespace dendrofit::igm {
namespace {

// Priority model (self-organizing trees, re-used by the authors): weight of the first rank, and of ranks past
// k N.
constexpr double kFirstWeight = 1.0;
constexpr double kLastWeight = 0.006;
constexpr double kDarkLight = 1e-4;  // what a node in full shade still counts as

struct Resource {
  std::vector<double> own;    // light of a node, or of all it bears
  std::vector<double> buds;   // 1, or the buds of all it bears
  std::vector<double> above;  // own and everything further along the axis
  std::vector<double> got;    // v
};

// L = l^((T - T0)^sigma), Yi 2018, 4.1; the age of a new node counts as 1.
std::vector<double> node_light(const Stand& stand, int cycle) {
  std::vector<std::vector<double>> ageing(stand.parameters.size());
  for (std::size_t tree = 0; tree < ageing.size(); ++tree)
    for (int age = 0; age <= std::max(cycle, 1); ++age)
      ageing[tree].push_back(std::pow(std::max(age, 1), stand.parameters[tree].sigma));
  std::vector<double> light(stand.nodes.size());
  for (std::size_t i = 0; i < light.size(); ++i) {
    const double l = stand.light(i);
    const auto& exponent =
        ageing[static_cast<std::size_t>(stand.tree_of_axis(static_cast<std::size_t>(stand.nodes.axis[i])))];
    const auto age = static_cast<std::size_t>(std::clamp(cycle - stand.nodes.birth[i], 0, cycle));
    light[i] = l <= 0 ? kDarkLight : l >= 1 ? 1.0 : std::pow(l, exponent[age]);
  }
  return light;
}

// Tips to bases: a node that bears laterals counts with their light in place of its own.
void collect(const Stand& stand, const std::vector<double>& light, Resource& r,
             std::vector<double>& axis_buds) {
  const std::size_t n = stand.nodes.size();
  r.own.assign(n, 0);
  r.buds.assign(n, 0);
  r.above.resize(n);
  axis_buds.assign(stand.axes.size(), 0);
  for (std::size_t axis = stand.axes.size(); axis-- > 0;) {
    const auto nodes = stand.nodes_of(axis);
    double sum = 0, buds = 0;
    for (std::size_t j = nodes.size(); j-- > 0;) {
      const auto i = static_cast<std::size_t>(nodes[j]);
      if (stand.nodes.laterals[i] == 0) {
        r.own[i] = light[i];
        r.buds[i] = 1;
      }
      sum += r.own[i];
      buds += r.buds[i];
      r.above[i] = sum;
    }
    axis_buds[axis] = buds;
    if (stand.axes.base[axis] >= 0) {
      r.own[static_cast<std::size_t>(stand.axes.base[axis])] += sum;
      r.buds[static_cast<std::size_t>(stand.axes.base[axis])] += buds;
    }
  }
}

// One axis of N nodes: Borchert-Honda from its base, then weights falling linearly over the first k N ranks.
void share_axis(const Stand& stand, const IgmParameters& p, std::span<const std::int32_t> nodes, double V,
                bool tip_first, Resource& r, std::vector<std::pair<double, std::int32_t>>& rank) {
  const std::size_t N = nodes.size();
  rank.clear();
  double rest = V;
  for (std::size_t j = 0; j < N; ++j) {
    const auto i = static_cast<std::size_t>(nodes[j]);
    double u = 0;
    if (stand.nodes.laterals[i] > 0) {
      const double axis_part = p.lambda * (r.above[i] - r.own[i]), lateral_part = (1 - p.lambda) * r.own[i];
      u = rest * lateral_part / (axis_part + lateral_part);
    } else {
      u = rest * r.own[i] / r.above[i];
    }
    if (j + 1 == N) u = rest;
    rest -= u;
    r.got[i] = u;
    rank.emplace_back(u / r.buds[i], nodes[j]);
  }
  const auto better = [](const auto& a, const auto& b) {
    return a.first > b.first || (a.first == b.first && a.second < b.second);
  };
  auto sorted_from = rank.begin();
  if (tip_first) {  // apical control
    std::rotate(rank.begin(), rank.end() - 1, rank.end());
    ++sorted_from;
  }
  const double kN = p.k * static_cast<double>(N);
  const auto favoured = std::min(rank.size(), static_cast<std::size_t>(std::max(kN, 1.0)));
  if (sorted_from < rank.begin() + static_cast<std::ptrdiff_t>(favoured))
    std::partial_sort(sorted_from, rank.begin() + static_cast<std::ptrdiff_t>(favoured), rank.end(), better);
  double sum = 0;
  for (std::size_t j = 0; j < N; ++j) {
    const double place = static_cast<double>(j + 1);
    double w = kLastWeight;
    if (j == 0)
      w = kFirstWeight;
    else if (place <= kN && N > 2)
      w = kFirstWeight + (kLastWeight - kFirstWeight) * (place - 1) / (kN - 1);
    double& v = r.got[static_cast<std::size_t>(rank[j].second)];
    v *= w;
    sum += v;
  }
  const double scale = sum > 0 ? V / sum : 0;
  for (const std::int32_t node : nodes) r.got[static_cast<std::size_t>(node)] *= scale;
}

bool may_sprout(const Stand& stand, const IgmParameters& p, std::size_t node) {
  return stand.nodes.laterals[node] == 0 &&
         stand.axes.order[static_cast<std::size_t>(stand.nodes.axis[node])] < p.max_order;
}

// Shoots at a node and internodes per shoot (Yi 2018, 4.3; numbers of shoots from the authors' program).
Sprout shoots_of(const Stand& stand, const IgmParameters& p, std::int32_t node, double v, double cap) {
  const auto i = static_cast<std::size_t>(node);
  const bool trunk = stand.axes.order[static_cast<std::size_t>(stand.nodes.axis[i])] == 1;
  const bool tip = stand.is_tip(i);
  const int most = trunk ? (tip ? 4 : 3) : (tip ? 3 : 2);
  Sprout sprout{node, std::min(static_cast<int>(std::min(v, 1e6)), most), 0, 0};
  sprout.share = v / sprout.shoots;
  const double wanted = trunk ? std::round(sprout.share) : std::floor(sprout.share);
  // One less: the program counts the node a shoot starts from.
  sprout.internodes = static_cast<int>(std::min({wanted, std::round(cap) - 1, 1e6}));
  (void)p;
  return sprout;
}

// Without resource allocation every shoot is as long as the equation says; the k N brightest free nodes
// sprout.
void decide_by_equation(const Stand& stand, const std::vector<double>& light, std::size_t axis, double cap,
                        Decision& decision) {
  const IgmParameters& p = stand.parameters_of_axis(axis);
  const auto nodes = stand.nodes_of(axis);
  std::vector<std::pair<double, std::int32_t>> free;
  for (const std::int32_t node : nodes)
    if (may_sprout(stand, p, static_cast<std::size_t>(node)))
      free.emplace_back(-light[static_cast<std::size_t>(node)], node);
  const auto most =
      std::max<std::size_t>(1, static_cast<std::size_t>(p.k * static_cast<double>(nodes.size())));
  std::sort(free.begin(), free.end());
  if (free.size() > most) free.resize(most);
  std::sort(free.begin(), free.end(), [](const auto& a, const auto& b) { return a.second < b.second; });
  for (const auto& [dark, node] : free) {
    if (-dark <= kDarkLight) continue;
    if (cap < 1)
      decision.held_by_cap = true;
    else
      decision.sprouts.push_back({node, 1, static_cast<int>(cap), std::floor(cap)});
  }
}

}  // namespace

Decision decide(const Stand& stand, int cycle) {
  const std::vector<double> light = node_light(stand, cycle);
  std::vector<double> cap;
  for (const IgmParameters& p : stand.parameters) cap.push_back(p.cap(cycle));

  Resource r;
  std::vector<double> axis_buds;
  collect(stand, light, r, axis_buds);
  r.got.assign(stand.nodes.size(), 0);

  Decision decision;
  std::vector<std::pair<double, std::int32_t>> rank;
  for (std::size_t axis = 0; axis < stand.axes.size(); ++axis) {
    const IgmParameters& p = stand.parameters_of_axis(axis);
    const double limit = cap[static_cast<std::size_t>(stand.tree_of_axis(axis))];
    if (!p.resource_allocation) {
      decide_by_equation(stand, light, axis, limit, decision);
      continue;
    }
    const auto nodes = stand.nodes_of(axis);
    const std::int32_t base = stand.axes.base[axis];
    double V = 0;
    if (base < 0) {
      V = p.alpha * r.above[static_cast<std::size_t>(nodes[0])];
    } else {
      const auto b = static_cast<std::size_t>(base);
      V = r.got[b] * axis_buds[axis] / r.buds[b];
    }
    share_axis(stand, p, nodes, V, base < 0 && cycle - 1 <= p.tau, r, rank);
    for (const std::int32_t node : nodes) {
      const auto i = static_cast<std::size_t>(node);
      if (r.got[i] < 1 || !may_sprout(stand, p, i)) continue;
      const Sprout sprout = shoots_of(stand, p, node, r.got[i], limit);
      if (sprout.internodes >= 1)
        decision.sprouts.push_back(sprout);
      else
        decision.held_by_cap = true;
    }
  }
  return decision;
}

}  // namespace dendrofit::igm
