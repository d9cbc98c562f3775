// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/read_image.h"

#include "core/errors.h"
#include "io/image_rows.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <numeric>
#include <string_view>

namespace dendrofit {
namespace {

constexpr std::string_view kJpeg = "\xff\xd8\xff";
constexpr std::string_view kPng = "\x89PNG\r\n\x1a\n";

bool starts_with(std::string_view bytes, std::string_view magic, std::size_t at = 0) {
  return bytes.size() >= at + magic.size() && bytes.substr(at, magic.size()) == magic;
}

StoredImage decode(const std::filesystem::path& path, const HalvingRule& rule) {
  const FileBytes file(path);
  const std::string_view bytes = file.view();
  if (starts_with(bytes, kJpeg)) return decode_jpeg(file, rule);
  if (starts_with(bytes, kPng)) return decode_png(file, rule);
  const char* format = starts_with(bytes, "RIFF") && starts_with(bytes, "WEBP", 8) ? "WebP"
                       : starts_with(bytes, "II*") || starts_with(bytes, "MM")     ? "TIFF or raw"
                       : starts_with(bytes, "ftyp", 4)                             ? "HEIC, AVIF or video"
                       : starts_with(bytes, "BM")                                  ? "BMP"
                       : starts_with(bytes, "GIF8")                                ? "GIF"
                                                                                   : "unknown";
  fail_in_file(path, std::string("picture format ") + format +
                         "; expected JPEG or PNG: save or export the photograph as one of them");
}

bool swaps_sides(int orientation) {
  return orientation >= 5;
}

/// Stored pixel (column, row) that shows at (x, y) of the upright picture (EXIF 2.32, tag Orientation).
std::size_t stored_pixel(const StoredImage& s, int orientation, int x, int y) {
  const int w = s.width - 1, h = s.height - 1;
  int column = x, row = y;
  switch (orientation) {
    case 2:
      column = w - x;
      break;
    case 3:
      column = w - x, row = h - y;
      break;
    case 4:
      row = h - y;
      break;
    case 5:
      column = y, row = x;
      break;
    case 6:
      column = y, row = h - x;
      break;
    case 7:
      column = w - y, row = h - x;
      break;
    case 8:
      column = w - y, row = x;
      break;
    default:
      break;
  }
  return static_cast<std::size_t>(row) * static_cast<std::size_t>(s.width) + static_cast<std::size_t>(column);
}

/// The value that becomes white: the 99.9th percentile of a deep picture's colour values.
double white_of(const StoredImage& s) {
  if (!s.deep) return 255;
  std::vector<std::size_t> histogram(65536, 0);
  const auto channels = static_cast<std::size_t>(s.channels);
  std::size_t total = 0;
  for (std::size_t i = 0; i < s.values.size(); ++i) {
    if (channels == 4 && i % 4 == 3) continue;
    ++histogram[s.values[i]];
    ++total;
  }
  std::size_t below = 0, value = 0;
  for (; value < histogram.size(); ++value) {
    below += histogram[value];
    if (static_cast<double>(below) >= 0.999 * static_cast<double>(total)) break;
  }
  return std::max<double>(1, static_cast<double>(value));
}

/// Upright bytes of one stored channel.
template <class Put>
void for_upright(const StoredImage& s, int orientation, int width, int height, Put put) {
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      put(static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x),
          s.values.data() + static_cast<std::size_t>(s.channels) * stored_pixel(s, orientation, x, y));
}

std::string sizes(int width, int height) {
  return std::to_string(width) + " x " + std::to_string(height);
}

}  // namespace

void ReadImageOptions::validate() const {
  require(std::isfinite(most_megapixels) && most_megapixels > 0, "most_megapixels", most_megapixels,
          "must be positive");
  require(at_least_halvings >= 0 && at_least_halvings <= 8, "at_least_halvings", at_least_halvings,
          "must be 0 to 8");
}

bool is_image(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  char head[8] = {};
  in.read(head, sizeof head);
  const std::string_view bytes(head, static_cast<std::size_t>(std::max<std::streamsize>(0, in.gcount())));
  return starts_with(bytes, kJpeg) || starts_with(bytes, kPng);
}

