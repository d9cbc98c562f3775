// SPDX-License-Identifier: GPL-3.0-or-later
// Tree models (QSMs) to files.
#pragma once

#include "core/tree.h"
#include "io/read_tree.h"

#include <filesystem>

namespace dendrofit {

/// Our qsm.csv: one row a cylinder in world coordinates, every number with as many digits as reading it back
/// needs. Written, read and written again, the file is the same byte for byte; ends of cylinders that nothing
/// continues are kept to 2 nm. Throws InputError for an invalid tree, IoError when the file cannot be
/// written.
void write_qsm_csv(const std::filesystem::path& path, const Tree& tree);

/// The same tree in another program's format, so that its readers accept it. What a format cannot hold is
/// lost: quality and standard errors everywhere but in ours and arbor's; TreeQSM's tables count axes from 1
/// and hold the coordinates of .mat files in double precision; a treefile's cylinders start at their parent's
/// tip, so that the gap from a stem's axis to a branch's base is closed, and its several roots are several
/// lines.
void write_tree(const std::filesystem::path& path, const Tree& tree, TreeFormat format);

}  // namespace dendrofit
