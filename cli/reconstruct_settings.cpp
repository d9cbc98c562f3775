// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/reconstruct_settings.h"

#include "cli/commands.h"
#include "cli/parse.h"
#include "cli/tree_files.h"
#include "core/atomic_file.h"
#include "io/json_text.h"
#include "io/write_cloud.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace dendrofit::cli {

using Json = nlohmann::ordered_json;

namespace {

Eigen::Vector2d place_from(const std::string& text) {
  const std::size_t comma = text.find(',');
  if (comma == std::string::npos) throw UsageError("--tree-at " + text + ": expected X,Y");
  try {
    return {parse_quantity(text.substr(0, comma), Quantity::length),
            parse_quantity(text.substr(comma + 1), Quantity::length)};
  } catch (const std::invalid_argument& fault) {
    throw UsageError(fmt::format("--tree-at {}: {}", text, fault.what()));
  }
}

}  // namespace

void ReconstructSettings::declare(OptionTable& table) {
  table.number("--voxel", options.voxel_size_m, Quantity::length,
               "Points closer together than this are merged");
  table.number("--max-gap", options.max_gap_m, Quantity::length,
               "Widest gap in the scan that wood is believed to cross");
  table.number("--twig-diameter", options.twig_diameter_m, Quantity::length,
               "Diameter of the species' twig ends, where known");
  table.number("--dbh-height", options.dbh_height_m, Quantity::length,
               "Height above the foot of the stem diameter");
  table.text("--tree-at", tree_at, "X,Y",
             "Of several trees in the scan: the one whose stem stands there, in the file's coordinates "
             "(default: the "
             "one with the most points)");
  table.text("--columns", columns, "LIST",
             "Columns of a text cloud, e.g. x,y,z,intensity ('-' skips one; default: detected)");
  table.text("--delimiter", delimiter, "CHAR", "Between the fields of a text cloud (default: detected)");
}

PointCloud ReconstructSettings::read_scan(const Session& session, const std::filesystem::path& file,
                                          Progress& progress) const {
  ReadCloudOptions read;
  if (!columns.empty()) read.columns = columns;
  if (!delimiter.empty()) {
    if (delimiter.size() != 1 && delimiter != "tab")
      throw UsageError("--delimiter " + delimiter + ": expected one character, or tab");
    read.delimiter = delimiter == "tab" ? '\t' : delimiter.front();
  }
  PointCloud cloud = read_point_cloud(file, read, progress);
  session.say(fmt::format("{}: {} points", file.string(), cloud.size()));
  return cloud;
}

ReconstructOptions ReconstructSettings::resolve(const CommonOptions& common) const {
  ReconstructOptions resolved = options;
  resolved.seed = common.seed;
  resolved.threads = common.threads;
  if (!tree_at.empty()) resolved.tree_at = place_from(tree_at);
  resolved.validate();
  return resolved;
}

void ReconstructSettings::check_for_photographs() const {
  if (!tree_at.empty())
    throw UsageError("--tree-at is for scans; in a photograph --root U,V or --mask names the tree");
}

std::string reconstruction_json(const Reconstruction& r) {
  Json others = Json::array();
  for (const Vec3& foot : r.other_trees) others.push_back({foot.x(), foot.y(), foot.z()});
  Json shifts = Json::array();
  for (const Vec3& shift : r.scan_shifts) shifts.push_back({shift.x(), shift.y(), shift.z()});
  const Json json = {{"foot", {r.foot.x(), r.foot.y(), r.foot.z()}},
                     {"ground_found", r.ground_found},
                     {"stems", r.stems},
                     {"other_trees", others},
                     {"leaf_on", r.leaf_on},
                     {"leafy_share", r.leafy_share},
                     {"straight_share", r.straight_share},
                     {"wood_share", r.wood_share},
                     {"noise_m", r.noise_m},
                     {"scan_shifts_m", shifts},
                     {"point_spacing_m", r.spacing_m},
                     {"points",
                      {{"read", r.raw_points},
                       {"after_merging", r.clean_points},
                       {"ground", r.ground_points},
                       {"walls", r.wall_points},
                       {"other_trees", r.other_points},
                       {"stray", r.stray_points},
                       {"tree", r.tree_points},
                       {"leaf", r.leaf_points.size()}}},
                     {"bridged_gaps", r.bridged_gaps},
                     {"warnings", r.warnings}};
  return json_text(json) + "\n";
}

void write_reconstruction(const std::filesystem::path& folder, const Reconstruction& result,
                          const std::vector<std::string>& mesh_formats, const std::string& crs) {
  write_tree_files(folder, result.tree, result.metrics, mesh_formats, {.crs = crs});
  write_file(folder / "reconstruction.json", reconstruction_json(result));
  if (!result.leaf_points.empty()) write_point_cloud(folder / "leaf_points.ply", result.leaf_points);
}

void say_reconstruction(const Session& session, const Reconstruction& result) {
  session.say("Tree model");
  say_metrics(session, result.tree, result.metrics);
  if (result.leaf_on)
    session.say(fmt::format("  wood share  {:.0f} % of the points ({} leaf points kept apart)",
                            100 * result.wood_share, result.leaf_points.size()));
  else
    session.say("  wood share  no leaves on this scan");
  for (const std::string& warning : result.warnings) session.warn(warning);
}

}  // namespace dendrofit::cli
