// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/random.h"

#include <cmath>
#include <numbers>

namespace dendrofit {

double Random::normal() {
  const double radius = std::sqrt(-2.0 * std::log(1.0 - uniform()));
  return radius * std::cos(2.0 * std::numbers::pi * uniform());
}

Vec3 Random::direction() {
  const double z = uniform(-1.0, 1.0);
  const double azimuth = uniform(0.0, 2.0 * std::numbers::pi);
  const double rho = std::sqrt(1.0 - z * z);
  return {rho * std::cos(azimuth), rho * std::sin(azimuth), z};
}

}  // namespace dendrofit
