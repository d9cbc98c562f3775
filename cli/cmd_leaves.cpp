// SPDX-License-Identifier: GPL-3.0-or-later
// dendrofit leaves QSM -o DIR
#include "cli/commands.h"
#include "cli/leaf_settings.h"
#include "cli/leaves_output.h"
#include "cli/output_folder.h"
#include "cli/parse.h"
#include "cli/tree_files.h"
#include "core/atomic_file.h"
#include "io/export_canopy.h"
#include "io/metrics_json.h"
#include "io/read_cloud.h"
#include "io/read_tree.h"
#include "io/write_tree.h"

#include <optional>

#include <fmt/format.h>

namespace dendrofit::cli {
namespace {

class Leaves : public Command {
 public:
  void declare(OptionTable& options) override {
    options.positional("QSM", tree_, "Tree model: our qsm.csv or any QSM format");
    options.path("--output", output_, "Folder for the results", "-o");
    settings_.declare(options);
    options.path("--measured", measured_, "Leaf points of a leaf-on scan: leaves go where these are");
    options.texts("--mesh", meshes_, "obj|ply|glb",
                  "Mesh formats of the leaves (default obj and glb); may be repeated");
    options.texts("--export", exports_, "helios|less|eradiate",
                  "Input for HELIOS++, LESS or Eradiate, in a folder of that name; may be repeated");
  }

  int run(Session& session) override {
    need_output(output_);
    check_mesh_formats(meshes_);
    for (const std::string& target : exports_)
      if (target != "helios" && target != "less" && target != "eradiate")
        throw UsageError("--export " + target + ": expected helios, less or eradiate");
    LeafOptions options = settings_.resolve(session.common());
    const Tree tree = read_tree(tree_);
    std::vector<std::filesystem::path> inputs = {tree_};
    if (!measured_.empty()) {
      options.measured = read_point_cloud(measured_, {}, session.progress());
      inputs.push_back(measured_);
    }
    const auto folder = prepare_output_folder(output_, session.common());
    const LeafResult result = insert_leaves(tree, options, session.progress());

    const std::string json = leaves_json(result, crs_beside(tree_));
    write_leaf_files(folder, result.foliage, json,
                     meshes_.empty() ? std::vector<std::string>{"obj", "glb"} : meshes_);
    write_qsm_csv(folder / "qsm.csv", tree);  // what leaves.csv calls cylinders
    for (const std::string& target : exports_) write_export(folder / target, target, tree, result.foliage);
    write_file(folder / "run.toml", run_record(session, inputs));
    session.json(json);
    say_leaves(session, result);
    session.say("Written to " + folder.string() + ": leaves.csv, leaves.json, qsm.csv and meshes");
    return 0;
  }

 private:
  static void write_export(const std::filesystem::path& folder, const std::string& target, const Tree& tree,
                           const Foliage& foliage) {
    std::filesystem::create_directories(folder);
    if (target == "less") return export_less(folder, tree, foliage);
    if (target == "eradiate") return export_eradiate(folder, tree, foliage);
    const bool needles = foliage.shapes.front().name.starts_with("needle");
    export_helios(folder, tree, foliage, needles ? "conifer" : "deciduous");
  }

  std::filesystem::path tree_, output_, measured_;
  LeafSettings settings_;
  std::vector<std::string> meshes_, exports_;
};

}  // namespace

std::unique_ptr<Command> make_leaves() {
  return std::make_unique<Leaves>();
}

}  // namespace dendrofit::cli
