// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/tree_files.h"

#include "cli/parse.h"
#include "core/atomic_file.h"
#include "io/birth_cycles.h"
#include "io/metrics_json.h"
#include "io/write_mesh.h"
#include "io/write_tree.h"

#include <algorithm>

namespace dendrofit::cli {

void check_mesh_formats(const std::vector<std::string>& formats) {
  for (const std::string& format : formats)
    if (format != "obj" && format != "ply" && format != "glb")
      throw UsageError("--mesh " + format + ": expected obj, ply or glb");
}

void write_tree_files(const std::filesystem::path& folder, const Tree& tree, const TreeMetrics& metrics,
                      const std::vector<std::string>& mesh_formats, const MetricsExtras& extras) {
  write_qsm_csv(folder / "qsm.csv", tree);
  write_metrics(folder / "metrics.json", metrics, extras.trees, extras.crs);
  if (std::any_of(tree.birth_cycle.begin(), tree.birth_cycle.end(), [](std::int32_t c) { return c >= 0; }))
    write_birth_cycles(folder / "birth_cycles.csv", tree);
  else
    std::filesystem::remove(folder / "birth_cycles.csv");  // of an earlier run
  for (const std::string& format : mesh_formats) {
    if (format == "obj") write_tree_obj(folder / "tree.obj", tree);
    if (format == "ply") write_tree_ply(folder / "tree.ply", tree);
    if (format == "glb") write_tree_glb(folder / "tree.glb", tree);
  }
}

void write_leaf_files(const std::filesystem::path& folder, const Foliage& foliage,
                      const std::string& report_json, const std::vector<std::string>& mesh_formats) {
  write_leaves_csv(folder / "leaves.csv", foliage);
  write_file(folder / "leaves.json", report_json);
  if (foliage.twigs.empty())
    std::filesystem::remove(folder / "shoots.csv");  // of an earlier run
  else
    write_qsm_csv(folder / "shoots.csv", foliage.twigs);
  for (const std::string& format : mesh_formats) {
    if (format == "obj") write_foliage_obj(folder / "leaves.obj", foliage);
    if (format == "obj") write_petioles_obj(folder / "petioles.obj", foliage);
    if (format == "ply") write_foliage_ply(folder / "leaves.ply", foliage);
    if (format == "ply") write_petioles_ply(folder / "petioles.ply", foliage);
    if (format == "glb" && foliage.size() > 0) write_foliage_glb(folder / "leaves.glb", foliage);
  }
}

}  // namespace dendrofit::cli
