// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/view_files.h"

#include "core/errors.h"
#include "io/read_image.h"

#include <cmath>

namespace dendrofit {
namespace {

void halve(Camera& camera, int halvings) {
  const double scale = std::ldexp(1.0, -halvings);
  camera.fx *= scale;
  camera.fy *= scale;
  camera.cx *= scale;
  camera.cy *= scale;
  camera.width = (camera.width + (1 << halvings) - 1) >> halvings;
  camera.height = (camera.height + (1 << halvings) - 1) >> halvings;
}

View load(const ViewFile& file, const ReadImageOptions& read, std::vector<std::string>& warnings) {
  const Camera& c = file.camera;
  ReadImageOptions options = read;
  options.expected_size = {c.width, c.height};
  ReadImageResult image = read_photograph(file.photo, options);
  if (image.full_width != c.width || image.full_height != c.height)
    throw InputError(file.where + ": " + file.photo.string() + " has " + std::to_string(image.full_width) +
                     " x " + std::to_string(image.full_height) + " pixels, its camera " +
                     std::to_string(c.width) + " x " + std::to_string(c.height) +
                     "; use the pictures the cameras were computed from");
  if (!file.mask.empty()) read_mask(file.mask, image);
  View view{std::move(image.photo), c};
  halve(view.camera, image.halvings);
  warnings.insert(warnings.end(), image.warnings.begin(), image.warnings.end());
  return view;
}

}  // namespace

std::vector<View> load_views(const std::vector<ViewFile>& files, const ReadCamerasOptions& options,
                             std::vector<std::string>& warnings) {
  double pixels = 0;
  for (const ViewFile& file : files)
    pixels +=
        std::min(1e6 * options.most_megapixels, static_cast<double>(file.camera.width) * file.camera.height);
  int halvings = 0;
  while (options.load_photos && std::ldexp(pixels, -2 * halvings) > 1e6 * options.most_megapixels_all)
    ++halvings;
  if (halvings > 0)
    warnings.push_back(std::to_string(files.size()) + " photographs of together " +
                       std::to_string(std::lround(1e-6 * pixels)) + " Mpx: each halved at least " +
                       std::to_string(halvings) + (halvings == 1 ? " time" : " times") + ", widths below " +
                       std::to_string(1 << halvings) + " px lost");
  std::vector<View> views;
  views.reserve(files.size());
  for (const ViewFile& file : files) {
    if (options.load_photos) {
      views.push_back(
          load(file, {.most_megapixels = options.most_megapixels, .at_least_halvings = halvings}, warnings));
    } else {
      views.push_back({{}, file.camera});
      views.back().photo.name = file.photo.filename().string();
    }
  }
  return views;
}

void settle_world(ViewSet& views, const Vec3& up) {
  const Eigen::Matrix3d turn =
      Eigen::Quaterniond::FromTwoVectors(up.normalized(), Vec3::UnitZ()).toRotationMatrix();
  const bool turned = (up.normalized() - Vec3::UnitZ()).norm() > 1e-12;
  Vec3 mean = Vec3::Zero();
  for (View& view : views.views) {
    if (turned) view.camera.rotation = view.camera.rotation * turn.transpose();
    mean += view.camera.centre() / static_cast<double>(views.views.size());
  }
  Vec3 move = Vec3::Zero();
  if (mean.norm() > 100)
    for (int k = 0; k < 3; ++k) move[k] = std::round(mean[k]);
  for (View& view : views.views) view.camera.translation += view.camera.rotation * move;
  views.origin_shift = (turned ? Vec3(turn * views.origin_shift) : views.origin_shift) + move;
  views.up = Vec3::UnitZ();
}

}  // namespace dendrofit
