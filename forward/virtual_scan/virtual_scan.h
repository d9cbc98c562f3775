// SPDX-License-Identifier: GPL-3.0-or-later
// A terrestrial laser scanner for trees that exist as cylinders: rays against the wood, the leaves and the
// ground, with the errors of a real instrument. Closes the loop: what is grown can be scanned, and the truth
// of every point is known.
#pragma once

#include "core/foliage.h"
#include "core/point_cloud.h"
#include "core/progress.h"
#include "core/tree.h"

#include <cstdint>
#include <optional>
#include <vector>

namespace dendrofit {

/// Classes of a virtual scan's points (LAS codes; 20 is free in every point format).
enum class ScanClass : std::uint8_t { ground = 2, grass = 3, leaf = 5, wood = 20 };

struct ScanOptions {
  /// Instrument positions (the tree's local frame). Empty: `stations` of them evenly around the tree's foot.
  std::vector<Vec3> positions;
  int stations = 4;
  double distance_m = 8;             ///< from the foot to each station
  double instrument_height_m = 1.6;  ///< above the ground it stands on
  double first_azimuth_deg = 0;
  double step_deg = 0.08;        ///< between neighbouring beams, both ways
  double divergence_mrad = 0.3;  ///< full angle of the beam
  double exit_diameter_m = 0.005;
  int rays_per_beam = 7;  ///< sub-rays that fill the footprint; 1: an ideal line
  /// Sub-ray ranges closer than this to the next merge into one return at their mean: the mixed pixel.
  double range_resolution_m = 0.05;
  int max_returns = 1;                ///< of one beam, nearest first
  double range_noise_m = 0.002;       ///< standard deviation along the beam
  double registration_error_m = 0;    ///< standard deviation of each station's shift, each axis
  double registration_error_deg = 0;  ///< standard deviation of each station's turn about the vertical
  double drop_out = 0;                ///< share of beams lost
  double max_range_m = 100;
  bool tapered = true;  ///< cones from one cylinder's radius to the next; false: plain cylinders
  std::optional<double> ground_radius_m = 5;  ///< disc of ground about the foot; none: no ground
  double ground_slope_deg = 0;                ///< rising towards +x; stations stand on it
  /// Of grass on the ground: three rays in four end in it, at any height up to this.
  double grass_height_m = 0;
  int threads = 0;
  std::uint64_t seed = 1;

  /// Throws InputError naming field, value and limit.
  void validate() const;
};

/// Points with their truth; every column as long as cloud.points. Intensity is the share of the beam's
/// footprint.
struct VirtualScan {
  PointCloud cloud;                ///< classification holds ScanClass
  std::vector<std::int32_t> node;  ///< cylinder hit, -1 where it was not wood
  std::vector<std::int32_t> leaf;  ///< leaf hit, -1 where it was not a leaf
  std::vector<std::uint16_t> station;
  std::vector<float> range_error_m;  ///< of the range: noise and mixing (0 for an ideal instrument)
  std::vector<Vec3> positions;       ///< true instrument positions
};

/// Scans a tree (with `foliage` unless null) from every station. Throws InputError for an empty tree, foliage
/// in another frame, or from options.validate(). The same whatever the number of threads.
VirtualScan scan_tree(const Tree& tree, const Foliage* foliage = nullptr, const ScanOptions& options = {},
                      Progress& progress = no_progress());

}  // namespace dendrofit
