// SPDX-License-Identifier: GPL-3.0-or-later
// dendrofit reconstruct SCAN|PHOTO -o DIR
#include "cli/commands.h"
#include "cli/output_folder.h"
#include "cli/photo_settings.h"
#include "cli/reconstruct_settings.h"
#include "cli/tree_files.h"
#include "cli/views_output.h"
#include "core/atomic_file.h"
#include "io/json_text.h"
#include "io/metrics_json.h"

#include <nlohmann/json.hpp>

namespace dendrofit::cli {
namespace {

class Reconstruct : public Command {
 public:
  void declare(OptionTable& options) override {
    options.positional(
        "SCAN", scan_,
        "Point cloud of one tree (.las .laz .ply .pcd .xyz .txt .csv .pts .asc .e57 .ptx), or a "
        "photograph (.jpg .png)",
        false);
    options.path("--output", output_, "Folder for the results", "-o");
    settings_.declare(options);
    photo_.declare(options);
    options.texts("--mesh", meshes_, "obj|ply|glb",
                  "Also write the wood as a mesh; may be given several times");
  }

  int run(Session& session) override {
    need_output(output_);
    check_mesh_formats(meshes_);
    photo_.check(scan_);
    const ReconstructOptions options = settings_.resolve(session.common());
    if (photo_.asked_for(scan_)) {
      settings_.check_for_photographs();
      return from_pictures(session, options);
    }
    const PointCloud scan = settings_.read_scan(session, scan_, session.progress());
    const auto folder = prepare_output_folder(output_, session.common());
    const Reconstruction result = reconstruct(scan, options, session.progress());
    write_reconstruction(folder, result, meshes_, scan.crs_wkt);
    write_file(folder / "run.toml", run_record(session, {scan_}));

    auto json = nlohmann::ordered_json::parse(reconstruction_json(result));
    json["output"] = folder.string();
    json["cylinders"] = result.tree.size();
    json["metrics"] = nlohmann::ordered_json::parse(metrics_to_json(result.metrics, {}, scan.crs_wkt));
    session.json(json_text(json));
    say_reconstruction(session, result);
    session.say("Written to " + folder.string() + ": qsm.csv, metrics.json, reconstruction.json" +
                (result.leaf_points.empty() ? "" : ", leaf_points.ply"));
    return 0;
  }

 private:
  int from_pictures(Session& session, const ReconstructOptions& options) {
    const double dbh_height_m = options.dbh_height_m;
    if (!photo_.has_cameras())
      return from_photo(session, photo_.read_photo(scan_, session.common(), dbh_height_m));
    ViewSet set = photo_.read_views();
    if (set.views.size() > 1) return from_views(session, std::move(set), options);
    return from_photo(session, photo_.from_view(std::move(set), session.common(), dbh_height_m));
  }

  int from_photo(Session& session, const PhotoInput& input) {
    const PhotoReconstruction result = reconstruct_from(input, session.progress());
    const auto folder = prepare_output_folder(output_, session.common());
    write_photo_reconstruction(folder, input, result, meshes_);
    write_file(folder / "run.toml", run_record(session, photo_.inputs(scan_)));

    auto json = nlohmann::ordered_json::parse(photo_reconstruction_json(result));
    json["output"] = folder.string();
    json["cylinders"] = result.tree.size();
    json["metrics"] = nlohmann::ordered_json::parse(photo_metrics_json(result));
    session.json(json_text(json));
    say_photo_reconstruction(session, result);
    session.say("Written to " + folder.string() + ": " + (result.has_tree ? "qsm.csv, skeleton.csv, " : "") +
                "metrics.json, reconstruction.json, overlay.png");
    return 0;
  }

  int from_views(Session& session, ViewSet read, const ReconstructOptions& options) {
    const ViewSet set = photo_.scaled(std::move(read), session.progress());
    const auto folder = prepare_output_folder(output_, session.common());
    const ViewsReconstruction result = reconstruct_views(set, {.cloud = options}, session.progress());
    write_views_reconstruction(folder, set, result, meshes_);
    write_file(folder / "run.toml", run_record(session, photo_.inputs(scan_)));

    auto json = nlohmann::ordered_json::parse(reconstruction_json(result.model));
    json["output"] = folder.string();
    json["cylinders"] = result.model.tree.size();
    json["metrics"] = nlohmann::ordered_json::parse(metrics_to_json(result.model.metrics));
    json["views"] = nlohmann::ordered_json::parse(views_json(result));
    session.json(json_text(json));
    say_views_reconstruction(session, result);
    session.say("Written to " + folder.string() +
                ": qsm.csv, metrics.json, reconstruction.json, views.json, surface.ply, overlays/");
    return 0;
  }

  std::filesystem::path scan_, output_;
  ReconstructSettings settings_;
  PhotoSettings photo_;
  std::vector<std::string> meshes_;
};

}  // namespace

std::unique_ptr<Command> make_reconstruct() {
  return std::make_unique<Reconstruct>();
}

}  // namespace dendrofit::cli
