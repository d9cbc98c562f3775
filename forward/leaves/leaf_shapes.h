// SPDX-License-Identifier: GPL-3.0-or-later
// Leaf blades as a few triangles, in the frame core/foliage.h defines.
#pragma once

#include "core/foliage.h"
#include "core/mesh.h"

#include <string_view>
#include <vector>

namespace dendrofit {

/// How a blade is bent out of its plane.
struct LeafCurvature {
  double fold_deg = 20;  ///< each half rises this much from the midrib
  double droop_deg = 0;  ///< turn of the midrib from base to tip, downwards
  void validate() const;
};

/// An entire blade: pointed, widest at `widest` (0..1) of its length; six triangles (twelve where it droops).
LeafShape simple_leaf(double width, double widest = 0.4, const LeafCurvature& curvature = {});
/// A blade of `lobes` rounded lobes a side along the midrib (oak).
LeafShape lobed_leaf(double width, int lobes, const LeafCurvature& curvature = {});
/// A blade of pointed lobes spreading from its base (maple): `lobes` is odd.
LeafShape palmately_lobed_leaf(double width, int lobes, const LeafCurvature& curvature = {});
/// Leaflets in pairs along a rachis, with one at the end (ash, coffeetree).
LeafShape pinnate_leaf(int pairs, double leaflet_length, double leaflet_width);
/// Leaflets spreading from the petiole's end (horse chestnut).
LeafShape palmate_leaf(int leaflets, double leaflet_width);
/// A short shoot that bears `needles` needles around a thin axis; one triangle each.
LeafShape needle_shoot(int needles, double needle_length, double needle_width);
/// A bundle of needles from one point (pine fascicles, larch short shoots).
LeafShape needle_bundle(int needles, double needle_width, double spread_deg);
/// A flower: `petals` petals of two triangles each about a small centre of four.
LeafShape flower(int petals);

/// The user's own blade: any mesh whose petiole joins at the origin with +y to the tip and +z up. Scaled so
/// that it is 1 long. Throws InputError for an empty, flat-to-nothing or not finite mesh; triangles without
/// area are dropped.
LeafShape leaf_shape_from_mesh(const TriangleMesh& mesh, std::string_view name);

}  // namespace dendrofit
