// SPDX-License-Identifier: GPL-3.0-or-later
// Which coordinates a file may hold.
#pragma once

#include "core/types.h"

namespace dendrofit {

/// Metres. No place on Earth has larger coordinates: beyond it a file is damaged, or its units are others.
constexpr double kLargestCoordinate = 1e9;

/// Finite, and not beyond kLargestCoordinate.
inline bool is_place(const Vec3& position) {
  return position.allFinite() && position.cwiseAbs().maxCoeff() <= kLargestCoordinate;
}

}  // namespace dendrofit
