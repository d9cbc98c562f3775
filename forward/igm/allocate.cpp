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

// An axis's first record is its base: the bearer's node seen by the axis. It takes part in the sharing with
// that node's light, aged from the axis's birth, but sprouts nothing (the authors' program; a seedling's base
// is dark).
struct Resource {
  std::vector<double> own;        // light of a node, or of all it bears
  std::vector<double> buds;       // 1, or the buds of all it bears
  std::vector<double> above;      // own and everything further along the axis
  std::vector<double> got;        // v
  std::vector<double> base;       // light of an axis's base record
  std::vector<double> axis_buds;  // buds of an axis, its base record's included
};

// L = l^((T - T0)^sigma), Yi 2018, 4.1; the age of a new node counts as 1.
class Ageing {
 public:
  Ageing(double sigma, int cycle) : cycle_(cycle) {
    for (int age = 0; age <= std::max(cycle, 1); ++age)
      exponent_.push_back(std::pow(std::max(age, 1), sigma));
  }
  double operator()(double l, int birth) const {
    if (l <= 0) return kDarkLight;
    if (l >= 1) return 1;
    return std::pow(l, exponent_[static_cast<std::size_t>(std::clamp(cycle_ - birth, 0, cycle_))]);
  }

 private:
  int cycle_;
  std::vector<double> exponent_;
};

// Light of every node, and of every axis's base record.
std::vector<double> node_light(const Stand& stand, int cycle, Resource& r) {
  std::vector<Ageing> aged;
  for (const IgmParameters& p : stand.parameters) aged.emplace_back(p.sigma, cycle);
  std::vector<double> light(stand.nodes.size());
  r.base.resize(stand.axes.size());
  for (std::size_t axis = 0; axis < stand.axes.size(); ++axis) {
    const Ageing& ageing = aged[static_cast<std::size_t>(stand.tree_of_axis(axis))];
    const auto nodes = stand.nodes_of(axis);
    for (const std::int32_t node : nodes) {
      const auto i = static_cast<std::size_t>(node);
      light[i] = ageing(stand.light(i), stand.nodes.birth[i]);
    }
    const std::int32_t base = stand.axes.base[axis];
    r.base[axis] = base < 0 ? kDarkLight
                            : ageing(stand.light(static_cast<std::size_t>(base)),
                                     stand.nodes.birth[static_cast<std::size_t>(nodes[0])]);
  }
  return light;
}

// Tips to bases: a node that bears laterals counts with their light in place of its own.
void collect(const Stand& stand, const std::vector<double>& light, Resource& r) {
  const std::size_t n = stand.nodes.size();
  r.own.assign(n, 0);
  r.buds.assign(n, 0);
  r.above.resize(n);
  r.got.assign(n, 0);
  r.axis_buds.resize(stand.axes.size());
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
    r.axis_buds[axis] = buds + 1;
    if (stand.axes.base[axis] >= 0) {
      const auto base = static_cast<std::size_t>(stand.axes.base[axis]);
      r.own[base] += sum + r.base[axis];
      r.buds[base] += r.axis_buds[axis];
    }
  }
}

struct Ranked {
  double worth;       // u / buds
  std::int32_t node;  // -1 the base record
  double u;
};

