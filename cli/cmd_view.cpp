// SPDX-License-Identifier: GPL-3.0-or-later
// dendrofit view WHAT --png FILE | --html FILE
#include "cli/commands.h"
#include "cli/output_folder.h"
#include "cli/parse.h"
#include "cli/report/annotations.h"
#include "cli/report/render.h"
#include "cli/report/report.h"
#include "cli/result_folder.h"
#include "cli/site_file.h"
#include "cli/surroundings.h"
#include "cli/version.h"
#include "core/atomic_file.h"
#include "core/errors.h"
#include "io/file_info.h"
#include "io/read_cloud.h"

#include <algorithm>
#include <cctype>
#include <deque>
#include <sstream>

#include <fmt/format.h>

namespace dendrofit::cli {
namespace {

namespace fs = std::filesystem;

TreeColour colour_from(const std::string& word) {
  if (word == "quality") return TreeColour::quality;
  if (word == "radius") return TreeColour::radius;
  if (word == "bark") return TreeColour::bark;
  if (word == "age") return TreeColour::birth_cycle;
  return TreeColour::order;
}

/// "x0,y0,z0,x1,y1,z1" in metres about the tree's foot.
Bounds box_from(const std::string& text) {
  std::vector<double> numbers;
  std::stringstream list(text);
  for (std::string word; std::getline(list, word, ',');) {
    try {
      numbers.push_back(parse_quantity(word, Quantity::length));
    } catch (const std::invalid_argument& fault) {
      throw UsageError(fmt::format("--zoom {}: {}", text, fault.what()));
    }
  }
  if (numbers.size() != 6)
    throw UsageError(
        fmt::format("--zoom {}: {} numbers; expected six: x0,y0,z0,x1,y1,z1 in metres about the foot", text,
                    numbers.size()));
  Bounds box;
  box.add({numbers[0], numbers[1], numbers[2]});
  box.add({numbers[3], numbers[4], numbers[5]});
  return box;
}

class View : public Command {
 public:
  void declare(OptionTable& options) override {
    options.positional("WHAT", what_,
                       "A folder of results (of run, reconstruct, grow, leaves), a point cloud or a QSM");
    options.path("--png", png_, "The picture to write");
    options.path("--html", html_,
                 "A page to look at it in three dimensions, with a growth slider where it was grown");
    options.path("--scan", scan_, "Point cloud to show beside a folder's trees");
    options.path("--site", site_,
                 "Site file whose obstacles to show, seen through (of a folder of grow its own)");
    options.number("--azimuth", azimuth_, Quantity::angle,
                   "Look north from the south (0), west from the east (90), ...");
    options.number("--elevation", elevation_, Quantity::angle, "Level (0) to straight down (90)");
    options.number("--perspective", perspective_, Quantity::angle,
                   "Opening angle; without it true lengths across the line of sight");
    options.text("--zoom", zoom_, "X0,Y0,Z0,X1,Y1,Z1", "Show this box only, metres about the tree's foot");
    options.choice("--colour", colour_, {"order", "quality", "radius", "bark", "age"},
                   "What the colour of wood stands for (age: of the wood of a grown tree)");
    options.flag("--cylinders", cylinders_, "The cylinders as they are, not smoothed to stems and branches");
    options.integer("--width", width_, "Of one panel, pixels at most");
    options.integer("--height", height_, "Of the picture, pixels at most");
  }

  int run(Session& session) override {
    if (png_.empty() && html_.empty())
      throw UsageError("view: nothing to write named; give --png FILE, --html FILE or both");
    need_extension(png_, "--png", {".png"});
    need_extension(html_, "--html", {".html", ".htm"});
    const RenderOptions options = render_options(session);
    for (const fs::path& file : {png_, html_})
      if (!file.empty()) prepare_output_file(file, session.common());

    if (fs::is_directory(what_))
      add_folder(session);
    else
      add_file(what_);
    if (panels_.empty())
      throw IoError(fmt::format(
          "{}: nothing to show; expected a folder with qsm.csv, regrown/qsm.csv, leaves.glb or leaves.obj",
          what_.string()));
    add_surroundings();
    const Image image =
        render(std::vector<Panel>(panels_.begin(), panels_.end()), options, session.progress());
    if (!png_.empty()) {
      write_png(png_, image);
      session.say(fmt::format("Written: {} ({} x {} pixels)", png_.string(), image.width, image.height));
    }
    if (!html_.empty()) {
      write_page(session, image);
      session.say("Written: " + html_.string());
    }
    session.json(fmt::format("{{\"width\": {}, \"height\": {}, \"panels\": {}}}", image.width, image.height,
                             panels_.size()));
    return 0;
  }

 private:
  static void need_extension(const fs::path& file, const std::string& option,
                             const std::vector<std::string>& allowed) {
    if (file.empty()) return;
    std::string extension = file.extension().string();
    for (char& c : extension) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    if (std::find(allowed.begin(), allowed.end(), extension) == allowed.end())
      throw UsageError(fmt::format("{} {}: this option writes {} files only; end the name in {}", option,
                                   file.string(), allowed.front().substr(1), allowed.front()));
  }

