// SPDX-License-Identifier: GPL-3.0-or-later
// What foresters measure on a tree, computed from its cylinders.
#pragma once

#include "core/tree.h"
#include "core/types.h"

#include <map>
#include <optional>
#include <string>
#include <vector>

namespace dendrofit {

struct TaperPoint {
  double height_m = 0;    ///< above the tree's foot
  double diameter_m = 0;  ///< of the stem there
};

/// The content of metrics.json. "Stem" is the order-0 axis (all of them, where several stems share a foot).
struct TreeMetrics {
  double height_m = 0;          ///< highest wood above the foot
  std::optional<double> dbh_m;  ///< none for a tree that does not reach dbh_height_m
  double dbh_height_m = 1.3;    ///< above the foot, along the vertical
  double stem_volume_m3 = 0;
  double branch_volume_m3 = 0;
  double total_volume_m3 = 0;
  double wood_area_m2 = 0;  ///< lateral surface of all cylinders
  double total_length_m = 0;
  std::optional<double> crown_base_m;  ///< lowest living first-order branch (see metrics.cpp), above the foot
  double crown_diameter_m = 0;         ///< mean calliper width of the crown's plan hull (perimeter / pi)
  double crown_area_m2 = 0;            ///< plan hull
  double crown_volume_m3 = 0;          ///< 3-D hull of the wood above the crown base
  double lean_deg = 0;                 ///< of the line from foot to stem tip, from the vertical
  std::vector<int> branch_count_by_order;  ///< [0] = stems
  std::vector<double> length_by_order_m;
  std::vector<double> volume_by_order_m3;
  std::vector<double> volume_by_diameter_class_m3;  ///< classes of 2 cm, from 0
  std::vector<TaperPoint> stem_taper;  ///< every 0.1 m of height on the main stem (0.5 m on tall trees)
  std::map<std::string, Interval>
      intervals;  ///< 95 %: dbh_m, height_m, stem_volume_m3, total_volume_m3 where estimated
  std::optional<double> wood_share;  ///< share of the scan's points taken for wood
};

struct MetricsOptions {
  double dbh_height_m = 1.3;
  void validate() const;
};

/// Throws InputError for an empty tree.
TreeMetrics measure(const Tree& tree, const MetricsOptions& options = {});

/// Diameter of the stem at `height_m` above the foot, interpolated between the midpoints of neighbouring
/// cylinders; none where no stem reaches. Several stems: of the thickest there.
std::optional<double> stem_diameter(const Tree& tree, double height_m);

/// Lowest z of any root's start (local coordinates): the foot heights are measured from.
double foot_height(const Tree& tree);

}  // namespace dendrofit
