// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/errors.h"
#include "io/read_cameras.h"
#include "tests/io/picture_samples.h"
#include "tests/support/scratch_folder.h"
#include "tests/support/shared_data.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace dendrofit {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;
using Json = nlohmann::json;

/// A valid file with one 40 x 30 picture, looking north from (500000, 5600000, 202).
class CamerasJson : public ::testing::Test {
 protected:
  CamerasJson() {
    test::write_png_file(folder / "view.png", 40, 30, 3, 8, [](int, int) {
      return std::vector<unsigned>{200, 210, 220};
    });
    test::write_png_file(folder / "mask.png", 40, 30, 1, 8,
                         [](int x, int) { return std::vector<unsigned>{x == 20 ? 255u : 0u}; });
    json = Json::parse(R"({"format":"dendrofit-cameras","version":1,"units":"m","up":[0,0,1],
      "origin":[500000,5600000,200],"pixel_origin":"centre",
      "cameras":[{"id":3,"model":"radial2","width":40,"height":30,"fx":50,"fy":50,"cx":19.5,"cy":14.5,"k1":-0.03}],
      "images":[{"file":"view.png","mask":"mask.png","camera":3,
                 "world_from_camera":[[1,0,0,0],[0,0,1,0],[0,-1,0,2]]}]})");
  }
  ViewSet read() {
    std::ofstream(folder / "cameras.json") << json.dump();
    return read_cameras_json(folder / "cameras.json");
  }
  void expect_refused(const std::string& where, const std::string& why) {
    EXPECT_THAT([&] { read(); }, ThrowsMessage<InputError>(AllOf(HasSubstr(where), HasSubstr(why))));
  }
  test::ScratchFolder folder;
  Json json;
};

TEST_F(CamerasJson, gives_cameras_in_our_pixel_origin_and_world) {
  const ViewSet set = read();
  ASSERT_EQ(set.views.size(), 1u);
  const Camera& camera = set.views[0].camera;
  EXPECT_DOUBLE_EQ(camera.cx, 20);
  EXPECT_DOUBLE_EQ(camera.k1, -0.03);
  EXPECT_TRUE((set.origin_shift + camera.centre()).isApprox(Vec3(500000, 5600000, 202), 1e-15));
  // A point 10 m north of the camera is in the picture's middle; one above it is higher up.
  const Vec3 ahead = camera.centre() + Vec3(0, 10, 0);
  EXPECT_NEAR((*camera.project(ahead) - Eigen::Vector2d(20, 15)).norm(), 0, 1e-9);
  EXPECT_LT(camera.project(ahead + Vec3::UnitZ())->y(), 15);
  EXPECT_TRUE(set.metric);
  EXPECT_EQ(set.views[0].photo.mask[set.views[0].photo.pixel(20, 3)], 1);
}

TEST_F(CamerasJson, turns_the_world_upright) {
  json["up"] = {0, 1, 0};
  json.erase("origin");
  json["images"][0]["world_from_camera"] = {{1, 0, 0, 0}, {0, -1, 0, 2}, {0, 0, -1, 0}};
  const ViewSet set = read();
  const Camera& camera = set.views[0].camera;
  EXPECT_NEAR(camera.centre().z() + set.origin_shift.z(), 2, 1e-12);
  EXPECT_LT(camera.project(camera.centre() + 10 * camera.rotation.row(2).transpose() + Vec3::UnitZ())->y(),
            15);
}

TEST_F(CamerasJson, moves_far_worlds_near_without_loss) {
  json.erase("origin");
  json["images"][0]["world_from_camera"] = {{1, 0, 0, 500000.25}, {0, 0, 1, 5600000.5}, {0, -1, 0, 202}};
  const ViewSet set = read();
  EXPECT_LT(set.views[0].camera.centre().norm(), 2);
  EXPECT_LT((set.origin_shift + set.views[0].camera.centre() - Vec3(500000.25, 5600000.5, 202)).norm(), 1e-6);
}

