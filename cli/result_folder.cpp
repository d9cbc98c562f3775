// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/result_folder.h"

#include "cli/report_file.h"
#include "core/errors.h"
#include "io/birth_cycles.h"
#include "io/file_bytes.h"
#include "io/metrics_json.h"
#include "io/read_foliage.h"
#include "io/read_mesh.h"
#include "io/read_table.h"
#include "io/read_tree.h"

#include <tuple>
#include <utility>

#include <nlohmann/json.hpp>

namespace dendrofit::cli {
namespace {

namespace fs = std::filesystem;

/// A mesh of leaves as one instance of one shape: what the renderer draws.
Foliage as_foliage(TriangleMesh mesh) {
  Foliage foliage;
  foliage.origin_shift = mesh.origin_shift;
  LeafShape shape;
  shape.vertices = std::move(mesh.vertices);
  shape.triangles = std::move(mesh.triangles);
  foliage.shapes.push_back(std::move(shape));
  Leaf leaf;
  leaf.length_m = 1;
  foliage.leaves.push_back(leaf);
  return foliage;
}

/// Tree, metrics and birth cycles of one folder; none without a qsm.csv.
struct ReadTree {
  std::optional<Tree> tree;
  std::optional<TreeMetrics> metrics;
  bool grown = false;
};

ReadTree read_one(const fs::path& folder) {
  ReadTree out;
  if (!fs::exists(folder / "qsm.csv")) return out;
  out.tree = read_tree(folder / "qsm.csv");
  out.grown = fs::exists(folder / "birth_cycles.csv");
  if (out.grown) read_birth_cycles(folder / "birth_cycles.csv", *out.tree);
  out.metrics =
      fs::exists(folder / "metrics.json") ? metrics_from_json(folder / "metrics.json") : measure(*out.tree);
  return out;
}

std::vector<ReportCurve> curves_of(const fs::path& table) {
  std::vector<ReportCurve> curves;
  for (const auto& [column, name, unit, factor] :
       {std::tuple{"height_m", "height", "m", 1.0}, {"dbh_m", "diameter at breast height", "cm", 100.0}})
    try {
      const auto all = read_measurements(table, {"tree", "cycle", column});
      for (const MeasurementSeries& series : all) {
        ReportCurve curve;
        curve.name = name + (all.size() > 1 ? " of tree " + series.name : std::string());
        curve.value_unit = unit;
        curve.time = series.time;
        for (const double value : series.value) curve.value.push_back(factor * value);
        curves.push_back(std::move(curve));
      }
    } catch (const IoError&) {
      if (std::string(column) == "height_m")
        throw;  // no diameter at all: the tree is lower than breast height
    }
  return curves;
}

/// What a folder without a report.json tells: growth.csv's curves, and the warnings of each stage.
void read_parts(const fs::path& folder, ReportData& report) {
  if (fs::exists(folder / "growth.csv")) report.curves = curves_of(folder / "growth.csv");
  for (const char* name : {"reconstruction.json", "leaves.json"}) {
    if (!fs::exists(folder / name)) continue;
    const FileBytes bytes(folder / name);
    const auto json = nlohmann::json::parse(bytes.view(), nullptr, false);
    if (!json.is_object())
      fail_in_file(folder / name, "not JSON; expected what reconstruct and leaves write");
    const auto warnings = json.find("warnings");
    if (warnings == json.end() || !warnings->is_array()) continue;
    for (const auto& warning : *warnings)
      if (warning.is_string()) report.warnings.push_back(warning.get<std::string>());
  }
}

}  // namespace

ResultFolder read_result_folder(const fs::path& folder) {
  ResultFolder out;
  ReadTree first = read_one(folder);
  ReadTree second = read_one(folder / "regrown");
  if (second.tree) {
    out.regrown = std::move(second.tree);
    out.regrown_metrics = std::move(second.metrics);
  }
  // A folder of `grow` holds the grown tree itself.
  const bool itself_grown = first.grown && !out.regrown;
  (itself_grown ? out.regrown : out.model) = std::move(first.tree);
  (itself_grown ? out.regrown_metrics : out.model_metrics) = std::move(first.metrics);
  if (fs::exists(folder / "leaves.glb")) {
    out.foliage = read_foliage_glb(folder / "leaves.glb");
    out.leaf_count = out.foliage->size();
  } else if (fs::exists(folder / "leaves.obj")) {
    out.foliage = as_foliage(read_mesh(folder / "leaves.obj"));
  }
  if (out.foliage && fs::exists(folder / "shoots.csv")) out.foliage->twigs = read_tree(folder / "shoots.csv");
  if (fs::exists(folder / "report.json"))
    read_report_json(folder / "report.json", out.report);
  else
    read_parts(folder, out.report);
  if (fs::exists(folder / "overlay.png"))
    out.overlay_png = std::string(FileBytes(folder / "overlay.png").view());
  return out;
}

}  // namespace dendrofit::cli
