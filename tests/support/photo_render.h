// SPDX-License-Identifier: GPL-3.0-or-later
// Photographs of trees that exist as cylinders, with their exact masks: truth for the reconstruction from
// views.
#pragma once

#include "core/photograph.h"
#include "core/tree.h"

#include <cstdint>

namespace dendrofit::test {

struct RenderOptions {
  int samples = 3;         ///< a side of each pixel
  bool photograph = true;  ///< false: the mask alone, the picture stays white
  double noise_sigma = 2;  ///< grey levels, each channel
  double blur_sigma_px = 0.6;
  std::uint64_t seed = 1;
  int threads = 0;
};

/// Sky, a distant treeline, grass and the tree, their light mixed where they share a pixel; mask: pixels
/// covered by half or more.
View render_view(const Tree& tree, const Camera& camera, const RenderOptions& options = {});

struct RingOptions {
  int views = 12;
  int width = 1500;
  int height = 2250;
  double focal_px = 1625;
  double k1 = 0;
  double eye_height_m = 1.6;  ///< above the foot
  double fill = 0.72;         ///< share of the picture's height (or width) the tree takes
  double wobble = 0.15;       ///< spread of distance, bearing and aim, as of someone walking about the tree
  double turn_error_deg = 0;  ///< of the poses told (not of those the pictures are taken from)
  double shift_error_m = 0;
  RenderOptions render;
};

/// `views` photographs from a ring about the tree. The same options give the same pictures.
ViewSet photograph_ring(const Tree& tree, const RingOptions& options = {});

/// A camera at `eye` that looks at `target`, upright.
Camera camera_at(const Vec3& eye, const Vec3& target, int width, int height, double focal_px, double k1 = 0);

}  // namespace dendrofit::test