TEST_F(CamerasJson, refuses_field_by_field) {
  const Json valid = json;
  const auto with = [&](const std::string& pointer, const Json& value) {
    json = valid;
    json[Json::json_pointer(pointer)] = value;
  };
  with("/units", "ft"), expect_refused("units", "\"m\"");
  with("/version", 2), expect_refused("version", "1");
  with("/format", "colmap"), expect_refused("format", "dendrofit-cameras");
  with("/up", {0, 0, 0}), expect_refused("up", "direction");
  with("/pixel_origin", "middle"), expect_refused("pixel_origin", "corner");
  with("/colour", 1), expect_refused("colour", "unknown key");
  with("/cameras/0/model", "fisheye"), expect_refused("cameras[0].model", "radial2");
  with("/cameras/0/fx", 0), expect_refused("cameras[0].fx", "above 0");
  with("/cameras/0/fx", "wide"), expect_refused("cameras[0].fx", "a number");
  with("/cameras/0/k3", 0), expect_refused("cameras[0]", "unknown key \"k3\"");
  with("/cameras/0/width", 41), expect_refused("images[0]", "40 x 30");
  with("/images/0/camera", 4), expect_refused("images[0].camera", "id of a camera");
  with("/images/0/file", "other.png"), expect_refused("images[0].file", "is not there");
  with("/images/0/world_from_camera/0/0", 1.01), expect_refused("world_from_camera", "not a rotation");
  with("/images/0/world_from_camera/0/0", -1), expect_refused("world_from_camera", "mirrored");
  with("/images/0/world_from_camera", {{1, 0, 0, 0}, {0, 0, 1, 0}}),
      expect_refused("world_from_camera", "three rows");
  with("/images/0/camera_from_world", valid["images"][0]["world_from_camera"]),
      expect_refused("images[0]", "exactly one");
  with("/pose_error_px", -1), expect_refused("pose_error_px", "not below 0");
  with("/cameras/1", valid["cameras"][0]), expect_refused("cameras[1].id", "no other camera");
  for (const char* key : {"up", "units", "images", "pixel_origin"}) {
    json = valid;
    json.erase(key);
    expect_refused(std::string("\"") + key + "\"", "missing");
  }
  std::ofstream(folder / "broken.json") << "{\"format\": ";
  EXPECT_THROW(read_cameras_json(folder / "broken.json"), IoError);
  std::ofstream(folder / "broken.json") << "{\"format\": 1e999}";  // no double holds it
  EXPECT_THROW(read_cameras_json(folder / "broken.json"), IoError);
  const std::string open(200000, '['), close(200000, ']');  // deeper than any call stack
  std::ofstream(folder / "broken.json") << open << close;
  EXPECT_THROW(read_cameras_json(folder / "broken.json"), InputError);
  std::ofstream(folder / "broken.json") << "{\"format\": " << open << close << "}";
  EXPECT_THROW(read_cameras_json(folder / "broken.json"), InputError);
}

TEST_F(CamerasJson, halves_cameras_with_their_pictures) {
  std::ofstream(folder / "cameras.json") << json.dump();
  const ViewSet whole = read();
  const ViewSet half = read_cameras_json(folder / "cameras.json", {.most_megapixels_all = 500e-6});
  const Vec3 p = whole.views[0].camera.centre() + Vec3(1, 10, 1);
  EXPECT_EQ(half.views[0].photo.width, 20);
  EXPECT_LT((2 * *half.views[0].camera.project(p) - *whole.views[0].camera.project(p)).norm(), 1e-9);
  ASSERT_EQ(half.warnings.size(), 1u);
}

TEST(Colmap, reads_the_sample_and_names_the_impossible_camera) {
  const auto folder = test::shared_data("images/real/colmap_sample");
  DENDROFIT_NEED(folder);
  const ViewSet set = read_colmap(folder, {.load_photos = false});
  EXPECT_EQ(set.views.size(), 4u);
  EXPECT_FALSE(set.metric);
  ASSERT_EQ(set.warnings.size(), 1u);
  EXPECT_THAT(set.warnings[0], HasSubstr("camera 191"));
  // Held level from side to side, though they look down by some 30 degrees.
  for (const View& view : set.views) {
    EXPECT_NEAR(view.camera.rotation(0, 2), 0, 0.02);
    EXPECT_LT(view.camera.rotation(1, 2), -0.5);
  }
  EXPECT_THAT([&] { read_colmap(folder); },
              ThrowsMessage<IoError>(AllOf(HasSubstr("Original_low-1.jpg"), HasSubstr("camera 191"))));
}

TEST(Colmap, names_line_and_cause) {
  const test::ScratchFolder folder;
  const auto cameras = [&](const std::string& text) { std::ofstream(folder / "cameras.txt") << text; };
  const auto images = [&](const std::string& text) { std::ofstream(folder / "images.txt") << text; };
  const auto expect = [&](const std::string& where, const std::string& why) {
    EXPECT_THAT([&] { read_colmap(folder.path(), {.load_photos = false}); },
                ThrowsMessage<IoError>(AllOf(HasSubstr(where), HasSubstr(why))));
  };
  expect("cameras.txt", "not there");
  images("# comment\n1 1 0 0 0 0 0 5 1 a picture.jpg\n10 20 -1\n2 1 0 0 0 0 0 5 1 b.jpg\n\n");
  cameras("# comment\n1 OPENCV 40 30 50 50 20 15 0 0 0 0\n");
  expect("cameras.txt, line 2", "OPENCV");
  cameras("1 PINHOLE 40 30 50 50 20\n");
  expect("cameras.txt, line 1", "expected 4");
  cameras("2 RADIAL 40 30 50 20 15 0.1 0.01\n");
  expect("images.txt, line 2", "camera 1 is not");
  cameras("1 RADIAL 40 30 50 20 15 0.1 0.01\n");
  const ViewSet set = read_colmap(folder.path(), {.load_photos = false});
  ASSERT_EQ(set.views.size(), 2u);
  EXPECT_EQ(set.views[0].photo.name, "a picture.jpg");
  EXPECT_DOUBLE_EQ(set.views[0].camera.k2, 0.01);
  images("1 2 0 0 0 0 0 5 1 a.jpg\n\n");
  expect("images.txt, line 1", "length 2");
}

}  // namespace
}  // namespace dendrofit
