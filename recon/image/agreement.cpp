// SPDX-License-Identifier: GPL-3.0-or-later
#include "recon/image/agreement.h"

#include "core/parallel.h"

#include <algorithm>
#include <bit>
#include <map>
#include <numeric>

namespace dendrofit {
namespace {

using ViewBits = std::uint64_t;
constexpr int kBlockPx = 4;            // masks are compared in blocks of pixels
constexpr double kLeastGain = 0.03;    // of the mean share
constexpr std::size_t kMostSets = 24;  // tried at a time, besides single views
constexpr std::uint32_t kNowhere = 0xffffffffU;

ViewBits bit(std::size_t view) {
  return ViewBits{1} << view;
}

/// Which blocks of each view's picture belong to the mask, and which each cell of a hull covers.
class BlockView {
 public:
  BlockView(const Hull& hull, const Camera& camera, const Outline& outline)
      : columns_((outline.width() + kBlockPx - 1) / kBlockPx),
        rows_((outline.height() + kBlockPx - 1) / kBlockPx) {
    mask_.assign(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_), 0);
    for (int y = 0; y < outline.height(); ++y)
      for (int x = 0; x < outline.width(); ++x)
        if (outline.inside(x, y)) mask_[index(x / kBlockPx, y / kBlockPx)] = 1;
    blocks_ = static_cast<double>(std::count(mask_.begin(), mask_.end(), 1));
    for (const Vec3& cell : hull.cells) {
      const auto pixel = camera.project(cell);
      const bool seen = pixel && outline.holds(*pixel);
      block_.push_back(seen ? index(std::min(columns_ - 1, static_cast<int>(pixel->x()) / kBlockPx),
                                    std::min(rows_ - 1, static_cast<int>(pixel->y()) / kBlockPx))
                            : kNowhere);
    }
  }
  /// Share of the mask's blocks that cells missed by nobody but `dropped` touch (or lie beside).
  double share(const std::vector<ViewBits>& misses, ViewBits dropped) const {
    std::vector<char> touched(mask_.size(), 0);
    for (std::size_t c = 0; c < block_.size(); ++c)
      if (block_[c] != kNowhere && (misses[c] & ~dropped) == 0) touched[block_[c]] = 1;
    double both = 0;
    for (int y = 0; y < rows_; ++y)
      for (int x = 0; x < columns_; ++x) {
        if (!mask_[index(x, y)]) continue;
        bool near = false;
        for (int b = std::max(0, y - 1); b <= std::min(rows_ - 1, y + 1); ++b)
          for (int a = std::max(0, x - 1); a <= std::min(columns_ - 1, x + 1); ++a)
            near = near || touched[index(a, b)];
        both += near;
      }
    return blocks_ > 0 ? both / blocks_ : 0;
  }

 private:
  std::uint32_t index(int column, int row) const {
    return static_cast<std::uint32_t>(row) * static_cast<std::uint32_t>(columns_) +
           static_cast<std::uint32_t>(column);
  }
  int columns_, rows_;
  double blocks_ = 0;
  std::vector<char> mask_;
  std::vector<std::uint32_t> block_;
};

/// Mean share over the views that are not in `without`, explained by what only `dropped` miss.
double mean_share(const std::vector<BlockView>& views, const std::vector<ViewBits>& misses, ViewBits dropped,
                  ViewBits without) {
  double sum = 0, count = 0;
  for (std::size_t v = 0; v < views.size(); ++v) {
    if (without & bit(v)) continue;
    sum += views[v].share(misses, dropped);
    ++count;
  }
  return count > 0 ? sum / count : 0;
}

/// Sets of views that many cells miss together, the most frequent first, then single views.
std::vector<ViewBits> suspects(const std::vector<ViewBits>& misses, std::size_t views) {
  std::map<ViewBits, std::size_t> counts;
  for (const ViewBits m : misses)
    if (m != 0) ++counts[m];
  std::vector<std::pair<ViewBits, std::size_t>> sorted(counts.begin(), counts.end());
  std::stable_sort(sorted.begin(), sorted.end(),
                   [](const auto& a, const auto& b) { return a.second > b.second; });
  std::vector<ViewBits> sets;
  for (std::size_t k = 0; k < std::min(kMostSets, sorted.size()); ++k) sets.push_back(sorted[k].first);
  for (std::size_t v = 0; v < views; ++v)
    if (std::find(sets.begin(), sets.end(), bit(v)) == sets.end()) sets.push_back(bit(v));
  return sets;
}

}  // namespace

double Agreement::least() const {
  return shares.empty() ? 0 : *std::min_element(shares.begin(), shares.end());
}

double Agreement::mean() const {
  return shares.empty()
             ? 0
             : std::accumulate(shares.begin(), shares.end(), 0.0) / static_cast<double>(shares.size());
}

Agreement agreement(const std::vector<Camera>& cameras, const std::vector<Outline>& outlines,
                    const CarveOptions& options, Progress& progress) {
  Agreement result;
  result.tolerance_px = options.tolerance_px;
  result.hull = carve(cameras, outlines, options, progress);
  result.shares = explained_shares(result.hull.cells, result.hull.cell_m, cameras, outlines, options.threads);
  return result;
}

std::vector<OddView> find_odd_views(const std::vector<Camera>& cameras, const std::vector<Outline>& outlines,
                                    const CarveOptions& options, Progress& progress) {
  std::vector<OddView> odd;
  if (cameras.size() < 4 || cameras.size() > 64) return odd;
  CarveOptions coarse = options;
  coarse.cell_m *= 3;
  coarse.tolerance_px += 2;
  coarse.misses_allowed = static_cast<int>(std::min<std::size_t>(3, cameras.size() / 4));
  const Hull hull = carve(cameras, outlines, coarse, progress);
  std::vector<BlockView> views;
  for (std::size_t v = 0; v < cameras.size(); ++v) views.emplace_back(hull, cameras[v], outlines[v]);
  const std::vector<ViewBits> sets = suspects(hull.misses, cameras.size());
  ViewBits dropped = 0;
  while (std::popcount(dropped) < coarse.misses_allowed) {
    std::vector<double> gain(sets.size(), -1);
    parallel_blocks(sets.size(), 1, options.threads, [&](std::size_t first, std::size_t end) {
      for (std::size_t k = first; k < end; ++k) {
        const ViewBits all = dropped | sets[k];
        if (all == dropped || std::popcount(all) > coarse.misses_allowed) continue;
        progress.check();
        // Against the same views' masks, and against all those in use so far.
        gain[k] =
            std::max(
                mean_share(views, hull.misses, all, all) - mean_share(views, hull.misses, dropped, all),
                mean_share(views, hull.misses, all, all) - mean_share(views, hull.misses, dropped, dropped)) /
            std::popcount(all & ~dropped);
      }
    });
    const auto best = std::max_element(gain.begin(), gain.end());
    if (best == gain.end() || *best < kLeastGain) break;
    dropped |= sets[static_cast<std::size_t>(best - gain.begin())];
  }
  std::size_t held = 0;
  for (const ViewBits m : hull.misses) held += (m & ~dropped) == 0;
  for (std::size_t v = 0; v < cameras.size(); ++v) {
    if (!(dropped & bit(v))) continue;
    std::size_t missing = 0;
    for (const ViewBits m : hull.misses) missing += (m & ~dropped) == 0 && (m & bit(v)) != 0;
    odd.push_back({v, views[v].share(hull.misses, dropped),
                   static_cast<double>(missing) / static_cast<double>(std::max<std::size_t>(1, held))});
  }
  return odd;
}

}  // namespace dendrofit
