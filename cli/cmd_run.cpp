// SPDX-License-Identifier: GPL-3.0-or-later
// dendrofit run SCAN|PHOTO -o DIR: the main job, every stage in turn.
#include "cli/commands.h"
#include "cli/fit_settings.h"
#include "cli/igm_files.h"
#include "cli/leaf_settings.h"
#include "cli/leaves_output.h"
#include "cli/observed_tree.h"
#include "cli/output_folder.h"
#include "cli/parse.h"
#include "cli/reconstruct_settings.h"
#include "cli/run_report.h"
#include "cli/stopwatch.h"
#include "cli/tree_files.h"
#include "core/atomic_file.h"
#include "core/tree_topology.h"
#include "fit/direct_estimates.h"
#include "fit/tree_simulator.h"
#include "forward/leaves/measured_profile.h"
#include "io/json_text.h"
#include "io/metrics_json.h"
#include "io/write_mesh.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace dendrofit::cli {
namespace {

namespace fs = std::filesystem;

class Run : public Command {
 public:
  void declare(OptionTable& options) override {
    options.positional(
        "SCAN", scan_,
        "Point cloud of one tree (.las .laz .ply .pcd .xyz .txt .csv .pts .asc .e57 .ptx), or a "
        "photograph (.jpg .png)",
        false);
    options.path("--output", output_, "Folder for the results", "-o");
    fit_.budget = "120";
    fit_.declare(options);
    leaves_.declare(options);
    reconstruct_.declare(options);
    photo_.declare(options);
  }

  int run(Session& session) override {
    need_output(output_);
    photo_.check(scan_);
    if (photo_.asked_for(scan_)) reconstruct_.check_for_photographs();
    reconstruct_.resolve(session.common());
    FitOptions fit_options = fit_.resolve(session);
    LeafOptions leaf_options = leaves_.resolve(session.common());
    Stopwatch watch;

    const fs::path folder = prepare_output_folder(output_, session.common());
    const ObservedTree observed = observe_tree(session, scan_, reconstruct_, photo_, folder, {"obj", "glb"});
    const Reconstruction& model = observed.model;
    if (observed.one_view) fit_options.observed_from = ObservedFrom::one_view;
    fit_options.dbh_m = model.metrics.dbh_m;
    watch.lap("reconstruct");

    const TreeFit fit = fit_tree(model.tree, fit_options, session.progress());
    write_fit(folder, fit);
    say_fit(session, fit);
    watch.lap("fit growth");

    const IgmGrowth regrown = regrow_where_it_stands(model, fit, session);
    const TreeMetrics regrown_metrics = measure(regrown.tree);
    fs::create_directories(folder / "regrown");
    write_tree_files(folder / "regrown", regrown.tree, regrown_metrics, {"glb"},
                     {.crs = observed.scan.crs_wkt});
    write_file(folder / "growth.csv", growth_series_csv(regrown.series));
    session.say("Regrown tree");
    say_metrics(session, regrown.tree, regrown_metrics);
    watch.lap("regrow");

    // A leaf-on scan shows at which heights its tree carries leaves: so does the regrown one.
    if (!model.leaf_points.empty() && !leaf_options.profile.height) {
      leaf_options.profile.height = measured_heights(model.leaf_points, model.tree);
      session.say(fmt::format("  leaf heights follow the scan's {} leaf points", model.leaf_points.size()));
    }
    const LeafResult leaves = insert_leaves(regrown.tree, leaf_options, session.progress());
    write_leaf_files(folder, leaves.foliage, leaves_json(leaves), {"obj", "glb"});
    write_scene_glb(folder / "regrown_with_leaves.glb", regrown.tree, leaves.foliage);
    say_leaves(session, leaves);
    watch.lap("leaves");

    write_run_report(folder, {session, observed, fit, regrown, regrown_metrics, leaves, watch});
    std::vector<fs::path> inputs = observed.inputs;
    for (const fs::path& other : fit_.inputs()) inputs.push_back(other);
    write_file(folder / "run.toml", run_record(session, inputs));
    say_all(session, folder, model, fit, regrown_metrics, leaves);
    return 0;
  }

 private:
  /// The best parameters' tree, standing on the scanned one's foot, its axes laid by thickness like those of
  /// the scan's model.
  static IgmGrowth regrow_where_it_stands(const Reconstruction& model, const TreeFit& fit, Session& session) {
    IgmSite site;
    site.origin_shift = model.foot;
    site.trees.push_back({.roots = {Vec3::Zero()}, .parameters = {}});
    IgmOptions options;
    options.seed = fit.best_seed;
    IgmGrowth growth = grow_igm(fit.best, site, options, session.progress());
    assign_axes_by_thickness(growth.tree);
    return growth;
  }

  static void say_all(const Session& session, const fs::path& folder, const Reconstruction& model,
                      const TreeFit& fit, const TreeMetrics& regrown, const LeafResult& leaves) {
    using Json = nlohmann::ordered_json;
    session.json(json_text({{"output", folder.string()},
                            {"report", (folder / "report.html").string()},
                            {"metrics", Json::parse(metrics_to_json(model.metrics))},
                            {"reconstruction", Json::parse(reconstruction_json(model))},
                            {"fit", Json::parse(fit_json(fit))},
                            {"regrown", Json::parse(metrics_to_json(regrown))},
                            {"leaves", Json::parse(leaves_json(leaves))}}));
    session.say("Written to " + folder.string() + "; look at " + (folder / "report.html").string());
  }

  fs::path scan_, output_;
  ReconstructSettings reconstruct_;
  PhotoSettings photo_;
  FitSettings fit_;
  LeafSettings leaves_;
};

}  // namespace

std::unique_ptr<Command> make_run() {
  return std::make_unique<Run>();
}

}  // namespace dendrofit::cli
