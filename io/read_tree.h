// SPDX-License-Identifier: GPL-3.0-or-later
// Tree models (QSMs) from files, whoever made them.
#pragma once

#include "core/tree.h"

#include <filesystem>
#include <string_view>

namespace dendrofit {

/// The formats, in the order in which a file is tried.
enum class TreeFormat { ours, treeqsm_text, treeqsm_mat, treefile, simpleforest_csv, archi_csv, arbor_csv };

/// "dendrofit", "treeqsm-text", "treeqsm-mat", "treefile", "simpleforest", "archi" or "arbor".
std::string_view to_string(TreeFormat format);

/// Tells the format by the content: magic bytes, header words, number of columns. Throws IoError when it is
/// none.
TreeFormat tree_format_of(const std::filesystem::path& path);

/// Reads a tree in any of the formats. Parents are sorted before children where the file has them otherwise;
/// axes and orders are the file's where they are sound, else laid anew by thickness. Cylinders without length
/// or radius are joined over (their children go to their parent). origin_shift: multiples of 100 m, so that
/// local coordinates stay small and the file's numbers are kept bit for bit. Throws IoError naming file and
/// line (or byte, or variable), what was found, expected and to be done.
Tree read_tree(const std::filesystem::path& path);

}  // namespace dendrofit
