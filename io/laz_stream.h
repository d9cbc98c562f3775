// SPDX-License-Identifier: GPL-3.0-or-later
// Compressed points: through the LASzip library where the build has it (io/laszip.cpp), else, for reading
// alone, through Node and npm's laz-perf (io/read_laz.cpp).
#pragma once

#include "io/las_format.h"

#include <functional>
#include <ostream>

namespace dendrofit {

#if DENDROFIT_HAS_LASZIP
/// The points of a LAZ file. Throws IoError where decompression fails.
PointCloud laszip_read(const FileBytes& bytes, const LasHeader& header, Progress& progress);
/// LAS or LAZ to LAS or LAZ with every attribute and record before the points; `shift` is added to offsets
/// and bounds.
void laszip_copy(const FileBytes& bytes, const LasHeader& header, std::ostream& out, bool compress,
                 const Vec3& shift, Progress& progress);
#else
/// Hands the decompressed records of a LAZ file to `take`, block by block. Throws IoError where the
/// decompressor is not installed or fails, Cancelled where
/// the user has stopped it.
void laz_records(const FileBytes& bytes, const LasHeader& header,
                 const std::function<void(const char* records, std::uint64_t count)>& take,
                 Progress& progress);
#endif

/// Throws IoError for a chunk table that contradicts the header.
void check_laz_chunks(const FileBytes& bytes, const LasHeader& header);
/// Throws IoError: the points end here.
[[noreturn]] void fail_laz_damaged(const FileBytes& bytes, std::uint64_t points, std::uint64_t of);

}  // namespace dendrofit
