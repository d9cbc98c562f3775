// SPDX-License-Identifier: GPL-3.0-or-later
// The growth cycle each cylinder of a grown tree was born in, kept beside its qsm.csv (whose columns are
// fixed).
#pragma once

#include "core/tree.h"

#include <filesystem>

namespace dendrofit {

/// `id,birth_cycle`, one row a cylinder, ids as in qsm.csv; -1 where it is not known.
void write_birth_cycles(const std::filesystem::path& path, const Tree& tree);

/// Sets tree.birth_cycle from such a file. Throws IoError naming file and line unless there is exactly one
/// row for each cylinder, in rising id.
void read_birth_cycles(const std::filesystem::path& path, Tree& tree);

}  // namespace dendrofit
