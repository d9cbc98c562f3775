// SPDX-License-Identifier: GPL-3.0-or-later
// The few words every floor shares.
#pragma once

#include <Eigen/Core>

namespace dendrofit {

/// A position or direction in metres; z points up.
using Vec3 = Eigen::Vector3d;

/// A value with an interval (95 % unless the owner says otherwise).
struct Interval {
  double value = 0;
  double lo = 0;
  double hi = 0;
};

}  // namespace dendrofit
