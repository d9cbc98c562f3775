// SPDX-License-Identifier: GPL-3.0-or-later
// What foresters measure on a tree, computed from its cylinders.
#pragma once

#include "core/tree.h"
#include "core/types.h"

#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace dendrofit {

struct TaperPoint {
  double height_m = 0;    ///< above the tree's foot
  double diameter_m = 0;  ///< of the stem there
};

/// Leaf points of a scan in a layer of the crown.
struct LeafLayer {
  double from_m = 0;  ///< above the foot
  double to_m = 0;
  std::size_t points = 0;
};

/// The content of metrics.json. "Stem" is the order-0 axis (all of them, where several stems share a foot).
struct TreeMetrics {
  double height_m = 0;                 ///< highest wood (of a scan in leaf: top shoot) above the foot
  std::optional<double> dbh_m;         ///< none for a tree that does not reach dbh_height_m
  double dbh_height_m = 1.3;           ///< above the foot, along the vertical
  std::optional<double> dbh_coverage;  ///< share of the girth there that holds points
  std::vector<double> dbh_ellipse_m;  ///< longest and shortest diameter there; empty where not seen all round
  double stem_volume_m3 = 0;
  double branch_volume_m3 = 0;
  double total_volume_m3 = 0;
  double wood_area_m2 = 0;  ///< lateral surface of all cylinders
  double total_length_m = 0;
  std::optional<double> crown_base_m;  ///< lowest living first-order branch (see metrics.cpp), above the foot
  double crown_diameter_m = 0;         ///< mean calliper width of the crown's plan hull (perimeter / pi)
  double crown_area_m2 = 0;            ///< plan hull of wood and foliage from the crown base upwards
  double crown_volume_m3 = 0;          ///< 3-D hull of the same
  double lean_deg = 0;                 ///< of the line from foot to stem tip, from the vertical: 0 to 180
  double lean_azimuth_deg = 0;         ///< where it leans to, clockwise from +y (grid north): 0 to 360
  std::vector<int> branch_count_by_order;  ///< [0] = stems
  std::vector<double> length_by_order_m;
  std::vector<double> volume_by_order_m3;
  std::vector<double> branch_angle_by_order_deg;    ///< mean, between branch and bearer at its base; [0] = 0
  double diameter_class_m = 0.02;                   ///< width of the classes
  std::vector<double> volume_by_diameter_class_m3;  ///< from 0
  std::vector<TaperPoint> stem_taper;  ///< every 0.1 m of height on the main stem (0.5 m on tall trees)
  std::map<std::string, Interval>
      intervals;  ///< 95 %: dbh_m, height_m, stem_volume_m3, total_volume_m3 where estimated
  std::optional<double> wood_share;     ///< share of the scan's points taken for wood
  std::vector<LeafLayer> leaf_profile;  ///< of a scan in leaf
};

struct MetricsOptions {
  double dbh_height_m = 1.3;
  void validate() const;
};

/// `foliage` are points on leaves (local coordinates of the tree), which belong to the crown. Throws
/// InputError for an empty tree.
TreeMetrics measure(const Tree& tree, const MetricsOptions& options = {},
                    const std::vector<Vec3>& foliage = {});

/// Layers of half a metre from the lowest leaf to the highest.
std::vector<LeafLayer> leaf_layers(const std::vector<Vec3>& leaves, double foot_z);

/// Diameter of the stem at `height_m` above the foot, interpolated between the midpoints of neighbouring
/// cylinders; none where no stem reaches. Several stems: of the thickest there.
std::optional<double> stem_diameter(const Tree& tree, double height_m);

/// Lowest z of any root's start (local coordinates): the foot heights are measured from.
double foot_height(const Tree& tree);

}  // namespace dendrofit
