// SPDX-License-Identifier: GPL-3.0-or-later
// Colours that people with colour-blindness can tell apart, the same in pictures, plots and the 3-D view.
#pragma once

#include "cli/report/image.h"
#include "core/tree.h"

#include <array>
#include <string>
#include <vector>

namespace dendrofit {

/// What the colour of a piece of wood stands for.
enum class TreeColour { order, quality, radius, birth_cycle, bark };

/// Okabe and Ito's (2008) palette, dark to light hues in the order that branch orders use it: blue, orange,
/// green, ...
inline constexpr std::array<Rgb, 7> kOrderColours = {{{0, 90, 160},
                                                      {213, 94, 0},
                                                      {0, 120, 85},
                                                      {225, 150, 195},
                                                      {60, 145, 210},
                                                      {200, 145, 0},
                                                      {110, 110, 110}}};
inline constexpr Rgb kBark = {124, 98, 76};
inline constexpr Rgb kLeaf = {86, 140, 56};
inline constexpr Rgb kPetiole = {104, 92, 58};  ///< and the twigs that come with leaves
inline constexpr Rgb kScan = {104, 116, 134};

Rgb order_colour(int order);  ///< orders past the palette share its last colour
Rgb quality_colour(RadiusQuality quality);
Rgb scale_colour(double share);  ///< 0..1 on a dark-to-light scale (close to viridis); clamped, NaN is 0

/// One colour a cylinder. Radius runs on a logarithmic scale between the tree's 2 % and 98 % radii; birth
/// cycle from the first to the last known one.
std::vector<Rgb> tree_colours(const Tree& tree, TreeColour colour);

/// "#rrggbb".
std::string hex(Rgb colour);

}  // namespace dendrofit
