// SPDX-License-Identifier: GPL-3.0-or-later
// Do views and poses belong together? What their common hull leaves unexplained of the masks tells.
#pragma once

#include "core/photograph.h"
#include "core/progress.h"
#include "recon/image_carve.h"
#include "recon/image_outline.h"

#include <optional>
#include <vector>

namespace dendrofit {

inline constexpr double kAgreeingShare = 0.85;  ///< of each mask that the hull must explain

struct Agreement {
  Hull hull;
  double tolerance_px = 0;
  std::vector<double> shares;  ///< of each view's mask that the hull covers
  double least() const;
  double mean() const;
  bool good() const { return least() >= kAgreeingShare; }
};

/// Carves and looks how much of each mask the hull explains.
Agreement agreement(const std::vector<Camera>& cameras, const std::vector<Outline>& outlines,
                    const CarveOptions& options, Progress& progress = no_progress());

struct OddView {
  std::size_t view = 0;
  double own_share = 0;     ///< of its mask that the others' hull explains
  double others_share = 0;  ///< the least of the others', once it is left out
};

/// The view without which the others agree (each explained to kAgreeingShare) where with it they do not; none
/// where no single view is to blame. Needs four views or more.
std::optional<OddView> find_odd_view(const std::vector<Camera>& cameras, const std::vector<Outline>& outlines,
                                     CarveOptions options, Progress& progress = no_progress());

}  // namespace dendrofit
