// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/read_tree.h"

#include "io/tree_formats.h"
#include "io/write_tree.h"

#include <array>
#include <optional>

namespace dendrofit {
namespace {

constexpr std::array<std::string_view, 7> kNames = {"dendrofit",    "treeqsm-text", "treeqsm-mat", "treefile",
                                                    "simpleforest", "archi",        "arbor"};

std::optional<TreeFormat> format_of_header(const FileBytes& bytes) {
  if (bytes.view().substr(0, 4096).find('\0') != std::string_view::npos) return std::nullopt;
  const CsvTable table(bytes);
  if (table.find("start_x") >= 0 && table.find("axis_x") >= 0) return TreeFormat::ours;
  if (table.find("radius_cyl") >= 0) return TreeFormat::archi_csv;
  if (table.find("startX") >= 0 && table.find("cyl_ID") >= 0) return TreeFormat::arbor_csv;
  if (table.find("startX") >= 0 && table.find("parentID") >= 0) return TreeFormat::simpleforest_csv;
  return std::nullopt;
}

TreeFormat format_or_fail(const FileBytes& bytes) {
  if (const auto format = tree_format_in(bytes)) return *format;
  require_text(bytes);
  const std::string_view line = bytes.view().substr(0, bytes.view().find('\n'));
  fail_at_line(bytes.path(), 1,
               shown(line) +
                   " found; expected a tree model: our qsm.csv (id,parent,axis,order,start_x,...), TreeQSM's "
                   "table or .mat, a raycloudtools treefile, or a SimpleForest, aRchi or arbor CSV");
}

}  // namespace

std::optional<TreeFormat> tree_format_in(const FileBytes& bytes) {
  if (is_mat(bytes)) return TreeFormat::treeqsm_mat;
  if (is_treefile(bytes)) return TreeFormat::treefile;
  if (is_treeqsm_text(bytes)) return TreeFormat::treeqsm_text;
  return format_of_header(bytes);
}

std::string_view to_string(TreeFormat format) {
  return kNames[static_cast<std::size_t>(format)];
}

TreeFormat tree_format_of(const std::filesystem::path& path) {
  return format_or_fail(FileBytes(path));
}

Tree read_tree(const std::filesystem::path& path) {
  const FileBytes bytes(path);
  switch (format_or_fail(bytes)) {
    case TreeFormat::ours:
      return read_qsm_csv(bytes);
    case TreeFormat::treeqsm_text:
      return read_treeqsm_text(bytes);
    case TreeFormat::treeqsm_mat:
      return read_treeqsm_mat(bytes);
    case TreeFormat::treefile:
      return read_treefile(bytes);
    case TreeFormat::simpleforest_csv:
      return read_simpleforest_csv(bytes);
    case TreeFormat::archi_csv:
      return read_archi_csv(bytes);
    case TreeFormat::arbor_csv:
      return read_arbor_csv(bytes);
  }
  fail_in_file(path, "unknown tree format");
}

void write_tree(const std::filesystem::path& path, const Tree& tree, TreeFormat format) {
  switch (format) {
    case TreeFormat::ours:
      return write_qsm_csv(path, tree);
    case TreeFormat::treeqsm_text:
      return write_treeqsm_text(path, tree);
    case TreeFormat::treeqsm_mat:
      return write_treeqsm_mat(path, tree);
    case TreeFormat::treefile:
      return write_treefile(path, tree);
    case TreeFormat::simpleforest_csv:
      return write_simpleforest_csv(path, tree);
    case TreeFormat::archi_csv:
      return write_archi_csv(path, tree);
    case TreeFormat::arbor_csv:
      return write_arbor_csv(path, tree);
  }
}

}  // namespace dendrofit
