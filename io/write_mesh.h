// SPDX-License-Identifier: GPL-3.0-or-later
// Surfaces of wood and leaves for viewers and for other programs.
#pragma once

#include "core/foliage.h"
#include "core/mesh.h"
#include "core/tree.h"

#include <filesystem>

namespace dendrofit {

/// Any mesh by extension: .obj (text), .ply (binary, double) or .glb (binary glTF 2.0, y up, local
/// coordinates in single precision under a node that carries origin_shift in double). World coordinates. All
/// writers throw InputError for invalid values and IoError when the file cannot be written.
void write_mesh(const std::filesystem::path& path, const TriangleMesh& mesh);

void write_tree_obj(const std::filesystem::path& path, const Tree& tree, const TreeMeshOptions& options = {});
void write_tree_ply(const std::filesystem::path& path, const Tree& tree, const TreeMeshOptions& options = {});
void write_tree_glb(const std::filesystem::path& path, const Tree& tree, const TreeMeshOptions& options = {});

/// Leaves in the order of `foliage.leaves`, each with its shape's triangles; coordinates to the micrometre.
void write_foliage_obj(const std::filesystem::path& path, const Foliage& foliage);
void write_foliage_ply(const std::filesystem::path& path, const Foliage& foliage);
/// Their stalks, two triangles each, in the order of the leaves; in the OBJ each after a line `g leaf_ID`
/// (ids as in leaves.csv). A leaf that sits on the wood has none.
void write_petioles_obj(const std::filesystem::path& path, const Foliage& foliage);
void write_petioles_ply(const std::filesystem::path& path, const Foliage& foliage);
/// One mesh a leaf shape, drawn per leaf through EXT_mesh_gpu_instancing: a tenth of the size of the
/// triangles. Petioles likewise; added shoots (Foliage::twigs) are a mesh.
void write_foliage_glb(const std::filesystem::path& path, const Foliage& foliage);

/// Wood (mesh) and leaves (instances) in one scene; `foliage` may have no leaves.
void write_scene_glb(const std::filesystem::path& path, const Tree& tree, const Foliage& foliage,
                     const TreeMeshOptions& options = {});

/// id,cylinder,x,y,z,normal_x,normal_y,normal_z,length_m,area_m2,species: one row a leaf, ids and cylinders
/// from 1 (cylinder 0: none), x y z the blade's base in world coordinates.
void write_leaves_csv(const std::filesystem::path& path, const Foliage& foliage);

}  // namespace dendrofit
