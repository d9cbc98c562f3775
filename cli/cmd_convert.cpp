// SPDX-License-Identifier: GPL-3.0-or-later
// dendrofit convert IN OUT
#include "cli/commands.h"
#include "cli/output_folder.h"
#include "cli/parse.h"
#include "core/errors.h"
#include "io/file_info.h"
#include "io/write_cloud.h"
#include "io/write_mesh.h"
#include "io/write_tree.h"

#include <map>
#include <optional>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace dendrofit::cli {
namespace {

const std::map<std::string, TreeFormat> kTreeFormats = {{"dendrofit", TreeFormat::ours},
                                                        {"treeqsm", TreeFormat::treeqsm_text},
                                                        {"treeqsm-mat", TreeFormat::treeqsm_mat},
                                                        {"treefile", TreeFormat::treefile},
                                                        {"simpleforest", TreeFormat::simpleforest_csv},
                                                        {"archi", TreeFormat::archi_csv},
                                                        {"arbor", TreeFormat::arbor_csv}};

std::vector<std::string> tree_format_names() {
  std::vector<std::string> names = {"auto"};
  for (const auto& [name, format] : kTreeFormats) names.push_back(name);
  return names;
}

class Convert : public Command {
 public:
  void declare(OptionTable& options) override {
    options.positional("IN", in_, "Point cloud, QSM or mesh");
    options.positional("OUT", out_, "File to write; its extension tells the format");
    options.choice("--qsm-format", format_, tree_format_names(),
                   "Format of a QSM (auto: .csv ours, .txt treefile, .mat TreeQSM; .obj .ply .glb meshes)");
  }

  int run(Session& session) override {
    prepare_output_file(out_, session.common());
    const FileInfo info = describe_file(in_);
    std::string what;
    if (info.cloud) {
      write_point_cloud(out_, *info.cloud);
      what = fmt::format("{} points", info.cloud->size());
    } else if (info.tree) {
      write_any_tree(*info.tree);
      what = fmt::format("{} cylinders", info.tree->size());
    } else {
      throw InputError(fmt::format("{}: a {} cannot be converted; expected a point cloud or a QSM",
                                   in_.string(), info.kind));
    }
    session.json(nlohmann::ordered_json{{"output", out_.string()}, {"content", what}}.dump(2));
    session.say(fmt::format("{} -> {}: {}", in_.string(), out_.string(), what));
    return 0;
  }

 private:
  void write_any_tree(const Tree& tree) const {
    const std::string extension = out_.extension().string();
    if (format_ != "auto") return write_tree(out_, tree, kTreeFormats.at(format_));
    if (extension == ".csv") return write_qsm_csv(out_, tree);
    if (extension == ".txt") return write_tree(out_, tree, TreeFormat::treefile);
    if (extension == ".mat") return write_tree(out_, tree, TreeFormat::treeqsm_mat);
    if (extension == ".obj") return write_tree_obj(out_, tree);
    if (extension == ".ply") return write_tree_ply(out_, tree);
    if (extension == ".glb") return write_tree_glb(out_, tree);
    throw UsageError(
        fmt::format("{}: no QSM or mesh format goes by '{}'; expected .csv, .txt, .mat, .obj, .ply or .glb, "
                    "or give --qsm-format",
                    out_.string(), extension));
  }

  std::filesystem::path in_, out_;
  std::string format_ = "auto";
};

}  // namespace

std::unique_ptr<Command> make_convert() {
  return std::make_unique<Convert>();
}

}  // namespace dendrofit::cli
