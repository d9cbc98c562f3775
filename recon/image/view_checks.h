// SPDX-License-Identifier: GPL-3.0-or-later
// What must hold of a set of views, what to tell the user about it, and the measures a tree from views gets.
#pragma once

#include "core/photograph.h"
#include "recon/image/outline.h"
#include "recon/reconstruct.h"

#include <string>
#include <vector>

namespace dendrofit {

/// Throws InputError for fewer than two views, a set without a unit of length, or a broken view.
void check_views(const ViewSet& set);

/// Throws InputError where all views look at the tree from one side: lines of sight within 3 degrees of each
/// other show no depth, most of all those of one camera centre.
void check_depth(const std::vector<Camera>& cameras, const std::vector<Outline>& outlines);

/// The view's mask, or its segmentation; what that has to say is added to `warnings`, led by the view's name.
/// Throws SolverError naming the view where no tree stands out.
Outline outline_of(const View& view, std::vector<std::string>& warnings);

/// Adds a warning for trees cut by the upper rim or the sides of the pictures.
void warn_of_borders(const ViewSet& set, const std::vector<Outline>& outlines,
                     std::vector<std::string>& warnings);

/// Where the views' feet agree (foot.h), one whose mask ends above them has lost its stem: it is made to say
/// nothing below what it shows, and named in a warning.
void excuse_lost_feet(const ViewSet& set, const std::vector<Camera>& cameras, std::vector<Outline>& outlines,
                      std::vector<std::string>& warnings);

std::string odd_view_warning(const ViewSet& set, std::size_t view, double explained, double missing);
std::string coarse_warning(double cell_m);
std::string disagreement_warning(const ViewSet& set, const std::vector<std::size_t>& views,
                                 const std::vector<double>& shares);

/// Share of each mask that the tree's own picture covers.
std::vector<double> covered_shares(const Tree& tree, const std::vector<Camera>& cameras,
                                   const std::vector<Outline>& outlines, int threads);

/// Metrics with intervals: an edge is known to a fraction of a pixel, a length to how its radii are.
void measure_from_views(Reconstruction& model, const std::vector<Camera>& cameras, double dbh_height_m);

}  // namespace dendrofit
