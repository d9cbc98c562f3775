// SPDX-License-Identifier: GPL-3.0-or-later
// An ellipse through points about a closed curve.
#pragma once

#include <optional>
#include <span>

#include <Eigen/Core>

namespace dendrofit {

struct EllipseFit {
  double longest = 0;   ///< diameter
  double shortest = 0;  ///< diameter
};

/// Direct least squares (Fitzgibbon, Pilu & Fisher 1999, in Halir & Flusser's stable form). None for fewer
/// than eight points or where no ellipse fits.
std::optional<EllipseFit> fit_ellipse(std::span<const Eigen::Vector2d> points);

}  // namespace dendrofit