ReadImageResult read_photograph(const std::filesystem::path& file, const ReadImageOptions& options) {
  options.validate();
  const StoredImage stored =
      decode(file, {.most_pixels = 1e6 * options.most_megapixels, .at_least = options.at_least_halvings});
  int orientation = stored.orientation;
  const auto fits = [&](bool swapped) {
    const auto& e = *options.expected_size;
    return (swapped ? stored.stored_height : stored.stored_width) == e[0] &&
           (swapped ? stored.stored_width : stored.stored_height) == e[1];
  };
  if (options.expected_size && !fits(swaps_sides(orientation)) && fits(false)) orientation = 1;

  ReadImageResult result;
  result.halvings = result.photo.halvings = stored.halvings;
  result.full_width = swaps_sides(orientation) ? stored.stored_height : stored.stored_width;
  result.full_height = swaps_sides(orientation) ? stored.stored_width : stored.stored_height;
  Photograph& photo = result.photo;
  photo.name = file.filename().string();
  photo.width = swaps_sides(orientation) ? stored.height : stored.width;
  photo.height = swaps_sides(orientation) ? stored.width : stored.height;
  const std::size_t pixels = static_cast<std::size_t>(photo.width) * static_cast<std::size_t>(photo.height);
  photo.rgb.resize(3 * pixels);
  const double white = white_of(stored);
  const auto to_byte = [&](std::uint16_t value) {
    return static_cast<std::uint8_t>(std::lround(std::min(255.0, 255.0 * value / white)));
  };
  const std::size_t colours = stored.channels >= 3 ? 1 : 0;
  for_upright(stored, orientation, photo.width, photo.height, [&](std::size_t to, const std::uint16_t* from) {
    for (std::size_t c = 0; c < 3; ++c) photo.rgb[3 * to + c] = to_byte(from[c * colours]);
  });
  if (stored.channels == 4) {
    const std::uint16_t half = stored.deep ? 32768 : 128;
    std::vector<std::uint8_t> opaque(pixels);
    for_upright(stored, orientation, photo.width, photo.height,
                [&](std::size_t to, const std::uint16_t* from) { opaque[to] = from[3] >= half ? 1 : 0; });
    const bool see_through = std::find(opaque.begin(), opaque.end(), 0) != opaque.end();
    if (see_through && std::find(opaque.begin(), opaque.end(), 1) == opaque.end())
      throw InputError(file.string() + ": every pixel is transparent; save the photograph without alpha");
    if (see_through) {
      photo.mask = std::move(opaque);
      result.warnings.push_back(photo.name +
                                ": transparent pixels are taken for background, the others for the tree");
    }
  }
  if (result.halvings > options.at_least_halvings) {
    char text[120];
    std::snprintf(text, sizeof text, "%.0f Mpx: halved %s, widths below %d px lost",
                  1e-6 * stored.stored_width * stored.stored_height,
                  result.halvings == 1   ? "once"
                  : result.halvings == 2 ? "twice"
                                         : (std::to_string(result.halvings) + " times").c_str(),
                  1 << result.halvings);
    result.warnings.push_back(photo.name + ": " + text);
  }
  return result;
}

void read_mask(const std::filesystem::path& file, ReadImageResult& image) {
  ReadImageOptions options;
  options.at_least_halvings = image.halvings;
  options.most_megapixels = 1e9;
  options.expected_size = {image.full_width, image.full_height};
  ReadImageResult read = read_photograph(file, options);
  Photograph& mask = read.photo;
  if (read.full_width != image.full_width || read.full_height != image.full_height)
    throw InputError(file.string() + ": mask of " + sizes(read.full_width, read.full_height) +
                     " pixels, photograph " + image.photo.name + " of " +
                     sizes(image.full_width, image.full_height) + "; a mask has its photograph's size");
  if (mask.mask.empty()) {
    mask.mask.resize(mask.rgb.size() / 3);
    const int brightest = *std::max_element(mask.rgb.begin(), mask.rgb.end());
    for (std::size_t i = 0; i < mask.mask.size(); ++i)
      mask.mask[i] =
          2 * std::max({mask.rgb[3 * i], mask.rgb[3 * i + 1], mask.rgb[3 * i + 2]}) > brightest ? 1 : 0;
  }
  const auto marked = static_cast<std::size_t>(std::accumulate(mask.mask.begin(), mask.mask.end(), 0L));
  if (marked == 0)
    throw InputError(file.string() + ": the mask marks no pixel; paint the tree white on black");
  if (marked == mask.mask.size())
    throw InputError(file.string() + ": the mask marks every pixel; paint the background black");
  image.photo.mask = std::move(mask.mask);
}

}  // namespace dendrofit
