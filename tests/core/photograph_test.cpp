// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/photograph.h"

#include "core/errors.h"

#include <gtest/gtest.h>

namespace dendrofit {
namespace {

Camera sample() {
  Camera camera{
      .width = 1500, .height = 2250, .fx = 1625, .fy = 1625, .cx = 750, .cy = 1125, .k1 = -0.05, .k2 = 0.01};
  // Looks along world +y, up is +z, from 10 m in front of the origin.
  camera.rotation << 1, 0, 0, 0, 0, -1, 0, 1, 0;
  camera.translation = Vec3(0, 0, 10);
  return camera;
}

TEST(Camera, ProjectsTheAxisOntoThePrincipalPoint) {
  const Camera camera = sample();
  EXPECT_TRUE(camera.centre().isApprox(Vec3(0, -10, 0)));
  const auto pixel = camera.project(Vec3::Zero());
  ASSERT_TRUE(pixel);
  EXPECT_TRUE(pixel->isApprox(Eigen::Vector2d(750, 1125)));
  // Without distortion a metre at 10 m is 162.5 pixels; higher is a smaller row.
  Camera plain = camera;
  plain.k1 = plain.k2 = 0;
  EXPECT_TRUE(plain.project(Vec3(1, 0, 2))->isApprox(Eigen::Vector2d(912.5, 800)));
}

TEST(Camera, RayAndProjectionAreInverse) {
  const Camera camera = sample();
  for (const Eigen::Vector2d& pixel :
       {Eigen::Vector2d(0.5, 0.5), {1499.5, 2249.5}, {750, 1125}, {100, 1800}}) {
    const Vec3 point = camera.centre() + 7.3 * camera.ray(pixel);
    const auto back = camera.project(point);
    ASSERT_TRUE(back);
    EXPECT_LT((*back - pixel).norm(), 1e-7);
  }
}

TEST(Camera, SeesNothingBehindItself) {
  EXPECT_FALSE(sample().project(Vec3(0, -11, 0)));
  EXPECT_FALSE(sample().project(Vec3(0, -10, 0)));
}

TEST(Camera, RefusesAMirroredPoseAndAFocalLengthOfZero) {
  Camera mirrored = sample();
  mirrored.rotation.row(0) *= -1;
  EXPECT_THROW(mirrored.validate(), InputError);
  Camera blind = sample();
  blind.fx = 0;
  EXPECT_THROW(blind.validate(), InputError);
  EXPECT_NO_THROW(sample().validate());
}

TEST(Photograph, CountsItsBytes) {
  Photograph photo{.name = "x", .width = 2, .height = 3, .rgb = std::vector<std::uint8_t>(18), .mask = {}};
  EXPECT_NO_THROW(photo.validate());
  photo.mask.resize(5);
  EXPECT_THROW(photo.validate(), InputError);
  EXPECT_EQ(photo.pixel(1, 2), 5u);
}

}  // namespace
}  // namespace dendrofit
