// SPDX-License-Identifier: GPL-3.0-or-later
// What is written on pictures: titles, legend, ground line, scale bar, heights.
#pragma once

#include "cli/report/raster.h"
#include "cli/report/render.h"

#include <string>

namespace dendrofit {

struct Margins {
  int top = 0;
  int bottom = 0;
  int side = 0;
};
Margins margins_of(const RenderOptions& options);

/// Title, subtitle, legend and ground line of one panel; "nothing to show" on a blank one.
void annotate_panel(const Panel& panel, const RenderOptions& options, const PictureView& view, bool blank,
                    Image& image);
/// Scale bar and heights, once for the row.
void annotate_row(const RenderOptions& options, const PictureView& view, Image& image);

/// 1234567 -> "1,234,567".
std::string with_thousands(std::size_t number);
/// The largest of 1, 2, 5 times a power of ten that is not above `limit` (> 0).
double round_length(double limit);
/// 0.05 -> "5 cm", 2 -> "2 m".
std::string length_label(double metres);

}  // namespace dendrofit
