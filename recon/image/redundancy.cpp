// SPDX-License-Identifier: GPL-3.0-or-later
#include "recon/image/redundancy.h"

#include "core/parallel.h"
#include "core/tree_topology.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>

namespace dendrofit {
namespace {

constexpr double kExposed = 1.0 / 3;
constexpr int kViews = 2;
constexpr int kStations = 3;  // of a cylinder's middle line

/// An unbranched run between forks, or from one to a tip.
struct Chain {
  std::vector<std::int32_t> nodes;
  std::int32_t parent = -1;  ///< chain
};

std::vector<Chain> chains_of(const Tree& tree) {
  const TreeChildren children(tree);
  std::vector<Chain> chains;
  std::vector<std::int32_t> chain_of(tree.size());
  for (std::size_t i = 0; i < tree.size(); ++i) {
    const std::int32_t p = tree.parent[i];
    if (p >= 0 && children.of(static_cast<std::size_t>(p)).size() == 1) {
      chain_of[i] = chain_of[static_cast<std::size_t>(p)];
    } else {
      chain_of[i] = static_cast<std::int32_t>(chains.size());
      chains.push_back({{}, p < 0 ? -1 : chain_of[static_cast<std::size_t>(p)]});
    }
    chains[static_cast<std::size_t>(chain_of[i])].nodes.push_back(static_cast<std::int32_t>(i));
  }
  return chains;
}

/// One view's count of chains over each pixel, with each chain's pixels and the places of its middle line.
struct Coverage {
  std::vector<std::uint16_t> count;
  std::vector<std::vector<std::uint32_t>> pixels;    // by chain, each once
  std::vector<std::vector<std::uint32_t>> stations;  // by chain
};

Coverage cover(const Tree& tree, const std::vector<Chain>& chains, const Camera& camera) {
  const auto width = static_cast<std::size_t>(camera.width);
  Coverage view;
  view.count.assign(width * static_cast<std::size_t>(camera.height), 0);
  view.pixels.resize(chains.size());
  view.stations.resize(chains.size());
  const auto index = [&](int x, int y) {
    return static_cast<std::uint32_t>(static_cast<std::size_t>(y) * width + static_cast<std::size_t>(x));
  };
  for (std::size_t a = 0; a < chains.size(); ++a) {
    std::vector<std::uint32_t>& mine = view.pixels[a];
    for (const std::int32_t node : chains[a].nodes) {
      const auto i = static_cast<std::size_t>(node);
      const auto from = camera.project(tree.start[i]), to = camera.project(tree.end[i]);
      if (!from || !to) continue;
      const double reach =
          std::max(0.71, tree.radius[i] * camera.fx / camera.depth(0.5 * (tree.start[i] + tree.end[i])));
      const Eigen::Vector2d run = *to - *from;
      const double square = std::max(1e-12, run.squaredNorm());
      const Eigen::Vector2d lo = from->cwiseMin(*to).array() - reach,
                            hi = from->cwiseMax(*to).array() + reach;
      for (int y = std::max(0, static_cast<int>(lo.y())); y <= std::min<double>(camera.height - 1, hi.y());
           ++y)
        for (int x = std::max(0, static_cast<int>(lo.x())); x <= std::min<double>(camera.width - 1, hi.x());
             ++x) {
          const Eigen::Vector2d p(x + 0.5, y + 0.5);
          const double t = std::clamp((p - *from).dot(run) / square, 0.0, 1.0);
          if ((*from + t * run - p).squaredNorm() <= reach * reach) mine.push_back(index(x, y));
        }
      for (int k = 0; k < kStations; ++k) {
        const Eigen::Vector2d p = *from + (k + 0.5) / kStations * run;
        const int x = static_cast<int>(std::floor(p.x())), y = static_cast<int>(std::floor(p.y()));
        if (x >= 0 && y >= 0 && x < camera.width && y < camera.height)
          view.stations[a].push_back(index(x, y));
      }
    }
    std::sort(mine.begin(), mine.end());
    mine.erase(std::unique(mine.begin(), mine.end()), mine.end());
    for (const std::uint32_t p : mine) ++view.count[p];
  }
  return view;
}

}  // namespace

std::vector<char> needed_by_views(const Tree& tree, const std::vector<Camera>& cameras, int threads) {
  const std::vector<Chain> chains = chains_of(tree);
  std::vector<Coverage> views(cameras.size());
  parallel_blocks(cameras.size(), 1, threads, [&](std::size_t first, std::size_t end) {
    for (std::size_t v = first; v < end; ++v) views[v] = cover(tree, chains, cameras[v]);
  });
  const std::vector<double> beyond = length_beyond(tree);
  std::vector<std::size_t> order(chains.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  const auto length_of = [&](std::size_t a) {
    return beyond[static_cast<std::size_t>(chains[a].nodes.front())];
  };
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return length_of(a) < length_of(b); });
  std::vector<char> bears(chains.size(), 0), keep(tree.size(), 1);
  for (const std::size_t a : order) {
    const std::int32_t bearer = chains[a].parent;
    int shown = bears[a] || bearer < 0 ? kViews : 0;
    for (const Coverage& view : views) {
      if (shown >= kViews) break;
      const auto& stations = view.stations[a];
      const auto free =
          std::count_if(stations.begin(), stations.end(), [&](auto p) { return view.count[p] <= 1; });
      shown +=
          !stations.empty() && static_cast<double>(free) >= kExposed * static_cast<double>(stations.size());
    }
    if (shown >= kViews) {
      if (bearer >= 0) bears[static_cast<std::size_t>(bearer)] = 1;
      continue;
    }
    for (const std::int32_t node : chains[a].nodes) keep[static_cast<std::size_t>(node)] = 0;
    for (Coverage& view : views)
      for (const std::uint32_t p : view.pixels[a]) --view.count[p];
  }
  return keep;
}

}  // namespace dendrofit
