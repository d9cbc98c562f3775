// SPDX-License-Identifier: GPL-3.0-or-later
// dendrofit scan QSM -o CLOUD
#include "cli/commands.h"
#include "cli/leaf_settings.h"
#include "cli/output_folder.h"
#include "cli/parse.h"
#include "core/atomic_file.h"
#include "core/errors.h"
#include "forward/virtual_scan/virtual_scan.h"
#include "io/json_text.h"
#include "io/metrics_json.h"
#include "io/read_tree.h"
#include "io/write_cloud.h"
#include "io/write_mesh.h"
#include "io/write_tree.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace dendrofit::cli {
namespace {

namespace fs = std::filesystem;

class Scan : public Command {
 public:
  void declare(OptionTable& options) override {
    options.positional("QSM", tree_, "Tree model: our qsm.csv or any QSM format");
    options.path("--output", output_, "Point cloud to write: .las, .ply, .pcd, .xyz or .csv", "-o");
    options.integer("--stations", scan_.stations, "Scanner stations, evenly around the tree");
    options.number("--distance", scan_.distance_m, Quantity::length, "From the tree's foot to each station");
    options.number("--instrument-height", scan_.instrument_height_m, Quantity::length,
                   "Of the scanner above the ground it stands on");
    options.number("--azimuth", scan_.first_azimuth_deg, Quantity::angle, "Of the first station");
    options.number("--step", scan_.step_deg, Quantity::angle, "Between neighbouring beams, both ways");
    options.number("--divergence", scan_.divergence_mrad, Quantity::pure,
                   "Full angle of the beam, milliradians");
    options.number("--exit-diameter", scan_.exit_diameter_m, Quantity::length, "Of the beam at the scanner");
    options.number("--range-noise", scan_.range_noise_m, Quantity::length, "Standard deviation of ranges");
    options.number("--registration-error", scan_.registration_error_m, Quantity::length,
                   "Standard deviation of each station's shift");
    options.number("--registration-turn", scan_.registration_error_deg, Quantity::angle,
                   "Standard deviation of each station's turn");
    options.number("--drop-out", scan_.drop_out, Quantity::pure, "Share of beams lost, 0 to 1");
    options.integer("--returns", scan_.max_returns, "Returns of one beam, at most");
    options.number("--max-range", scan_.max_range_m, Quantity::length, "Nothing farther is seen");
    options.number("--ground", ground_m_, Quantity::length,
                   "Radius of the ground about the foot (0: no ground)");
    options.number("--ground-slope", scan_.ground_slope_deg, Quantity::angle,
                   "Of the ground, rising towards +x");
    options.number("--grass-height", scan_.grass_height_m, Quantity::length, "Height of grass on the ground");
    options.flag("--leaf-on", leaf_on_, "Put leaves on the tree first (see the options on leaves)");
    options.flag("--hits", hits_,
                 "Also write which cylinder, leaf and station each point is from (_hits.csv)");
    leaves_.declare(options);
  }

  int run(Session& session) override {
    if (output_.empty()) throw UsageError("no output file: give one with -o FILE");
    ScanOptions options = scan_;
    options.seed = session.common().seed;
    options.threads = session.common().threads;
    if (!(ground_m_ >= 0)) throw InputError(fmt::format("--ground {}m: must not be negative", ground_m_));
    if (ground_m_ == 0 && (options.ground_slope_deg != 0 || options.grass_height_m > 0))
      throw UsageError("--ground-slope, --grass-height: there is no ground (--ground 0m)");
    options.ground_radius_m = ground_m_ > 0 ? std::optional<double>(ground_m_) : std::nullopt;
    options.validate();
    const bool leaves_described = leaves_.area_m2 || leaves_.lai || leaves_.count || leaves_.length_m ||
                                  !leaves_.blade.empty() || !leaves_.inclination.empty() ||
                                  !leaves_.profile.empty() || leaves_.species != LeafSettings{}.species;
    if (!leaf_on_ && leaves_described)
      throw UsageError("options on leaves without leaves: put them on the tree with --leaf-on");
    const LeafOptions leaf_options = leaves_.resolve(session.common());
    check_cloud_format(output_);
    prepare_output_file(output_, session.common());
    const Tree tree = read_tree(tree_);
    LeafResult leaves;
    if (leaf_on_) {
      leaves = insert_leaves(tree, leaf_options, session.progress());
      say_leaves(session, leaves);
    }
    VirtualScan scan = scan_tree(tree, leaf_on_ ? &leaves.foliage : nullptr, options, session.progress());
    if (scan.cloud.empty())
      throw SolverError(
          "no beam hit anything: the tree stands beyond --max-range, or --step is too coarse for it");
    scan.cloud.crs_wkt = crs_beside(tree_);
    write_point_cloud(output_, scan.cloud);
    write_qsm_csv(beside("_truth.csv"), tree);
    write_truth(scan, tree);
    if (leaf_on_) write_leaves_csv(beside("_leaves.csv"), leaves.foliage);
    if (hits_) write_hits(scan);
    write_file(beside("_run.toml"), run_record(session, {tree_}));

    session.json(json_text(
        {{"output", output_.string()}, {"points", scan.cloud.size()}, {"stations", scan.positions.size()}}));
    session.say(fmt::format("{} points from {} station{}: {}; truth in {} and {}", scan.cloud.size(),
                            scan.positions.size(), scan.positions.size() == 1 ? "" : "s", output_.string(),
                            beside("_truth.csv").filename().string(),
                            beside("_truth.json").filename().string()));
    return 0;
  }

 private:
  fs::path beside(const std::string& ending) const {
    return output_.parent_path() / (output_.stem().string() + ending);
  }

  void write_truth(const VirtualScan& scan, const Tree& tree) const {
    auto json = nlohmann::ordered_json::parse(metrics_to_json(measure(tree)));
    auto stations = nlohmann::ordered_json::array();
    for (const Vec3& p : scan.positions) stations.push_back({p.x(), p.y(), p.z()});
    json["stations_local"] = stations;
    json["points"] = scan.cloud.size();
    write_file(beside("_truth.json"), json_text(json) + "\n");
  }

  void write_hits(const VirtualScan& scan) const {
    std::string csv = "point,cylinder,leaf,station,range_error_m\n";
    for (std::size_t i = 0; i < scan.cloud.size(); ++i)
      csv += fmt::format("{},{},{},{},{}\n", i + 1, scan.node[i] + 1, scan.leaf[i] + 1, scan.station[i] + 1,
                         scan.range_error_m[i]);
    write_file(beside("_hits.csv"), csv);
  }

  fs::path tree_, output_;
  ScanOptions scan_;
  double ground_m_ = 5;
  bool leaf_on_ = false, hits_ = false;
  LeafSettings leaves_;
};

}  // namespace

std::unique_ptr<Command> make_scan() {
  return std::make_unique<Scan>();
}

}  // namespace dendrofit::cli
