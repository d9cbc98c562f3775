// SPDX-License-Identifier: GPL-3.0-or-later
#include "recon/image_agreement.h"

#include <algorithm>
#include <numeric>

namespace dendrofit {

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

std::optional<OddView> find_odd_view(const std::vector<Camera>& cameras, const std::vector<Outline>& outlines,
                                     CarveOptions options, Progress& progress) {
  if (cameras.size() < 4 || cameras.size() > 64) return std::nullopt;
  options.misses_allowed = 1;
  const Hull hull = carve(cameras, outlines, options, progress);
  std::optional<OddView> odd;
  for (std::size_t v = 0; v < cameras.size(); ++v) {
    // The hull of all views but v: what lies outside no mask, or outside v's alone.
    std::vector<Vec3> cells;
    for (std::size_t c = 0; c < hull.cells.size(); ++c)
      if ((hull.misses[c] & ~(std::uint64_t{1} << v)) == 0) cells.push_back(hull.cells[c]);
    if (cells.empty()) continue;
    const std::vector<double> shares =
        explained_shares(cells, hull.cell_m, cameras, outlines, options.threads);
    OddView candidate{v, shares[v], 1};
    for (std::size_t i = 0; i < shares.size(); ++i)
      if (i != v) candidate.others_share = std::min(candidate.others_share, shares[i]);
    if (candidate.own_share < kAgreeingShare && candidate.others_share >= kAgreeingShare &&
        (!odd || candidate.others_share - candidate.own_share > odd->others_share - odd->own_share))
      odd = candidate;
  }
  return odd;
}

}  // namespace dendrofit
