// SPDX-License-Identifier: GPL-3.0-or-later
// dendrofit grow PARAMS.toml|PRESET -o DIR
#include "cli/commands.h"
#include "cli/igm_files.h"
#include "cli/output_folder.h"
#include "cli/parse.h"
#include "cli/site_file.h"
#include "cli/tree_files.h"
#include "core/atomic_file.h"
#include "core/errors.h"
#include "core/mesh.h"
#include "forward/igm/grow.h"
#include "io/json_text.h"
#include "io/metrics_json.h"
#include "io/read_tree.h"
#include "io/write_tree.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <span>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace dendrofit::cli {
namespace {

namespace fs = std::filesystem;

class Grow : public Command {
 public:
  void declare(OptionTable& options) override {
    options.positional("PARAMS", parameters_, "Parameter file (TOML) or a preset's name (--list names them)",
                       false);
    options.path("--output", output_, "Folder for the results", "-o");
    options.flag("--list", list_, "List the presets and stop");
    options.flag(
        "--keys", keys_,
        "List the parameters (of PARAMS, else the defaults) with unit, bounds and meaning, and stop");
    options.texts("--set", settings_, "KEY=VALUE",
                  "Change a parameter (--keys lists them); may be given several times");
    options.integer("--cycles", cycles_, "Growth cycles (default: the parameters' own)");
    options.flag("--until-stop", until_stop_, "Grow until nothing sprouts any more");
    options.path("--from", from_, "Go on from this tree (qsm.csv or any QSM format)");
    options.integer("--from-cycle", from_cycle_, "The cycle that tree is at (default: from the tree)");
    options.path("--site", site_,
                 "Site file (TOML): obstacles, and the trees that stand there (without parameters of their "
                 "own they take PARAMS)");
    options.texts("--mesh", meshes_, "obj|ply|glb",
                  "Also write the tree as a mesh; may be given several times");
    options.flag("--frames", frames_, "Also write the tree after every cycle (frames/cycle_NNN.csv)");
  }

  int run(Session& session) override {
    if (list_) return list_presets(session);
    if (keys_) return list_keys(session);
    if (parameters_.empty())
      throw UsageError("grow: no parameter file or preset given; dendrofit grow --list names the presets");
    check_mesh_formats(meshes_);
    if (from_cycle_ && from_.empty())
      throw UsageError("--from-cycle: the cycle of a tree to go on from; give the tree with --from");
    IgmSetup setup = resolve();
    const SiteFile site = resolve_site(setup);
    for (std::size_t i = 0; i < site.mesh_files.size(); ++i)
      if (!is_closed(site.site.solids.meshes[i]))
        session.warn(site.mesh_files[i].string() +
                     ": not a closed surface, so only the surface itself stops wood and light");
    const fs::path folder = prepare_output_folder(output_, session.common());

    const IgmGrowth growth =
        grow_igm(setup.parameters, site.site, resolve_options(session, folder), session.progress());
    const TreeMetrics metrics = measure(growth.tree);
    const std::vector<TreeMetrics> each = measure_each(growth, site.site);
    // A tree that goes on stands where it stood.
    const std::string crs = from_.empty() ? std::string() : crs_beside(from_);
    write_tree_files(folder, growth.tree, metrics, meshes_, {.trees = each, .crs = crs});
    write_file(folder / "growth.csv", growth_series_csv(growth.series));
    write_file(folder / "run.toml", run_record(session, inputs(setup, site)));
    if (!setup.site.empty()) {  // as it was used, so that params.toml alone grows the same
      write_file(folder / "site.toml", site_toml(site, folder));
      setup.site = "site.toml";
    }
    write_file(folder / "params.toml", igm_setup_toml(setup, {}));
    report(session, growth, metrics, each, folder);
    return 0;
  }

 private:
  static int list_presets(const Session& session) {
    nlohmann::ordered_json names = nlohmann::ordered_json::array();
    for (const IgmPreset& preset : igm_presets()) {
      names.push_back({{"name", preset.name}, {"summary", preset.summary}});
      session.say(fmt::format("{:<12}{}", preset.name, preset.summary));
    }
    session.json(json_text({{"presets", names}}));
    return 0;
  }

  int list_keys(const Session& session) const {
    const IgmSetup setup = resolve();
    nlohmann::ordered_json rows = nlohmann::ordered_json::array();
    session.say("equation = " + setup.parameters.equation);
    for (const ParameterSpec& spec : igm_parameter_table(setup.parameters.equation)) {
      const double value = setup.parameters.get(spec.key);
      const std::string unit = spec.unit.empty() ? "" : " " + std::string(spec.unit);
      rows.push_back({{"key", spec.key},
                      {"value", value},
                      {"unit", spec.unit},
                      {"lo", spec.lo},
                      {"hi", spec.hi},
                      {"meaning", spec.meaning},
                      {"source", spec.source}});
      session.say(fmt::format("{:<20}{:<20}{:<26}{} [{}]", spec.key, fmt::format("{}{}", value, unit),
                              fmt::format("{} to {}", spec.lo, spec.hi), spec.meaning, spec.source));
    }
    session.json(
        nlohmann::ordered_json{{"equation", setup.parameters.equation}, {"parameters", rows}}.dump(2));
    return 0;
  }

