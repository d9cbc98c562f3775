// SPDX-License-Identifier: GPL-3.0-or-later
// A tree with leaves as input of laser-scanning and radiative-transfer simulators. Each export fills a folder
// of its own, wood (with added shoots and petioles) apart from leaves, metres. All throw InputError for an
// invalid tree or foliage and IoError when a file cannot be written.
#pragma once

#include "core/foliage.h"
#include "core/tree.h"

#include <filesystem>
#include <string>

namespace dendrofit {

/// HELIOS++: tree.obj (objects `wood` and `leaves`, z up, about the tree's origin shift), tree.mtl
/// (classification 0 wood, 1 leaves; reflectance from HELIOS++'s spectra `wood` and `leaf_spectra`) and
/// scene.xml, which puts the tree where it stands. scene.xml names tree.obj as `<folder's name>/tree.obj`:
/// add the folder above to the asset path.
void export_helios(const std::filesystem::path& folder, const Tree& tree, const Foliage& foliage,
                   const std::string& leaf_spectra = "deciduous");

/// LESS 2.x: tree_wood.obj and tree_leaves.obj (y up, about the tree's foot), objects.txt (object `tree` of
/// both, with optical properties `branch` and `leaf`, which the project must define) and instances.txt (one
/// tree in the middle of a scene of 100 m by 100 m). Copy all four into a project's Parameters folder.
void export_less(const std::filesystem::path& folder, const Tree& tree, const Foliage& foliage);

/// Eradiate: leaves.txt, a leaf a line: `radius x y z normal_x normal_y normal_z`, discs of the leaves' area
/// about the blades' middles, for LeafCloud.from_file; and wood.ply. Both about the tree's foot.
void export_eradiate(const std::filesystem::path& folder, const Tree& tree, const Foliage& foliage);

}  // namespace dendrofit
