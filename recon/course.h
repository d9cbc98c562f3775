// SPDX-License-Identifier: GPL-3.0-or-later
// How thick wood goes on from one section to the next.
#pragma once

#include "core/types.h"
#include "recon/sections.h"

#include <cstdint>
#include <span>
#include <vector>

namespace dendrofit {

/// Number of 24 sectors of the section's prolonged surface in which `members` of the points lie.
int surface_sectors(const std::vector<Vec3>& points, std::span<const std::uint32_t> members, const Section& s,
                    double noise_m);

/// Thick wood goes on as the parent's cylinder foretells: the circle that its points and that forecast make
/// most likely. A strip of the surface is enough to keep the course, since the radius hardly changes from
/// one section to the next; branches that leave within the group get no weight (Tukey).
/// Sets centre, radius and direction of `s` and returns true where enough of `members` lie on
/// that surface and few within: wood is hollow to a scanner, a crown's twigs are not.
bool follow_course(const std::vector<Vec3>& points, std::span<const std::uint32_t> members,
                   const Section& parent, double spacing_m, Section& s);

}  // namespace dendrofit
