// SPDX-License-Identifier: GPL-3.0-or-later
// Small measurement series for tests: public facts (NIST StRD nonlinear problems) and simulated trees.
#pragma once

#include "core/measurements.h"
#include "core/random.h"
#include "forward/growth_equations.h"

#include <cmath>
#include <string>
#include <vector>

namespace dendrofit::test {

inline MeasurementSeries rat42() {
  return {"Rat42",
          {9, 14, 21, 28, 42, 57, 63, 70, 79},
          {8.930, 10.800, 18.590, 22.330, 39.350, 56.110, 61.730, 64.620, 67.080}};
}
inline MeasurementSeries rat43() {
  return {"Rat43",
          {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15},
          {16.08, 33.83, 65.80, 97.20, 191.55, 326.20, 386.87, 520.53, 590.03, 651.92, 724.93, 699.56, 689.96,
           637.56, 717.41}};
}
inline MeasurementSeries box_bod() {
  return {"BoxBOD", {1, 2, 3, 5, 7, 10}, {109, 149, 149, 191, 213, 224}};
}
inline MeasurementSeries misra1a() {
  return {"Misra1a",
          {77.6, 114.9, 141.1, 190.8, 239.9, 289.0, 332.8, 378.4, 434.8, 477.3, 536.8, 593.1, 689.1, 760.0},
          {10.07, 14.73, 17.94, 23.93, 29.61, 35.18, 40.02, 44.82, 50.76, 55.05, 61.01, 66.40, 75.47, 81.78}};
}
inline MeasurementSeries dan_wood() {
  return {"DanWood", {1.309, 1.471, 1.490, 1.565, 1.611, 1.680}, {2.138, 3.421, 3.597, 4.340, 4.882, 5.660}};
}

/// An equation at the given ages with normal scatter.
inline MeasurementSeries simulated(const std::string& name, const std::string& equation,
                                   const std::vector<double>& parameters, const std::vector<double>& ages,
                                   double sigma, std::uint64_t seed) {
  MeasurementSeries series{name, ages, {}};
  Random random(seed);
  for (double t : ages)
    series.value.push_back(growth_equation(equation).value(parameters, t) + sigma * random.normal());
  return series;
}

inline std::vector<double> ages(double from, double to, double step) {
  std::vector<double> all;
  for (double t = from; t <= to + 1e-9 * step; t += step) all.push_back(t);
  return all;
}

}  // namespace dendrofit::test