// One axis of N records with resource V: Borchert-Honda from its base, then weights falling linearly over the
// first k N ranks.
void share_axis(const Stand& stand, const IgmParameters& p, std::size_t axis, double V, bool tip_first,
                Resource& r, std::vector<Ranked>& rank) {
  const auto nodes = stand.nodes_of(axis);
  const double at_base = V * r.base[axis] / (r.base[axis] + r.above[static_cast<std::size_t>(nodes[0])]);
  double rest = V - at_base;
  rank.assign(1, {at_base, -1, at_base});
  for (const std::int32_t node : nodes) {
    const auto i = static_cast<std::size_t>(node);
    double u = rest;
    if (node != nodes.back()) {
      const double further = r.above[i] - r.own[i];
      // v_m = v lambda Q_m / (lambda Q_m + (1 - lambda) Q_l) goes on; a node without laterals keeps its part.
      u = stand.nodes.laterals[i] > 0
              ? rest * (1 - p.lambda) * r.own[i] / (p.lambda * further + (1 - p.lambda) * r.own[i])
              : rest * r.own[i] / r.above[i];
    }
    rest -= u;
    rank.push_back({u / r.buds[i], node, u});
  }

  auto unranked = rank.begin();
  if (tip_first) {  // apical control
    std::rotate(rank.begin(), rank.end() - 1, rank.end());
    ++unranked;
  }
  const double kN = p.k * static_cast<double>(rank.size());
  const auto favoured = rank.begin() + std::min(static_cast<std::ptrdiff_t>(rank.size()),
                                                static_cast<std::ptrdiff_t>(std::max(kN, 1.0)));
  if (unranked < favoured)
    std::partial_sort(unranked, favoured, rank.end(), [](const Ranked& a, const Ranked& b) {
      return a.worth > b.worth || (a.worth == b.worth && a.node < b.node);
    });
  double sum = 0;
  for (std::size_t j = 0; j < rank.size(); ++j) {
    const double place = static_cast<double>(j + 1);
    double w = kLastWeight;
    if (j == 0)
      w = kFirstWeight;
    else if (place <= kN && rank.size() > 2)
      w = kFirstWeight + (kLastWeight - kFirstWeight) * (place - 1) / (kN - 1);
    rank[j].u *= w;
    sum += rank[j].u;
  }
  const double scale = sum > 0 ? V / sum : 0;
  for (const Ranked& ranked : rank)
    if (ranked.node >= 0) r.got[static_cast<std::size_t>(ranked.node)] = ranked.u * scale;
}

bool may_sprout(const Stand& stand, const IgmParameters& p, std::size_t node) {
  return stand.nodes.laterals[node] == 0 &&
         stand.axes.order[static_cast<std::size_t>(stand.nodes.axis[node])] < p.max_order;
}

// Shoots at a node and internodes per shoot (Yi 2018, 4.3; numbers of shoots from the authors' program).
Sprout shoots_of(const Stand& stand, std::int32_t node, double v, double cap) {
  const auto i = static_cast<std::size_t>(node);
  const bool trunk = stand.axes.order[static_cast<std::size_t>(stand.nodes.axis[i])] == 1;
  const bool tip = stand.is_tip(i);
  const int most = trunk ? (tip ? 4 : 3) : (tip ? 3 : 2);
  Sprout sprout{node, std::min(static_cast<int>(std::min(v, 1e6)), most), 0, 0};
  sprout.share = v / sprout.shoots;
  const double wanted = trunk ? std::round(sprout.share) : std::floor(sprout.share);
  // One less: the program counts the node a shoot starts from.
  sprout.internodes = static_cast<int>(std::min({wanted, std::round(cap) - 1, 1e6}));
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
  Resource r;
  const std::vector<double> light = node_light(stand, cycle, r);
  collect(stand, light, r);
  std::vector<double> cap;
  for (const IgmParameters& p : stand.parameters) cap.push_back(p.cap(cycle));

  Decision decision;
  std::vector<Ranked> rank;
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
      V = p.alpha * (r.above[static_cast<std::size_t>(nodes[0])] + r.base[axis]);
    } else {
      const auto b = static_cast<std::size_t>(base);
      V = r.got[b] * r.axis_buds[axis] / r.buds[b];
    }
    share_axis(stand, p, axis, V, base < 0 && cycle - 1 <= p.tau, r, rank);
    for (const std::int32_t node : nodes) {
      const auto i = static_cast<std::size_t>(node);
      if (r.got[i] < 1 || !may_sprout(stand, p, i)) continue;
      const Sprout sprout = shoots_of(stand, node, r.got[i], limit);
      if (sprout.internodes >= 1)
        decision.sprouts.push_back(sprout);
      else
        decision.held_by_cap = true;
    }
  }
  return decision;
}

}  // namespace dendrofit::igm
