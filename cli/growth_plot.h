// SPDX-License-Identifier: GPL-3.0-or-later
// Measurements with a fitted curve and its bands as a picture: SVG and PNG from the same strokes.
#pragma once

#include "cli/report/image.h"
#include "fit/growth_result.h"

#include <string>
#include <vector>

namespace dendrofit::cli {

/// What such a picture shows. Axes start at zero unless the data go below; values that are not finite are
/// left out.
struct CurvePicture {
  std::string title, x_label, y_label;
  std::vector<double> x, y;            ///< measurements
  std::vector<GrowthBandPoint> curve;  ///< in the order of `time`; empty without a fit
};

/// Of one series with its best curve; of the pooled curve over all measurements (else the first series) where
/// `series` is null.
CurvePicture growth_picture(const GrowthReport& report, const GrowthSeries* series = nullptr);

/// 640 x 450 units.
std::string curve_svg(const CurvePicture& picture);
/// The same in 1280 x 900 pixels.
Image curve_image(const CurvePicture& picture);

/// A small plot for the terminal; "" where there is nothing to show.
std::string curve_text(const CurvePicture& picture, int columns = 64, int rows = 14);

}  // namespace dendrofit::cli
