// SPDX-License-Identifier: GPL-3.0-or-later
// dendrofit view WHAT --png FILE
#include "cli/commands.h"
#include "cli/output_folder.h"
#include "cli/parse.h"
#include "cli/report/annotations.h"
#include "cli/report/render.h"
#include "core/errors.h"
#include "io/file_info.h"
#include "io/read_cloud.h"
#include "io/read_mesh.h"
#include "io/read_tree.h"

#include <deque>
#include <sstream>

#include <fmt/format.h>

namespace dendrofit::cli {
namespace {

namespace fs = std::filesystem;

/// A mesh of leaves as one instance of one shape: what the renderer draws.
Foliage as_foliage(TriangleMesh mesh) {
  Foliage foliage;
  foliage.origin_shift = mesh.origin_shift;
  LeafShape shape;
  shape.vertices = std::move(mesh.vertices);
  shape.triangles = std::move(mesh.triangles);
  foliage.shapes.push_back(std::move(shape));
  Leaf leaf;
  leaf.length_m = 1;
  foliage.leaves.push_back(leaf);
  return foliage;
}

TreeColour colour_from(const std::string& word) {
  if (word == "quality") return TreeColour::quality;
  if (word == "radius") return TreeColour::radius;
  if (word == "bark") return TreeColour::bark;
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
    options.path("--scan", scan_, "Point cloud to show beside a folder's trees");
    options.number("--azimuth", azimuth_, Quantity::angle,
                   "Look north from the south (0), west from the east (90), ...");
    options.number("--elevation", elevation_, Quantity::angle, "Level (0) to straight down (90)");
    options.number("--perspective", perspective_, Quantity::angle,
                   "Opening angle; without it true lengths across the line of sight");
    options.text("--zoom", zoom_, "X0,Y0,Z0,X1,Y1,Z1", "Show this box only, metres about the tree's foot");
    options.choice("--colour", colour_, {"order", "quality", "radius", "bark"},
                   "What the colour of wood stands for");
    options.flag("--cylinders", cylinders_, "The cylinders as they are, not smoothed to stems and branches");
    options.integer("--width", width_, "Of one panel, pixels at most");
    options.integer("--height", height_, "Of the picture, pixels at most");
  }

  int run(Session& session) override {
    if (png_.empty()) throw UsageError("view: no picture named; give --png FILE");
    RenderOptions options;
    options.camera.azimuth_deg = azimuth_;
    options.camera.elevation_deg = elevation_;
    options.camera.perspective_fov_deg = perspective_;
    if (!zoom_.empty()) options.camera.zoom_box = box_from(zoom_);
    options.panel_width_px = width_;
    options.height_px = height_;
    options.threads = session.common().threads;
    options.validate();
    prepare_output_file(png_, session.common());

    if (fs::is_directory(what_))
      add_folder(session);
    else
      add_file(what_);
    if (panels_.empty())
      throw IoError(
          fmt::format("{}: nothing to show; expected a folder with qsm.csv, regrown/qsm.csv or leaves.obj",
                      what_.string()));
    const Image image =
        render(std::vector<Panel>(panels_.begin(), panels_.end()), options, session.progress());
    write_png(png_, image);
    session.json(fmt::format("{{\"width\": {}, \"height\": {}, \"panels\": {}}}", image.width, image.height,
                             panels_.size()));
    session.say(fmt::format("Written: {} ({} x {} pixels)", png_.string(), image.width, image.height));
    return 0;
  }

 private:
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
    trees_.push_back(tree);
    add_panel(title, with_thousands(tree.size()) + " cylinders").tree = &trees_.back();
  }

  void add_cloud(const std::string& title, PointCloud cloud) {
    clouds_.push_back(std::move(cloud));
    add_panel(title, with_thousands(clouds_.back().size()) + " points").cloud = &clouds_.back();
  }

  void add_folder(Session& session) {
    if (!scan_.empty()) add_cloud("Scan", read_point_cloud(scan_, {}, session.progress()));
    if (fs::exists(what_ / "qsm.csv")) add_tree("Model", read_tree(what_ / "qsm.csv"));
    if (fs::exists(what_ / "regrown" / "qsm.csv"))
      add_tree("Regrown", read_tree(what_ / "regrown" / "qsm.csv"));
    if (!scan_.empty() && !trees_.empty())  // the scan stands where its model stands
      panels_.front().anchor = trees_.front().origin_shift + trees_.front().start[0];
    if (!fs::exists(what_ / "leaves.obj")) return;
    leaves_.push_back(as_foliage(read_mesh(what_ / "leaves.obj")));
    Panel& panel = add_panel("With leaves", "");
    panel.foliage = &leaves_.back();
    panel.tree = trees_.empty() ? nullptr : &trees_.back();
    panel.tree_colour = TreeColour::bark;
  }

  void add_file(const fs::path& file) {
    const FileInfo info = describe_file(file);
    const std::string name = file.filename().string();
    if (info.tree)
      add_tree(name, *info.tree);
    else if (info.cloud)
      add_cloud(name, *info.cloud);
    else
      throw IoError(fmt::format("{}: a {} ({}); view shows folders of results, point clouds and QSMs",
                                file.string(), info.kind, info.format));
  }

  fs::path what_, png_, scan_;
  double azimuth_ = 0;
  double elevation_ = 0;
  std::optional<double> perspective_;
  std::string zoom_;
  std::string colour_ = "order";
  bool cylinders_ = false;
  int width_ = RenderOptions{}.panel_width_px;
  int height_ = RenderOptions{}.height_px;
  // Deques: panels point at their elements.
  std::deque<Tree> trees_;
  std::deque<PointCloud> clouds_;
  std::deque<Foliage> leaves_;
  std::deque<Panel> panels_;
};

}  // namespace

std::unique_ptr<Command> make_view() {
  return std::make_unique<View>();
}

}  // namespace dendrofit::cli
