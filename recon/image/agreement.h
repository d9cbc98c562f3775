// SPDX-License-Identifier: GPL-3.0-or-later
// Do views and poses belong together? What their common hull leaves unexplained of the masks tells.
#pragma once

#include "core/photograph.h"
#include "core/progress.h"
#include "recon/image/carve.h"
#include "recon/image/outline.h"

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
  double explained = 0;  ///< share of its mask that the others' hull covers
  double missing = 0;    ///< share of the others' hull that lies outside its mask
};

/// Views without which the others agree better: at most a quarter of them, and three. From a coarse carving
/// that lets cells lie outside some masks, the sets of views that most cells miss, and single views, are
/// tried; one is left out where the others' masks are then explained better by 3 % on average. Needs four
/// views; more than 64 are not searched.
std::vector<OddView> find_odd_views(const std::vector<Camera>& cameras, const std::vector<Outline>& outlines,
                                    const CarveOptions& options, Progress& progress = no_progress());

}  // namespace dendrofit
