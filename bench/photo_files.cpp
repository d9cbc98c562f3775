// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/photo_files.h"

#include "cli/report/image.h"
#include "core/atomic_file.h"

#include <string>

#include <Eigen/Geometry>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace dendrofit::bench {
namespace {

namespace fs = std::filesystem;

void write_colmap(const fs::path& folder, const ViewSet& set) {
  fs::create_directories(folder);
  const Camera& c = set.views.front().camera;
  write_file(folder / "cameras.txt",
             fmt::format("# Camera list\n1 RADIAL {} {} {:.9g} {:.9g} {:.9g} {:.9g} {:.9g}\n", c.width,
                         c.height, c.fx, c.cx, c.cy, c.k1, c.k2));
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(1.1, Vec3(0.6, -0.3, 0.74).normalized()).toRotationMatrix();
  const Vec3 shift(0.4, -1.2, 2.5);
  std::string images = "# Image list with two lines of data per image\n";
  for (std::size_t v = 0; v < set.views.size(); ++v) {
    const Camera& camera = set.views[v].camera;
    const Eigen::Quaterniond q(Eigen::Matrix3d(camera.rotation * turn.transpose()));
    const Vec3 t = (camera.translation - camera.rotation * turn.transpose() * shift) / 0.27;
    images += fmt::format("{} {:.12g} {:.12g} {:.12g} {:.12g} {:.12g} {:.12g} {:.12g} 1 {}.png\n\n", v + 1,
                          q.w(), q.x(), q.y(), q.z(), t.x(), t.y(), t.z(), set.views[v].photo.name);
  }
  write_file(folder / "images.txt", images);
}

}  // namespace

void write_views(const fs::path& folder, const ViewSet& set) {
  fs::create_directories(folder);
  nlohmann::ordered_json json = {
      {"format", "dendrofit-cameras"}, {"version", 1}, {"units", "m"}, {"up", {0, 0, 1}}};
  json["origin"] = {set.origin_shift.x(), set.origin_shift.y(), set.origin_shift.z()};
  json["pixel_origin"] = "corner";
  const Camera& first = set.views.front().camera;
  json["cameras"] = nlohmann::ordered_json::array();
  json["cameras"].push_back({{"id", 0},
                             {"model", "radial2"},
                             {"width", first.width},
                             {"height", first.height},
                             {"fx", first.fx},
                             {"fy", first.fy},
                             {"cx", first.cx},
                             {"cy", first.cy},
                             {"k1", first.k1},
                             {"k2", first.k2}});
  json["images"] = nlohmann::ordered_json::array();
  for (const View& view : set.views) {
    nlohmann::ordered_json pose = nlohmann::ordered_json::array();
    for (int r = 0; r < 3; ++r)
      pose.push_back({view.camera.rotation(r, 0), view.camera.rotation(r, 1), view.camera.rotation(r, 2),
                      view.camera.translation[r]});
    const std::string photo = view.photo.name + ".png", mask = "mask_" + view.photo.name.substr(5) + ".png";
    Image image(view.photo.width, view.photo.height, {});
    image.rgb = view.photo.rgb;
    write_png(folder / photo, image);
    for (std::size_t i = 0; i < view.photo.mask.size(); ++i)
      for (std::size_t k = 0; k < 3; ++k) image.rgb[3 * i + k] = view.photo.mask[i];
    write_png(folder / mask, image);
    json["images"].push_back({{"file", photo}, {"mask", mask}, {"camera", 0}, {"camera_from_world", pose}});
  }
  write_file(folder / "cameras.json", json.dump(1) + "\n");
  write_colmap(folder / "colmap", set);
}

}  // namespace dendrofit::bench
