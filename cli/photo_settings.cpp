// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/photo_settings.h"

#include "cli/parse.h"
#include "core/errors.h"
#include "io/read_image.h"
#include "io/text_numbers.h"
#include "recon/image/scale.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <string_view>

#include <fmt/format.h>

namespace dendrofit::cli {
namespace {

/// Comma-separated numbers; the last may carry a unit of length.
std::vector<double> numbers(const std::string& option, const std::string& text, std::size_t count,
                            bool length) {
  std::vector<double> values;
  std::size_t from = 0;
  while (from <= text.size()) {
    const std::size_t comma = std::min(text.find(',', from), text.size());
    const bool last = values.size() + 1 == count;
    try {
      values.push_back(parse_quantity(text.substr(from, comma - from),
                                      last && length ? Quantity::length : Quantity::pure));
    } catch (const std::invalid_argument& error) {
      throw UsageError(fmt::format("{} {}: {}", option, text, error.what()));
    }
    from = comma + 1;
  }
  if (values.size() != count)
    throw UsageError(fmt::format("{} {}: expected {} numbers with commas between them", option, text, count));
  return values;
}

/// A pixel of the picture as stored, in the picture as read.
Eigen::Vector2d pixel_of(const std::string& option, double u, double v, const Photograph& photo) {
  const Eigen::Vector2d pixel = std::ldexp(1.0, -photo.halvings) * Eigen::Vector2d(u, v);
  if (u < 0 || v < 0 || pixel.x() > photo.width || pixel.y() > photo.height)
    throw InputError(fmt::format("{} {},{}: outside {} of {} x {} pixels", option, u, v, photo.name,
                                 photo.width << photo.halvings, photo.height << photo.halvings));
  return pixel;
}

/// None where it was not given.
std::optional<ScaleBar> scale_bar_of(const std::string& text, const Photograph& photo) {
  if (text.empty()) return std::nullopt;
  const auto v = numbers("--scale-bar", text, 5, true);
  return ScaleBar{pixel_of("--scale-bar", v[0], v[1], photo), pixel_of("--scale-bar", v[2], v[3], photo),
                  v[4]};
}

}  // namespace

void PhotoSettings::declare(OptionTable& table) {
  table.number("--height", height_m, Quantity::length,
               "From photographs: the tree's height, which gives the scale");
  table.text("--scale-bar", scale_bar, "U1,V1,U2,V2,LENGTH",
             "From photographs: two pixels (of the first) a known length apart, at the stem");
  table.path("--mask", mask, "From a photograph: picture of its size, the tree white on black");
  table.text("--root", root, "U,V", "From a photograph: a pixel at the stem's foot");
  table.path("--cameras", cameras, "Photographs with cameras: cameras.json");
  table.path("--colmap", colmap, "Photographs with cameras: folder of a COLMAP text model");
  table.number("--eye-height", eye_height_m, Quantity::length,
               "Of the camera over the foot: the scale where one view with a camera has no other, a hint "
               "beside --height");
}

bool PhotoSettings::asked_for(const std::filesystem::path& input) const {
  if (has_cameras()) return true;
  if (input.empty()) return false;
  // By name as well, so that a broken photograph or one of another format is told as such.
  constexpr std::array<std::string_view, 9> names = {".jpg", ".jpeg", ".png",  ".heic", ".webp",
                                                     ".tif", ".tiff", ".avif", ".bmp"};
  const std::string name = lower(input.extension().string());
  return std::find(names.begin(), names.end(), name) != names.end() || is_image(input);
}

std::vector<std::filesystem::path> PhotoSettings::inputs(const std::filesystem::path& input) const {
  std::vector<std::filesystem::path> files;
  if (!input.empty()) files.push_back(input);
  if (!mask.empty()) files.push_back(mask);
  if (!cameras.empty()) files.push_back(cameras);
  if (!colmap.empty()) files.insert(files.end(), {colmap / "cameras.txt", colmap / "images.txt"});
  return files;
}

void PhotoSettings::check(const std::filesystem::path& input) const {
  const bool photo_option = height_m || !scale_bar.empty() || !mask.empty() || !root.empty() || has_cameras();
  if (!asked_for(input)) {
    if (input.empty())
      throw UsageError("no input: name a scan or a photograph, or give --cameras or --colmap");
    if (photo_option && std::filesystem::exists(input))
      throw UsageError(
          input.string() +
          ": not a JPEG or PNG photograph, which --height, --scale-bar, --mask, --root, --cameras and "
          "--colmap are for");
    return;
  }
  if (has_cameras() && !input.empty())
    throw UsageError("--cameras and --colmap name their photographs themselves: leave out " + input.string());
  if (!cameras.empty() && !colmap.empty()) throw UsageError("--cameras and --colmap: give one of them");
  if (height_m && !scale_bar.empty()) throw UsageError("--height and --scale-bar: give one of them");
  if (has_cameras() && !mask.empty())
    throw UsageError("--mask is for one photograph; a cameras file names its masks itself");
}

ReconstructPhotoOptions PhotoSettings::resolve(const CommonOptions& common, double dbh_height_m,
                                               const Photograph& photo) const {
  ReconstructPhotoOptions options;
  options.height_m = height_m;
  options.eye_height_m = eye_height_m;
  options.dbh_height_m = dbh_height_m;
  options.seed = common.seed;
  options.scale_bar = scale_bar_of(scale_bar, photo);
  if (!root.empty()) {
    const auto v = numbers("--root", root, 2, false);
    options.root_px = pixel_of("--root", v[0], v[1], photo);
  }
  options.validate();
  return options;
}

ViewSet PhotoSettings::read_views() const {
  return cameras.empty() ? read_colmap(colmap) : read_cameras_json(cameras);
}

ViewSet PhotoSettings::scaled(ViewSet set, Progress& progress) const {
  if (!root.empty())
    throw UsageError(
        "--root is for one photograph: of several trees in several views, name one by masks (\"mask\" in the "
        "cameras file)");
  if (set.metric && (height_m || !scale_bar.empty()))
    throw UsageError(std::string(height_m ? "--height" : "--scale-bar") +
                     ": these cameras have their own unit of length (metres); leave it out");
  if (set.metric) return set;
  if (height_m) scale_to_height(set, *height_m, progress);
  if (const auto bar = scale_bar_of(scale_bar, set.views.front().photo)) scale_to_bar(set, *bar);
  return set;
}

PhotoInput PhotoSettings::read_photo(const std::filesystem::path& input, const CommonOptions& common,
                                     double dbh_height_m) const {
  ReadImageResult image = read_photograph(input);
  if (!mask.empty()) read_mask(mask, image);
  PhotoInput result;
  result.options = resolve(common, dbh_height_m, image.photo);
  result.warnings = image.warnings;
  result.photo = std::move(image.photo);
  return result;
}

PhotoInput PhotoSettings::from_view(ViewSet set, const CommonOptions& common, double dbh_height_m) const {
  PhotoInput result;
  View& view = set.views.front();
  result.options = resolve(common, dbh_height_m, view.photo);
  result.options.camera = view.camera;
  result.options.metric_camera = set.metric;
  result.origin_shift = set.origin_shift;
  result.warnings = set.warnings;
  result.photo = std::move(view.photo);
  return result;
}

PhotoReconstruction reconstruct_from(const PhotoInput& input, Progress& progress) {
  PhotoReconstruction result = reconstruct_photo(input.photo, input.options, progress);
  result.tree.origin_shift += input.origin_shift;
  result.warnings.insert(result.warnings.begin(), input.warnings.begin(), input.warnings.end());
  return result;
}

}  // namespace dendrofit::cli
