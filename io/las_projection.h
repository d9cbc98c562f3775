// SPDX-License-Identifier: GPL-3.0-or-later
// Coordinate systems in LAS files: WKT or GeoTIFF keys in variable length records (ASPRS LAS 1.4 R15,
// "Coordinate Reference System Representation"; OGC 19-008 for the keys).
#pragma once

#include "io/las_format.h"

#include <string>
#include <string_view>
#include <vector>

namespace dendrofit {

/// The text up to its first zero byte, control characters as blanks, without blanks at the end.
std::string printable_text(std::string_view text);

/// The records in one line of words: the WKT where there is one; else what the GeoTIFF keys say, as "EPSG:n"
/// (the projected system's code, else the geographic one's), "EPSG:n+m" with a vertical system m, or, without
/// a code, the system's name as cited. Empty where the records tell nothing.
std::string crs_of(const std::vector<LasRecord>& records);

/// Records that say `crs`, so that crs_of() gives it back: text with brackets as WKT, "EPSG:n" and "EPSG:n+m"
/// as codes, other words as the citation of a user-defined system; none for an empty text.
std::vector<LasRecord> projection_of(const std::string& crs);

}  // namespace dendrofit
