// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/errors.h"
#include "io/file_bytes.h"
#include "io/read_cameras.h"
#include "io/view_files.h"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <map>
#include <optional>
#include <string>

#include <nlohmann/json.hpp>

namespace dendrofit {
namespace {

using Json = nlohmann::json;

/// A JSON value and where it stands, for messages.
struct Field {
  const Json& value;
  std::string where;  ///< "cameras.json: images[3].camera"

  [[noreturn]] void fail(const std::string& expected) const {
    const bool nested = value.is_structured() && std::any_of(value.begin(), value.end(),
                                                             [](const Json& v) { return v.is_structured(); });
    // What is nested however deep is not written out: the library would call itself as often.
    std::string found = nested ? std::string(value.type_name()) + " of " + std::to_string(value.size())
                               : value.dump(-1, ' ', true, Json::error_handler_t::replace);
    if (found.size() > 60) found = found.substr(0, 57) + "...";
    throw InputError(where + " = " + found + ": expected " + expected);
  }
  void only(std::initializer_list<const char*> keys) const {
    if (!value.is_object()) fail("an object");
    for (const auto& [key, ignored] : value.items()) {
      bool known = false;
      std::string list;
      for (const char* k : keys) {
        known = known || key == k;
        list += (list.empty() ? "" : ", ") + std::string(k);
      }
      if (!known) throw InputError(where + ": unknown key \"" + key + "\"; known are " + list);
    }
  }
  bool has(const char* key) const { return value.contains(key); }
  Field at(const char* key) const {
    if (!value.contains(key)) throw InputError(where + ": the key \"" + key + "\" is missing");
    const std::string dot = where.ends_with(":") ? " " : ".";
    return {value.at(key), where + dot + key};
  }
  Field at(std::size_t i) const { return {value.at(i), where + "[" + std::to_string(i) + "]"}; }
  std::size_t list(const char* expected) const {
    if (!value.is_array() || value.empty()) fail(expected);
    return value.size();
  }
  double number() const {
    if (!value.is_number() || !std::isfinite(value.get<double>())) fail("a number");
    return value.get<double>();
  }
  double number_or(const char* key, double otherwise) const {
    return has(key) ? at(key).number() : otherwise;
  }
  int whole(int least) const {
    const double v = number();
    if (v != std::floor(v) || v < least || v > 1e6) fail("a whole number from " + std::to_string(least));
    return static_cast<int>(v);
  }
  std::string word(std::initializer_list<const char*> allowed) const {
    std::string list;
    for (const char* a : allowed) {
      if (value.is_string() && value.get<std::string>() == a) return a;
      list += (list.empty() ? "\"" : " or \"") + std::string(a) + "\"";
    }
    fail(list);
  }
  std::string text() const {
    if (!value.is_string() || value.get<std::string>().empty()) fail("a file name");
    return value.get<std::string>();
  }
  Vec3 vector() const {
    if (!value.is_array() || value.size() != 3) fail("three numbers");
    return {at(std::size_t{0}).number(), at(std::size_t{1}).number(), at(std::size_t{2}).number()};
  }
};

Camera intrinsics(const Field& json, double pixel_shift) {
  json.only({"id", "model", "width", "height", "fx", "fy", "cx", "cy", "k1", "k2"});
  json.at("model").word({"radial2"});
  Camera camera;
  camera.width = json.at("width").whole(1);
  camera.height = json.at("height").whole(1);
  for (const auto& [key, target] : {std::pair{"fx", &camera.fx}, std::pair{"fy", &camera.fy}}) {
    *target = json.at(key).number();
    if (*target <= 0) json.at(key).fail("a focal length in pixels, above 0");
  }
  camera.cx = json.at("cx").number() + pixel_shift;
  camera.cy = json.at("cy").number() + pixel_shift;
  camera.k1 = json.number_or("k1", 0);
  camera.k2 = json.number_or("k2", 0);
  return camera;
}

void pose(const Field& image, Camera& camera) {
  const bool from_world = image.has("camera_from_world");
  if (from_world == image.has("world_from_camera"))
    throw InputError(image.where + ": needs exactly one of camera_from_world and world_from_camera");
  const Field matrix = image.at(from_world ? "camera_from_world" : "world_from_camera");
  if (matrix.list("three rows of four numbers") != 3) matrix.fail("three rows of four numbers");
  Eigen::Matrix3d rotation;
  Vec3 translation;
  for (std::size_t r = 0; r < 3; ++r) {
    const Field row = matrix.at(r);
    if (row.list("four numbers") != 4) row.fail("four numbers");
    for (std::size_t c = 0; c < 3; ++c)
      rotation(static_cast<int>(r), static_cast<int>(c)) = row.at(c).number();
    translation[static_cast<int>(r)] = row.at(3).number();
  }
  const double det = rotation.determinant();
  const double skew = (rotation * rotation.transpose() - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff();
  if (det < 0)
    throw InputError(matrix.where + ": mirrored (determinant " + std::to_string(det) +
                     "); camera axes are x right, y down, z forward");
  if (std::abs(det - 1) > 1e-3 || skew > 1e-3)
    throw InputError(matrix.where + ": not a rotation (determinant " + std::to_string(det) +
                     "); expected orthonormal rows and determinant 1");
  // Digits lost in print are given back: the nearest rotation.
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(rotation, Eigen::ComputeFullU | Eigen::ComputeFullV);
  rotation = svd.matrixU() * svd.matrixV().transpose();
  camera.rotation = from_world ? rotation : Eigen::Matrix3d(rotation.transpose());
  camera.translation = from_world ? translation : Vec3(-(rotation.transpose() * translation));
}

std::filesystem::path existing(const Field& name, const std::filesystem::path& folder) {
  const std::filesystem::path path = folder / name.text();
  if (!std::filesystem::is_regular_file(path))
    throw InputError(name.where + ": " + path.string() +
                     " is not there; paths are relative to the cameras file");
  return path;
}

}  // namespace

void ReadCamerasOptions::validate() const {
  require(std::isfinite(most_megapixels) && most_megapixels > 0, "most_megapixels", most_megapixels,
          "must be positive");
  require(std::isfinite(most_megapixels_all) && most_megapixels_all > 0, "most_megapixels_all",
          most_megapixels_all, "must be positive");
}

ViewSet read_cameras_json(const std::filesystem::path& file, const ReadCamerasOptions& options) {
  options.validate();
  const FileBytes bytes(file);
  Json json;
  try {
    json = Json::parse(bytes.view());
  } catch (const Json::parse_error& error) {
    fail_at_byte(file, error.byte > 0 ? error.byte - 1 : 0, std::string("not JSON: ") + error.what());
  } catch (const Json::exception& error) {  // a number that no double holds
    fail_in_file(file, error.what());
  }
  const Field root{json, file.filename().string() + ":"};
  root.only(
      {"format", "version", "units", "up", "origin", "pixel_origin", "pose_error_px", "cameras", "images"});
  root.at("format").word({"dendrofit-cameras"});
  if (root.at("version").number() != 1) root.at("version").fail("1");
  root.at("units").word({"m"});
  const Vec3 up = root.at("up").vector();
  if (!(up.norm() > 1e-9)) root.at("up").fail("a direction, not zero");
  // Corner: the first pixel's centre is (0.5, 0.5), as ours; centre: it is (0, 0).
  const double shift = root.at("pixel_origin").word({"corner", "centre"}) == "centre" ? 0.5 : 0.0;

  ViewSet set;
  if (root.has("origin")) set.origin_shift = root.at("origin").vector();
  if (root.has("pose_error_px")) {
    set.pose_error_px = root.at("pose_error_px").number();
    if (*set.pose_error_px < 0) root.at("pose_error_px").fail("a number of pixels, not below 0");
  }
  std::map<int, Camera> cameras;
  const Field camera_list = root.at("cameras");
  for (std::size_t i = 0; i < camera_list.list("a list of cameras"); ++i) {
    const Field camera = camera_list.at(i);
    if (!camera.value.is_object()) camera.fail("an object");
    if (!cameras.emplace(camera.at("id").whole(0), intrinsics(camera, shift)).second)
      camera.at("id").fail("an id no other camera has");
  }
  std::vector<ViewFile> files;
  const Field image_list = root.at("images");
  for (std::size_t i = 0; i < image_list.list("a list of images"); ++i) {
    const Field image = image_list.at(i);
    image.only({"file", "mask", "camera", "camera_from_world", "world_from_camera"});
    const auto camera = cameras.find(image.at("camera").whole(0));
    if (camera == cameras.end()) image.at("camera").fail("the id of a camera in the list");
    ViewFile view{file.parent_path() / image.at("file").text(), {}, image.where, camera->second};
    if (options.load_photos) {
      view.photo = existing(image.at("file"), file.parent_path());
      if (image.has("mask")) view.mask = existing(image.at("mask"), file.parent_path());
    }
    pose(image, view.camera);
    files.push_back(std::move(view));
  }
  set.views = load_views(files, options, set.warnings);
  settle_world(set, up);
  return set;
}

}  // namespace dendrofit
