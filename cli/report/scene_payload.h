// SPDX-License-Identifier: GPL-3.0-or-later
// The 3-D view's data: small, quantised, little-endian arrays and a JSON directory of them.
#pragma once

#include "cli/report/report.h"

#include <string>

namespace dendrofit {

/// `binary` holds arrays one after the other, each starting at a multiple of 4; `directory` is a JSON object
/// naming, for each, type, offset and count, with the scale that turns integers into metres.
///
/// Positions are unsigned 16-bit steps within a box; the frame's origin is the tree's foot (x east, y north,
/// z up), for the regrown tree and its leaves their own foot. Cylinders of the regrown tree come in rising
/// birth cycle, so that the growth slider shows a leading part of them. Points and leaves come in random
/// order, so that the first part of them is an even sample.
struct ScenePayload {
  std::string binary;
  std::string directory;
  std::size_t scan_shown = 0;
  std::size_t leaves_shown = 0;
};

ScenePayload scene_payload(const ReportData& data, const ReportOptions& options);

}  // namespace dendrofit
