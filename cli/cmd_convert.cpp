// SPDX-License-Identifier: GPL-3.0-or-later
// dendrofit convert IN OUT
#include "cli/commands.h"
#include "cli/convert_loss.h"
#include "cli/output_folder.h"
#include "cli/parse.h"
#include "core/errors.h"
#include "io/file_info.h"
#include "io/json_text.h"
#include "io/las_format.h"
#include "io/write_cloud.h"
#include "io/write_mesh.h"
#include "io/write_tree.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <sstream>
#include <stdexcept>

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

std::string lower_extension(const std::filesystem::path& path) {
  std::string text = path.extension().string();
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

class Convert : public Command {
 public:
  void declare(OptionTable& options) override {
    options.positional("IN", in_, "Point cloud (.las .laz .ply .pcd .e57 .ptx .xyz ...) or QSM");
    options.positional(
        "OUT", out_,
        "File to write; its extension tells the format. LAS and LAZ to each other keep everything; "
        "other clouds coordinates, intensity and class");
    options.choice("--qsm-format", format_, tree_format_names(),
                   "Format of a QSM (auto: .csv ours, .txt treefile, .mat TreeQSM; .obj .ply .glb meshes)");
    options.text("--shift", shift_, "X,Y,Z",
                 "Added to every coordinate, metres; 'local' takes a map grid's origin away and says which");
  }

  int run(Session& session) override {
    prepare_output_file(out_, session.common());
    FileInfo info = describe_file(in_, session.progress());
    std::string what;
    std::vector<std::string> lost;
    Vec3 shift = Vec3::Zero();
    if (info.cloud) {
      shift = resolve_shift(info.cloud->origin_shift);
      write_cloud(info, shift, session);
      what = fmt::format("{} points", info.cloud->size());
      lost = losses(*info.cloud, out_);
    } else if (info.tree) {
      shift = resolve_shift(rounded_origin(info.bounds));
      info.tree->origin_shift += shift;
      if (const auto format = write_any_tree(*info.tree)) lost = losses(*info.tree, out_, *format);
      if (!info.crs_wkt.empty())
        lost.push_back("tree models and meshes have no place for the coordinate system (" + info.crs_wkt +
                       "); it stays in the metrics.json beside the input");
      what = fmt::format("{} cylinders", info.tree->size());
    } else {
      throw InputError(fmt::format("{}: a {} cannot be converted; expected a point cloud or a QSM",
                                   in_.string(), info.kind));
    }
    nlohmann::ordered_json json = {{"output", out_.string()}, {"content", what}, {"lost", lost}};
    if (!shift.isZero(0)) json["shift"] = {shift.x(), shift.y(), shift.z()};
    session.json(json_text(json));
    session.say(fmt::format("{} -> {}: {}", in_.string(), out_.string(), what));
    if (!shift.isZero(0))
      session.say(fmt::format("  shifted by {},{},{} m (--shift {},{},{} takes it back)", shift.x(),
                              shift.y(), shift.z(), -shift.x(), -shift.y(), -shift.z()));
    for (const std::string& loss : lost) session.warn(loss);
    return 0;
  }

 private:
  static Vec3 rounded_origin(const Bounds& bounds) {
    Vec3 origin = Vec3::Zero();
    for (int k = 0; k < 3; ++k) {
      const double middle = 0.5 * (bounds.lo[k] + bounds.hi[k]);
      if (std::abs(middle) >= 100) origin[k] = std::round(middle / 100) * 100;
    }
    return origin;
  }

  Vec3 resolve_shift(const Vec3& origin) const {
    if (shift_.empty()) return Vec3::Zero();
    if (shift_ == "local") return Vec3::Zero() - origin;
    Vec3 shift = Vec3::Zero();
    std::istringstream words(shift_);
    int k = 0;
    try {
      for (std::string word; std::getline(words, word, ','); ++k)
        if (k < 3) shift[k] = parse_quantity(word, Quantity::length);
    } catch (const std::invalid_argument& error) {
      throw UsageError(std::string("--shift: ") + error.what());
    }
    if (k != 3)
      throw UsageError("--shift " + shift_ +
                       ": expected three lengths X,Y,Z such as 500000,5400000,0, or 'local'");
    return shift;
  }

  void write_cloud(FileInfo& info, const Vec3& shift, Session& session) const {
    const std::string extension = lower_extension(out_);
    const bool from_las = info.format == "las" || info.format == "laz";
    if (from_las && (extension == ".las" || extension == ".laz"))
      return copy_las(in_, out_, shift, session.progress());
    info.cloud->origin_shift += shift;
    write_point_cloud(out_, *info.cloud, {}, session.progress());
  }

  /// Returns the format, none for a mesh.
  std::optional<TreeFormat> write_any_tree(const Tree& tree) const {
    const std::string extension = lower_extension(out_);
    TreeFormat format = TreeFormat::ours;
    if (format_ != "auto") {
      format = kTreeFormats.at(format_);
    } else if (extension == ".obj") {
      write_tree_obj(out_, tree);
      return std::nullopt;
    } else if (extension == ".ply") {
      write_tree_ply(out_, tree);
      return std::nullopt;
    } else if (extension == ".glb") {
      write_tree_glb(out_, tree);
      return std::nullopt;
    } else if (extension == ".txt" || extension == ".mat") {
      format = extension == ".txt" ? TreeFormat::treefile : TreeFormat::treeqsm_mat;
    } else if (extension != ".csv") {
      throw UsageError(fmt::format(
          "{}: no QSM or mesh format goes by '{}'; expected .csv, .txt, .mat, .obj, .ply or .glb, "
          "or give --qsm-format",
          out_.string(), extension));
    }
    write_tree(out_, tree, format);
    return format;
  }

  std::filesystem::path in_, out_;
  std::string format_ = "auto", shift_;
};

}  // namespace

std::unique_ptr<Command> make_convert() {
  return std::make_unique<Convert>();
}

}  // namespace dendrofit::cli
