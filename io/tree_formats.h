// SPDX-License-Identifier: GPL-3.0-or-later
// One reader and writer for each QSM format; read_tree() and write_tree() choose among them.
#pragma once

#include "core/tree.h"
#include "io/csv_table.h"
#include "io/file_bytes.h"
#include "io/read_tree.h"

#include <filesystem>
#include <optional>
#include <string_view>

namespace dendrofit {

// The format of a tree model, told by the content; none when it is something else.
std::optional<TreeFormat> tree_format_in(const FileBytes& bytes);

// Our own table (contract: id,parent,axis,order,start_x,...).
Tree read_qsm_csv(const FileBytes& bytes);

// TreeQSM's text table: tabs, with or without its header; 17 columns (radius length start*3 axis*3 parent
// extension branch branch_order position_in_branch mad SurfCov added UnmodRadius), or the older 15 (radius
// length start*3 axis*3 parent extension added UnmodRadius branch branch_order position_in_branch).
bool is_treeqsm_text(const FileBytes& bytes);
Tree read_treeqsm_text(const FileBytes& bytes);
void write_treeqsm_text(const std::filesystem::path& path, const Tree& tree);

// raycloudtools / treetools: "[attributes, ]x,y,z,radius,parent_id[,...]", one tree a line.
bool is_treefile(const FileBytes& bytes);
Tree read_treefile(const FileBytes& bytes);
void write_treefile(const std::filesystem::path& path, const Tree& tree);

// Tables of cylinders with start and end points: SimpleForest / rTwig, aRchi, arbor.
Tree read_simpleforest_csv(const FileBytes& bytes);
Tree read_archi_csv(const FileBytes& bytes);
Tree read_arbor_csv(const FileBytes& bytes);
void write_simpleforest_csv(const std::filesystem::path& path, const Tree& tree);
void write_archi_csv(const std::filesystem::path& path, const Tree& tree);
void write_arbor_csv(const std::filesystem::path& path, const Tree& tree);

// MATLAB level 5 files as TreeQSM writes them: QSM.cylinder or cylinder, one structure or an array of them
// (the first).
bool is_mat(const FileBytes& bytes);
Tree read_treeqsm_mat(const FileBytes& bytes);
void write_treeqsm_mat(const std::filesystem::path& path, const Tree& tree);

}  // namespace dendrofit
