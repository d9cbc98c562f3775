// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/errors.h"
#include "io/file_bytes.h"
#include "io/read_cameras.h"
#include "io/text_numbers.h"
#include "io/view_files.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>

namespace dendrofit {
namespace {

namespace fs = std::filesystem;

/// Lines of a text file with their numbers, comments left out, empty lines kept.
struct Line {
  std::size_t number;
  std::string_view text;
};

std::vector<Line> lines_of(std::string_view text) {
  std::vector<Line> lines;
  std::size_t number = 0;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    const std::string_view line = trimmed(text.substr(0, end));
    ++number;
    if (!line.starts_with('#')) lines.push_back({number, line});
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return lines;
}

std::vector<std::string_view> words_of(std::string_view line, std::size_t most) {
  std::vector<std::string_view> words;
  while (!(line = trimmed(line)).empty()) {
    const std::size_t end =
        words.size() + 1 == most ? line.size() : std::min(line.find_first_of(" \t"), line.size());
    words.push_back(line.substr(0, end));
    line.remove_prefix(end);
  }
  return words;
}

double number_of(const fs::path& file, const Line& line, std::string_view word, const char* what) {
  double value = 0;
  if (!number_from(word, value) || !std::isfinite(value))
    fail_at_line(file, line.number, std::string(what) + " = " + shown(word) + ": expected a number");
  return value;
}

int whole_of(const fs::path& file, const Line& line, std::string_view word, const char* what) {
  std::int64_t value = 0;
  if (!integer_from(word, value) || value < 0 || value > 2'000'000'000)
    fail_at_line(file, line.number, std::string(what) + " = " + shown(word) + ": expected a whole number");
  return static_cast<int>(value);
}

struct ColmapModel {
  std::string_view name;
  std::size_t parameters;
  Camera (*camera)(const std::vector<double>&);
};

constexpr std::array<ColmapModel, 4> kModels = {{
    {"SIMPLE_PINHOLE", 3,
     [](const std::vector<double>& p) { return Camera{.fx = p[0], .fy = p[0], .cx = p[1], .cy = p[2]}; }},
    {"PINHOLE", 4,
     [](const std::vector<double>& p) { return Camera{.fx = p[0], .fy = p[1], .cx = p[2], .cy = p[3]}; }},
    {"SIMPLE_RADIAL", 4,
     [](const std::vector<double>& p) {
       return Camera{.fx = p[0], .fy = p[0], .cx = p[1], .cy = p[2], .k1 = p[3]};
     }},
    {"RADIAL", 5,
     [](const std::vector<double>& p) {
       return Camera{.fx = p[0], .fy = p[0], .cx = p[1], .cy = p[2], .k1 = p[3], .k2 = p[4]};
     }},
}};

std::map<int, Camera> read_intrinsics(const fs::path& file) {
  const FileBytes bytes(file);
  std::map<int, Camera> cameras;
  for (const Line& line : lines_of(bytes.view())) {
    if (line.text.empty()) continue;
    const auto words = words_of(line.text, 100);
    if (words.size() < 4) fail_at_line(file, line.number, "expected CAMERA_ID MODEL WIDTH HEIGHT PARAMS");
    const auto model =
        std::find_if(kModels.begin(), kModels.end(), [&](const auto& m) { return m.name == words[1]; });
    if (model == kModels.end())
      fail_at_line(file, line.number,
                   "camera model " + shown(words[1]) +
                       " is not supported; undistort the images (colmap image_undistorter) or use PINHOLE, "
                       "SIMPLE_PINHOLE, SIMPLE_RADIAL or RADIAL");
    if (words.size() != 4 + model->parameters)
      fail_at_line(file, line.number,
                   std::string(model->name) + " has " + std::to_string(words.size() - 4) +
                       " parameters: expected " + std::to_string(model->parameters));
    std::vector<double> p;
    for (std::size_t i = 4; i < words.size(); ++i) p.push_back(number_of(file, line, words[i], "parameter"));
    Camera camera = model->camera(p);
    camera.width = whole_of(file, line, words[2], "WIDTH");
    camera.height = whole_of(file, line, words[3], "HEIGHT");
    if (camera.width < 1 || camera.height < 1 || camera.fx <= 0 || camera.fy <= 0)
      fail_at_line(file, line.number, "width, height and focal lengths must be positive");
    if (!cameras.emplace(whole_of(file, line, words[0], "CAMERA_ID"), camera).second)
      fail_at_line(file, line.number, "camera " + std::string(words[0]) + " is listed twice");
  }
  if (cameras.empty()) fail_in_file(file, "lists no camera");
  return cameras;
}

/// Ids of cameras whose relative focal length no camera of this set can have, each with a warning.
std::vector<int> impossible_cameras(const std::map<int, Camera>& cameras,
                                    std::vector<std::string>& warnings) {
  std::vector<double> focal;
  const auto relative = [](const Camera& c) { return c.fx / std::max(c.width, c.height); };
  for (const auto& [id, c] : cameras) focal.push_back(relative(c));
  std::nth_element(focal.begin(), focal.begin() + static_cast<std::ptrdiff_t>(focal.size() / 2), focal.end());
  const double median = focal[focal.size() / 2];
  std::vector<int> dropped;
  for (const auto& [id, c] : cameras) {
    const double ratio = relative(c) / median;
    if (ratio < 1.5 && ratio > 1 / 1.5) continue;
    dropped.push_back(id);
    warnings.push_back("camera " + std::to_string(id) + " is dropped with its images: its focal length of " +
                       std::to_string(std::lround(c.fx)) + " px is more than 1.5 times off the median (" +
                       std::to_string(std::lround(median * std::max(c.width, c.height))) + " px)");
  }
  return dropped;
}

fs::path find_beside(const fs::path& folder, const fs::path& name,
                     std::initializer_list<const char*> places) {
  fs::path base = folder;
  for (int level = 0; level < 3; ++level, base /= "..")
    for (const char* place : places)
      if (fs::is_regular_file(base / place / name)) return base / place / name;
  return {};
}

/// One image line and its camera's pose (COLMAP: quaternion w x y z and translation, camera from world).
void read_pose(const fs::path& file, const Line& line, const std::vector<std::string_view>& words,
               Camera& camera) {
  std::array<double, 7> v{};
  for (std::size_t i = 0; i < 7; ++i)
    v[i] = number_of(file, line, words[i + 1], i < 4 ? "quaternion" : "translation");
  const Eigen::Quaterniond q(v[0], v[1], v[2], v[3]);
  if (std::abs(q.norm() - 1) > 1e-3)
    fail_at_line(file, line.number, "quaternion of length " + std::to_string(q.norm()) + ": expected 1");
  camera.rotation = q.normalized().toRotationMatrix();
  camera.translation = {v[4], v[5], v[6]};
}

/// Upwards, in the world of cameras that were held level from side to side, however they look up or down: the
/// direction most nearly square to all their x axes. Where these say little (one line of sight), the mean of
/// what is up in the pictures. Zero where nothing is.
Vec3 common_up(const std::vector<ViewFile>& files) {
  constexpr double kLeastSpread = 0.02, kClear = 10;  // of the x axes; times the spread across it
  Vec3 up_in_pictures = Vec3::Zero();
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (const ViewFile& file : files) {
    const Vec3 x = file.camera.rotation.row(0);
    up_in_pictures -= file.camera.rotation.row(1).transpose() / static_cast<double>(files.size());
    spread += x * x.transpose() / static_cast<double>(files.size());
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(spread);
  const Vec3 up = axes.eigenvectors().col(0);
  const double side = up.dot(up_in_pictures);
  if (axes.eigenvalues()[1] >= std::max(kLeastSpread, kClear * axes.eigenvalues()[0]) && std::abs(side) > 0.3)
    return side > 0 ? up : Vec3(-up);
  return up_in_pictures.norm() > 0.1 ? up_in_pictures : Vec3(Vec3::Zero());
}

}  // namespace

ViewSet read_colmap(const fs::path& folder, const ReadCamerasOptions& options) {
  options.validate();
  for (const char* name : {"cameras.txt", "images.txt"})
    if (!fs::is_regular_file(folder / name))
      throw IoError((folder / name).string() +
                    ": not there; expected a COLMAP text model (colmap model_converter --output_type TXT)");
  ViewSet set;
  set.metric = false;
  const std::map<int, Camera> cameras = read_intrinsics(folder / "cameras.txt");
  const std::vector<int> dropped = impossible_cameras(cameras, set.warnings);

  const fs::path file = folder / "images.txt";
  const FileBytes bytes(file);
  const std::vector<Line> lines = lines_of(bytes.view());
  std::vector<ViewFile> files;
  std::size_t at = 0;
  while (at < lines.size()) {
    const Line& line = lines[at];
    if (line.text.empty()) {
      ++at;
      continue;
    }
    at += 2;  // the image's line and its points, which may be an empty line
    const auto words = words_of(line.text, 10);
    if (words.size() != 10)
      fail_at_line(file, line.number, "expected IMAGE_ID QW QX QY QZ TX TY TZ CAMERA_ID NAME");
    const int id = whole_of(file, line, words[8], "CAMERA_ID");
    const auto camera = cameras.find(id);
    if (camera == cameras.end())
      fail_at_line(file, line.number, "camera " + std::to_string(id) + " is not in cameras.txt");
    if (std::find(dropped.begin(), dropped.end(), id) != dropped.end()) continue;
    const fs::path name(words[9]);
    ViewFile view{name, {}, "images.txt, line " + std::to_string(line.number), camera->second};
    read_pose(file, line, words, view.camera);
    if (options.load_photos) {
      view.photo = find_beside(folder, name, {"", "images"});
      if (view.photo.empty()) {
        std::string also;
        for (const std::string& warning : set.warnings) also += "; " + warning;
        fail_at_line(file, line.number,
                     "photograph " + name.string() +
                         " is not in the folder, its images/, or those of the two folders above" + also);
      }
      view.mask = find_beside(folder, name.string() + ".png", {"masks"});
    }
    files.push_back(std::move(view));
  }
  if (files.empty()) fail_in_file(file, "lists no image with a usable camera");
  const Vec3 up = common_up(files);
  if (up.isZero()) fail_in_file(file, "the cameras have no common upward direction; hold the camera upright");
  set.views = load_views(files, options, set.warnings);
  settle_world(set, up);
  return set;
}

}  // namespace dendrofit
