// SPDX-License-Identifier: GPL-3.0-or-later
// How near a tree reconstructed from photographs comes to the one that was photographed.
#pragma once

#include "core/photograph.h"
#include "core/tree.h"

#include <optional>

namespace dendrofit::bench {

struct PhotoScore {
  double precision = 0, recall = 0, f = 0;  ///< axes of wood with r >= 5 mm, within 2 cm + the true radius
  double parents = 0;                       ///< true axes with r >= 1 cm that grow from the right axis
  int parents_tested = 0;
  double height_error = 0;  ///< relative
  std::optional<double> dbh_error_m;
  double true_dbh_m = 0;
  double radius_bias = 0;  ///< median relative error, r >= 1 cm
  double iou = 0;          ///< of the reprojected wood with the true masks, mean over views
  double near_precision = 0, near_recall = 0;  ///< of the reprojected pixels within 1 px
};

/// `views` are those the tree was photographed with (true poses); empty: no reprojection.
PhotoScore score_tree(const Tree& model, const Tree& truth, const ViewSet& views);

}  // namespace dendrofit::bench
