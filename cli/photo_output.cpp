// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/commands.h"
#include "cli/photo_settings.h"
#include "cli/report/overlay.h"
#include "cli/tree_files.h"
#include "core/atomic_file.h"
#include "io/json_text.h"
#include "io/metrics_json.h"

#include <cmath>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace dendrofit::cli {
namespace {

using Json = nlohmann::ordered_json;

/// id, parent, u, v, radius: row i is cylinder i of qsm.csv, row 0 the root.
std::string skeleton_csv(const PlaneSkeleton& skeleton) {
  std::string text = "id,parent,u,v,radius_px,bridge\n";
  for (std::size_t i = 0; i < skeleton.size(); ++i)
    text += fmt::format("{},{},{:.3f},{:.3f},{:.3f},{}\n", i, skeleton.parent[i], skeleton.px[i].x(),
                        skeleton.px[i].y(), skeleton.radius_px[i], skeleton.bridge[i]);
  return text;
}

}  // namespace

std::string photo_metrics_json(const PhotoReconstruction& result) {
  TreeMetrics metrics = result.metrics;
  metrics.height_m = result.outline.height;
  metrics.crown_diameter_m = result.outline.width;
  Json json = Json::parse(metrics_to_json(metrics));
  json["unit"] = result.metric ? "m" : "tree heights";
  json["silhouette_area_m2"] = result.outline.area;
  json["lean_in_view_deg"] = result.outline.lean_deg;
  // What the picture does not show is no number.
  std::vector<std::string> untold = {"crown_area_m2", "crown_volume_m3", "wood_share", "lean_azimuth_deg"};
  if (!result.has_tree)
    for (const auto& [key, value] : json.items())
      if (key != "height_m" && key != "crown_diameter_m" && key != "unit" && key != "silhouette_area_m2" &&
          key != "dbh_height_m" && key != "intervals")
        untold.push_back(key);
  for (const std::string& key : untold) json[key] = nullptr;
  return json_text(json) + "\n";
}

std::string photo_reconstruction_json(const PhotoReconstruction& r) {
  const auto& s = r.silhouette;
  const Json json = {{"source", "photograph"},
                     {"unit", r.metric ? "m" : "tree heights"},
                     {"scale_from", r.frame.scale_source},
                     {"scale_error", r.frame.scale_error},
                     {"top_lead", r.frame.top_lead},
                     {"distance", r.frame.distance_m},
                     {"known_camera", r.frame.known_camera},
                     {"foot", {r.tree.origin_shift.x(), r.tree.origin_shift.y(), r.tree.origin_shift.z()}},
                     {"silhouette",
                      {{"from_mask", s.from_mask},
                       {"confidence", s.confidence},
                       {"solid_share", s.solid_share},
                       {"leafy", s.leafy},
                       {"trees", s.tree_count},
                       {"touches_top", s.touches_top},
                       {"touches_side", s.touches_side}}},
                     {"skeleton",
                      {{"nodes", r.skeleton.size()},
                       {"joined_pieces", r.skeleton.joined_pieces},
                       {"dropped_pieces", r.skeleton.dropped_pieces},
                       {"dropped_share", r.skeleton.dropped_share},
                       {"crossings", r.skeleton.crossings}}},
                     {"measured", {"projection", "diameters", "angles in the picture"}},
                     {"extrapolated", {"depth", "azimuths", "lengths", "volume"}},
                     {"warnings", r.warnings}};
  return json_text(json) + "\n";
}

std::string photo_overlay(const PhotoInput& input, const PhotoReconstruction& result) {
  if (!result.has_tree) return encode_png(draw_outline(input.photo, result.silhouette));
  const Vec3 shift = result.tree.origin_shift - input.origin_shift;
  return encode_png(draw_overlay(input.photo, result.frame.camera, result.tree, shift));
}

void write_photo_reconstruction(const std::filesystem::path& folder, const PhotoInput& input,
                                const PhotoReconstruction& result,
                                const std::vector<std::string>& mesh_formats) {
  if (result.has_tree) {
    write_tree_files(folder, result.tree, result.metrics, mesh_formats);
    write_file(folder / "skeleton.csv", skeleton_csv(result.skeleton));
  }
  write_file(folder / "metrics.json", photo_metrics_json(result));
  write_file(folder / "reconstruction.json", photo_reconstruction_json(result));
  write_file(folder / "overlay.png", photo_overlay(input, result));
}

void say_photo_reconstruction(const Session& session, const PhotoReconstruction& result) {
  const char* unit = result.metric ? "m" : "tree heights";
  const OutlineMetrics& o = result.outline;
  if (result.has_tree && result.metric) {
    session.say("Tree model");
    say_metrics(session, result.tree, result.metrics);
  } else {
    session.say(result.has_tree ? "Tree model, in tree heights" : "Outline of the tree");
    session.say(fmt::format("  height      {:.2f} {}", o.height, unit));
    if (result.has_tree) session.say(fmt::format("  cylinders   {}", result.tree.size()));
  }
  session.say(fmt::format("  in view     {:.2f} {} wide, silhouette {:.3g} {}{}", o.width, unit, o.area, unit,
                          result.metric ? "2" : " squared"));
  if (result.has_tree)
    session.say(fmt::format("  stem        leans {:.1f} deg to the {} in view", std::abs(o.lean_deg),
                            o.lean_deg >= 0 ? "right" : "left"));
  for (const std::string& warning : result.warnings) session.warn(warning);
}

}  // namespace dendrofit::cli