  IgmSetup resolve() const {
    IgmSetup setup = parameters_.empty() ? IgmSetup{} : load_igm_setup(parameters_.string());
    apply_settings(setup, settings_);
    if (cycles_) setup.parameters.set("cycles", *cycles_, "--cycles");
    setup.parameters.validate();
    if (!site_.empty()) setup.site = site_;
    if (!from_.empty()) setup.roots = 1;  // its own stems
    return setup;
  }

  SiteFile resolve_site(const IgmSetup& setup) const {
    SiteFile site;
    if (!setup.site.empty()) {
      site = load_site(setup.site, setup.parameters);
      for (IgmTreeSite& tree : site.site.trees)
        if (cycles_ && tree.parameters) tree.parameters->set("cycles", *cycles_, "--cycles");
    }
    if (site.site.trees.empty() && setup.roots > 1) {
      // A shrub: its stems stand in a ring, two internodes from one another.
      IgmTreeSite shrub;
      const double radius = setup.parameters.rho_m * setup.roots / std::numbers::pi;
      for (int i = 0; i < setup.roots; ++i) {
        const double angle = 2 * std::numbers::pi * i / setup.roots;
        shrub.roots.emplace_back(radius * std::cos(angle), radius * std::sin(angle), 0.0);
      }
      site.site.trees.push_back(shrub);
    }
    return site;
  }

  IgmOptions resolve_options(const Session& session, const fs::path& folder) const {
    IgmOptions options;
    options.seed = session.common().seed;
    options.until_stop = until_stop_;
    options.start_cycle = from_cycle_;
    if (!from_.empty()) options.start = read_tree(from_);
    if (frames_) {
      fs::create_directories(folder / "frames");
      options.on_cycle = [folder](int cycle, const Tree& tree) {
        write_qsm_csv(folder / "frames" / fmt::format("cycle_{:03}.csv", cycle), tree);
      };
    }
    return options;
  }

  std::vector<fs::path> inputs(const IgmSetup& setup, const SiteFile& site) const {
    std::vector<fs::path> files;
    for (const fs::path& file : {parameters_, from_, setup.site})
      if (!file.empty() && fs::is_regular_file(file)) files.push_back(file);
    files.insert(files.end(), site.mesh_files.begin(), site.mesh_files.end());
    return files;
  }

  /// Metrics of each tree of a stand in the order of the site; none where one tree stands alone.
  static std::vector<TreeMetrics> measure_each(const IgmGrowth& growth, const IgmSite& site) {
    std::vector<TreeMetrics> each;
    if (site.trees.size() < 2) return each;
    for (std::size_t t = 0; t < site.trees.size(); ++t) {
      const Tree tree = tree_of(growth, static_cast<int>(t));
      each.push_back(tree.empty() ? TreeMetrics() : measure(tree));
    }
    return each;
  }

  static void report(const Session& session, const IgmGrowth& growth, const TreeMetrics& metrics,
                     std::span<const TreeMetrics> trees, const fs::path& folder) {
    session.json(json_text({{"output", folder.string()},
                            {"last_cycle", growth.last_cycle},
                            {"stop_reason", growth.stop_reason},
                            {"cylinders", growth.tree.size()},
                            {"metrics", nlohmann::ordered_json::parse(metrics_to_json(metrics, trees))}}));
    const int first = growth.series.empty() ? 0 : growth.series.front().cycle;
    if (first > 0 && growth.last_cycle <= first)
      session.warn(
          fmt::format("nothing was added: the tree is at cycle {} already, and cycles count from its birth; "
                      "give more with --cycles, or its true cycle with --from-cycle",
                      first));
    session.say(fmt::format("Grown to cycle {}: {}.", growth.last_cycle, growth.stop_reason));
    say_metrics(session, growth.tree, metrics);
    for (std::size_t t = 0; t < trees.size(); ++t)
      session.say(fmt::format("  tree {:<6} {:.2f} m high, {}, {:.4g} m3 of wood", t + 1, trees[t].height_m,
                              trees[t].dbh_m ? fmt::format("DBH {:.1f} cm", 100 * *trees[t].dbh_m) : "no DBH",
                              trees[t].total_volume_m3));
    session.say("Written to " + folder.string() + ": qsm.csv, metrics.json, growth.csv, params.toml");
  }

  fs::path parameters_, output_, from_, site_;
  std::vector<std::string> settings_, meshes_;
  std::optional<int> cycles_, from_cycle_;
  bool list_ = false, keys_ = false, until_stop_ = false, frames_ = false;
};

}  // namespace

std::unique_ptr<Command> make_grow() {
  return std::make_unique<Grow>();
}

}  // namespace dendrofit::cli
