// SPDX-License-Identifier: GPL-3.0-or-later
// What makes the leaves of a species: shape, size, how they stand on twigs. Presets say where their numbers
// are from.
#pragma once

#include "core/foliage.h"
#include "forward/leaves/distribution.h"

#include <string>
#include <string_view>
#include <vector>

namespace dendrofit {

/// Blade length of single leaves, metres.
struct LengthLaw {
  enum class Kind { constant, uniform, normal, lognormal };
  Kind kind = Kind::normal;
  double mean_m = 0.08;
  double sd_m = 0.015;  ///< normal and lognormal
  double min_m = 0.04;  ///< uniform: lower end; others: cut here
  double max_m = 0.12;
  void validate() const;
  double density(double length_m) const;
};

/// The compass direction a blade's upper side leans to.
struct AzimuthLaw {
  enum class Kind {
    outward,  ///< that of the petiole: the blade hangs outward from its twig, spread by `concentration`
    uniform,  ///< any
    towards   ///< `mean_deg`, spread by `concentration`: sun-facing
  };
  Kind kind = Kind::outward;
  double mean_deg = 180;     ///< clockwise from north (+y); towards only
  double concentration = 4;  ///< von Mises kappa
  void validate() const;
};

/// The order of leaves along an axis; it runs on from cylinder to cylinder.
struct Phyllotaxis {
  int leaves_per_node = 1;        ///< 1 alternate, 2 opposite, 3 and more whorled or in tufts
  double divergence_deg = 137.5;  ///< turn from node to node (180: two rows; 90 with two a node: decussate)
  double jitter_deg = 10;         ///< standard deviation about it
  bool two_rows_level =
      false;  ///< on slanting twigs the first leaf stands sideways, so that two rows lie level
  void validate() const;
};

/// Which wood bears leaves, and how densely: relative leaf area per metre of wood. Where the model has no
/// wood as thin as `twig_radius_m`, the thinnest part of what it has bears instead.
struct Bearing {
  double twig_radius_m = 0.005;      ///< wood up to here bears fully
  double max_radius_m = 0.02;        ///< from here on nothing; linear between
  double full_tip_distance_m = 0.6;  ///< distance to the axis' tip up to which it bears fully
  double bare_share = 0.1;           ///< share left far from any tip
  void validate() const;
};

/// One of the shapes a species mixes, and how often it occurs.
struct LeafShapeShare {
  LeafShape shape;
  double share = 1;
};

struct LeafTraits {
  std::string name;
  std::string source;  ///< where the numbers are from
  std::vector<LeafShapeShare> shapes;
  LengthLaw length;
  double petiole_min_m = 0.02;
  double petiole_max_m = 0.05;
  double insertion_deg = 50;  ///< petiole from the twig's axis
  double insertion_sd_deg = 10;
  double petiole_rise = 0.3;  ///< 0: as inserted; 1: turned straight up
  InclinationLaw inclination;
  AzimuthLaw azimuth;
  Phyllotaxis phyllotaxis;
  Bearing bearing;
  double usual_lai = 4;            ///< one-sided leaf area over crown projection, of a full crown
  double most_per_metre_m2 = 0.6;  ///< leaf area a metre of twig carries at most unless asked for more
  void validate() const;
  double mean_leaf_area_m2() const;
};

/// "broadleaf" (the default), "oak", "maple", "beech", "ash", ...; throws InputError naming the nearest
/// known.
LeafTraits leaf_traits(std::string_view species);
std::vector<std::string> leaf_species();

}  // namespace dendrofit