  RenderOptions render_options(const Session& session) const {
    RenderOptions options;
    options.camera.azimuth_deg = azimuth_;
    options.camera.elevation_deg = elevation_;
    options.camera.perspective_fov_deg = perspective_;
    if (!zoom_.empty()) options.camera.zoom_box = box_from(zoom_);
    options.panel_width_px = width_;
    options.height_px = height_;
    options.threads = session.common().threads;
    options.validate();
    return options;
  }

  void add_surroundings() {
    const fs::path own = fs::is_directory(what_) ? what_ / "site.toml" : fs::path();
    const fs::path file = !site_.empty() ? site_ : fs::exists(own) ? own : fs::path();
    if (file.empty()) return;
    const IgmSite site = load_site(file, {}).site;
    for (Panel& panel : panels_) {
      if (!panel.tree) continue;
      Bounds shown;
      for (const auto* ends : {&panel.tree->start, &panel.tree->end})
        for (const Vec3& end : *ends) shown.add(end + panel.tree->origin_shift);
      surroundings_.push_back(surroundings_of(site, shown));
      panel.surroundings = &surroundings_.back();
    }
  }

  void write_page(Session& session, const Image& image) const {
    ReportData data = folder_.report;
    const fs::path named = what_.has_filename() ? what_ : what_.parent_path();
    data.title = fs::is_directory(what_) ? named.filename().string() : named.stem().string();
    if (!clouds_.empty()) data.scan = &clouds_.front();
    const auto pointer = [](const auto& held) { return held ? &*held : nullptr; };
    data.model = pointer(folder_.model);
    data.regrown = pointer(folder_.regrown);
    data.foliage = pointer(folder_.foliage);
    data.leaves_on_model = folder_.bearer() == data.model;
    data.model_metrics = pointer(folder_.model_metrics);
    data.regrown_metrics = pointer(folder_.regrown_metrics);
    data.side_by_side_png = encode_png(image);
    data.overlay_png = folder_.overlay_png;
    if (data.provenance.version.empty()) {  // else the run that made the folder says how
      data.provenance.version = version();
      data.provenance.command_line = fmt::format("dendrofit view {}", named.filename().string());
      data.provenance.input_name = named.filename().string();
    }
    write_file(html_, make_report(data, {}, session.progress()));
  }

  Panel& add_panel(const std::string& title, const std::string& subtitle) {
    Panel panel;
    panel.title = title;
    panel.subtitle = subtitle;
    panel.tree_colour = colour_from(colour_);
    panel.smooth_wood = !cylinders_;
    panels_.push_back(panel);
    return panels_.back();
  }

  void add_tree(const std::string& title, const Tree& tree) {
    add_panel(title, with_thousands(tree.size()) + " cylinders").tree = &tree;
  }

  void add_cloud(const std::string& title, PointCloud cloud) {
    clouds_.push_back(std::move(cloud));
    add_panel(title, with_thousands(clouds_.back().size()) + " points").cloud = &clouds_.back();
  }

  void add_folder(Session& session) {
    folder_ = read_result_folder(what_);
    if (!scan_.empty()) add_cloud("Scan", read_point_cloud(scan_, {}, session.progress()));
    if (folder_.model) add_tree("Model", *folder_.model);
    if (folder_.regrown) add_tree(folder_.model ? "Regrown" : "Grown", *folder_.regrown);
    const Tree* first = folder_.model ? &*folder_.model : folder_.bearer();
    if (!scan_.empty() && first)  // the scan stands where its model stands
      panels_.front().anchor = first->origin_shift + first->start[0];
    if (!folder_.foliage) return;
    Panel& panel =
        add_panel("With leaves",
                  folder_.leaf_count > 0 ? with_thousands(folder_.leaf_count) + " leaves" : std::string());
    panel.foliage = &*folder_.foliage;
    panel.tree = folder_.bearer();
    panel.tree_colour = TreeColour::bark;
  }

  void add_file(const fs::path& file) {
    FileInfo info = describe_file(file);
    const std::string name = file.filename().string();
    if (info.tree) {
      folder_.model = std::move(info.tree);
      folder_.model_metrics = measure(*folder_.model);
      add_tree(name, *folder_.model);
    } else if (info.cloud) {
      add_cloud(name, std::move(*info.cloud));
    } else {
      throw IoError(fmt::format("{}: a {} ({}); view shows folders of results, point clouds and QSMs",
                                file.string(), info.kind, info.format));
    }
  }

  fs::path what_, png_, html_, scan_, site_;
  double azimuth_ = 0;
  double elevation_ = 0;
  std::optional<double> perspective_;
  std::string zoom_;
  std::string colour_ = "order";
  bool cylinders_ = false;
  int width_ = RenderOptions{}.panel_width_px;
  int height_ = RenderOptions{}.height_px;
  ResultFolder folder_;
  std::deque<PointCloud> clouds_;  // deques: panels point at their elements
  std::deque<TriangleMesh> surroundings_;
  std::deque<Panel> panels_;
};

}  // namespace

std::unique_ptr<Command> make_view() {
  return std::make_unique<View>();
}

}  // namespace dendrofit::cli
