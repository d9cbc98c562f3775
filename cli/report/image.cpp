// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/report/image.h"

#include "core/atomic_file.h"
#include "core/errors.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include <png.h>

namespace dendrofit {

Image::Image(int width_px, int height_px, Rgb fill) : width(width_px), height(height_px) {
  require(width_px >= 1 && width_px <= 16384, "image width (pixels)", width_px, "must be 1 to 16384");
  require(height_px >= 1 && height_px <= 16384, "image height (pixels)", height_px, "must be 1 to 16384");
  rgb.resize(3 * static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  for (std::size_t i = 0; i < rgb.size(); i += 3) {
    rgb[i] = fill.r;
    rgb[i + 1] = fill.g;
    rgb[i + 2] = fill.b;
  }
}

Rgb Image::at(int x, int y) const {
  const std::size_t i =
      3 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x));
  return {rgb[i], rgb[i + 1], rgb[i + 2]};
}

void Image::blend(int x, int y, Rgb colour, double coverage) {
  if (x < 0 || y < 0 || x >= width || y >= height || !(coverage > 0)) return;
  coverage = std::min(coverage, 1.0);
  const std::size_t i =
      3 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x));
  const std::array<std::uint8_t, 3> top = {colour.r, colour.g, colour.b};
  for (std::size_t c = 0; c < 3; ++c)
    rgb[i + c] = static_cast<std::uint8_t>(std::lround(rgb[i + c] + (top[c] - rgb[i + c]) * coverage));
}

void Image::paste(const Image& other, int x, int y) {
  for (int row = std::max(0, -y); row < other.height && row + y < height; ++row) {
    const int first = std::max(0, -x);
    const int last = std::min(other.width, width - x);
    if (last <= first) return;
    const auto offset = [](const Image& image, int column, int line) {
      return 3 * (static_cast<std::ptrdiff_t>(line) * image.width + column);
    };
    std::copy_n(other.rgb.begin() + offset(other, first, row), 3 * (last - first),
                rgb.begin() + offset(*this, x + first, y + row));
  }
}

std::string encode_png(const Image& image) {
  if (image.width < 1 || image.height < 1) throw InputError("image: empty; a PNG needs at least one pixel");
  png_image header;
  std::memset(&header, 0, sizeof header);
  header.version = PNG_IMAGE_VERSION;
  header.width = static_cast<png_uint_32>(image.width);
  header.height = static_cast<png_uint_32>(image.height);
  header.format = PNG_FORMAT_RGB;
  std::string bytes(PNG_IMAGE_PNG_SIZE_MAX(header), '\0');
  png_alloc_size_t size = bytes.size();
  if (!png_image_write_to_memory(&header, bytes.data(), &size, 0, image.rgb.data(), 0, nullptr))
    throw IoError(std::string("PNG: ") + header.message);
  bytes.resize(size);
  return bytes;
}

void write_png(const std::filesystem::path& path, const Image& image) {
  write_file(path, encode_png(image));
}

void draw_line(Image& image, double x0, double y0, double x1, double y1, double width_px, Rgb colour) {
  const double half = 0.5 * width_px;
  const double dx = x1 - x0;
  const double dy = y1 - y0;
  const double length2 = dx * dx + dy * dy;
  const auto clipped = [](double v, int limit) { return static_cast<int>(std::clamp(v, -1.0, limit + 1.0)); };
  const int left = clipped(std::floor(std::min(x0, x1) - half - 1), image.width);
  const int right = clipped(std::ceil(std::max(x0, x1) + half + 1), image.width);
  const int top = clipped(std::floor(std::min(y0, y1) - half - 1), image.height);
  const int bottom = clipped(std::ceil(std::max(y0, y1) + half + 1), image.height);
  for (int y = top; y <= bottom; ++y)
    for (int x = left; x <= right; ++x) {
      const double px = x + 0.5 - x0;
      const double py = y + 0.5 - y0;
      const double t = length2 > 0 ? std::clamp((px * dx + py * dy) / length2, 0.0, 1.0) : 0.0;
      const double distance = std::hypot(px - t * dx, py - t * dy);
      image.blend(x, y, colour, half + 0.5 - distance);
    }
}

void fill_box(Image& image, int x0, int y0, int x1, int y1, Rgb colour) {
  for (int y = std::max(0, y0); y < std::min(y1, image.height); ++y)
    for (int x = std::max(0, x0); x < std::min(x1, image.width); ++x) image.blend(x, y, colour, 1);
}

}  // namespace dendrofit
