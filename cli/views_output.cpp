// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/views_output.h"

#include "cli/reconstruct_settings.h"
#include "cli/report/overlay.h"
#include "core/atomic_file.h"
#include "io/json_text.h"
#include "io/write_cloud.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace dendrofit::cli {
namespace {

using Json = nlohmann::ordered_json;

/// A picture's file name without folders and ending, its number where it has none.
std::string stem_of(const ViewQuality& view, std::size_t number) {
  const std::string stem = std::filesystem::path(view.name).stem().string();
  return fmt::format("{:02}_{}", number, stem.empty() ? "view" : stem);
}

}  // namespace

std::string views_json(const ViewsReconstruction& result) {
  Json views = Json::array();
  for (std::size_t v = 0; v < result.views.size(); ++v) {
    const ViewQuality& quality = result.views[v];
    Json pose = Json::array();
    for (int r = 0; r < 3; ++r)
      pose.push_back({result.cameras[v].rotation(r, 0), result.cameras[v].rotation(r, 1),
                      result.cameras[v].rotation(r, 2), result.cameras[v].translation[r]});
    views.push_back(
        {{"file", quality.name},
         {"used", quality.used},
         {"mask_explained", quality.explained_share},
         {"mask_covered", quality.covered_share},
         {"offset_px", std::isfinite(quality.offset_px) ? Json(quality.offset_px) : Json(nullptr)},
         {"camera_from_local", pose}});
  }
  return json_text({{"tolerance_px", result.tolerance_px},
                    {"cell_m", result.cell_m},
                    {"poses_refined", result.poses_refined},
                    {"shadow_cylinders_dropped", result.shadows},
                    {"origin",
                     {result.surface.origin_shift.x(), result.surface.origin_shift.y(),
                      result.surface.origin_shift.z()}},
                    {"views", views}}) +
         "\n";
}

void write_views_reconstruction(const std::filesystem::path& folder, const ViewSet& set,
                                const ViewsReconstruction& result,
                                const std::vector<std::string>& mesh_formats) {
  write_reconstruction(folder, result.model, mesh_formats);
  write_file(folder / "views.json", views_json(result));
  write_point_cloud(folder / "surface.ply", result.surface);
  std::filesystem::create_directories(folder / "overlays");
  const Vec3 shift = result.model.tree.origin_shift - set.origin_shift;
  for (std::size_t v = 0; v < set.views.size(); ++v)
    write_png(folder / "overlays" / (stem_of(result.views[v], v) + ".png"),
              draw_overlay(set.views[v].photo, result.cameras[v], result.model.tree, shift, 1600));
}

void say_views_reconstruction(const Session& session, const ViewsReconstruction& result) {
  say_reconstruction(session, result.model);
  double least = 1, sum = 0, used = 0;
  for (const ViewQuality& view : result.views) {
    if (!view.used) continue;
    least = std::min(least, view.covered_share);
    sum += view.covered_share;
    ++used;
  }
  session.say(fmt::format(
      "  views       {:.0f} of {} used; the tree covers {:.0f} % of their masks (least {:.0f} %){}", used,
      result.views.size(), 100 * sum / std::max(1.0, used), 100 * least,
      result.poses_refined ? "; poses refined" : ""));
}

}  // namespace dendrofit::cli
