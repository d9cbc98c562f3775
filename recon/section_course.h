// SPDX-License-Identifier: GPL-3.0-or-later
// Where thick wood goes on from one section to the next.
#pragma once

#include "core/types.h"
#include "recon/sections.h"

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace dendrofit {

struct CoursePlace {
  Vec3 centre = Vec3::Zero();
  Vec3 direction = Vec3::UnitZ();
  double radius_m = 0;
};

/// The next place of the wood of section `from`, of which `members` are the points. Where they make a whole
/// circle of their own that is clearly thinner (beyond a fork into limbs of one thickness, or a branch that
/// took half of the wood), it is that circle; else the circle that they and the prolonged cylinder make most
/// likely: a strip of the surface is enough to keep the course, since the radius hardly changes from one
/// section to the next, and branches that leave within the group get no weight (Tukey). None: the points lie
/// neither on their own circle nor on the forecast.
std::optional<CoursePlace> next_on_course(const std::vector<Vec3>& points,
                                          std::span<const std::uint32_t> members, const Section& from,
                                          double spacing_m);

}  // namespace dendrofit
