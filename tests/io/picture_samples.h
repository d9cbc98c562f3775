// SPDX-License-Identifier: GPL-3.0-or-later
// Small pictures written by the tests themselves.
#pragma once

#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include <jpeglib.h>
#include <png.h>

namespace dendrofit::test {

using Painter = std::function<std::vector<unsigned>(int x, int y)>;  ///< channel values of a pixel

/// An RGB JPEG; `orientation` above 0 is written as EXIF (big-endian TIFF).
inline void write_jpeg(const std::filesystem::path& path, int width, int height, const Painter& paint,
                       int orientation = 0, bool progressive = false) {
  jpeg_compress_struct encoder;
  jpeg_error_mgr errors;
  encoder.err = jpeg_std_error(&errors);
  jpeg_create_compress(&encoder);
  std::FILE* file = std::fopen(path.c_str(), "wb");
  jpeg_stdio_dest(&encoder, file);
  encoder.image_width = static_cast<JDIMENSION>(width);
  encoder.image_height = static_cast<JDIMENSION>(height);
  encoder.input_components = 3;
  encoder.in_color_space = JCS_RGB;
  jpeg_set_defaults(&encoder);
  jpeg_set_quality(&encoder, 95, TRUE);
  if (progressive) jpeg_simple_progression(&encoder);
  jpeg_start_compress(&encoder, TRUE);
  if (orientation > 0) {
    const std::uint8_t exif[] = {
        'E', 'x', 'i', 'f',  0,    0, 'M', 'M', 0, 42, 0, 0, 0,
        8,   0,   1,   0x01, 0x12, 0, 3,   0,   0, 0,  1, 0, static_cast<std::uint8_t>(orientation),
        0,   0,   0,   0,    0,    0};
    jpeg_write_marker(&encoder, JPEG_APP0 + 1, exif, sizeof exif);
  }
  std::vector<JSAMPLE> row(3 * static_cast<std::size_t>(width));
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const auto pixel = paint(x, y);
      for (std::size_t c = 0; c < 3; ++c)
        row[3 * static_cast<std::size_t>(x) + c] = static_cast<JSAMPLE>(pixel[c]);
    }
    JSAMPROW rows[] = {row.data()};
    jpeg_write_scanlines(&encoder, rows, 1);
  }
  jpeg_finish_compress(&encoder);
  jpeg_destroy_compress(&encoder);
  std::fclose(file);
}

/// A PNG of 1 (grey), 3 or 4 channels with 8 or 16 bits.
inline void write_png_file(const std::filesystem::path& path, int width, int height, int channels, int bits,
                           const Painter& paint, bool interlaced = false) {
  std::FILE* file = std::fopen(path.c_str(), "wb");
  png_structp writer = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
  png_infop info = png_create_info_struct(writer);
  png_init_io(writer, file);
  const int colour = channels == 1   ? PNG_COLOR_TYPE_GRAY
                     : channels == 3 ? PNG_COLOR_TYPE_RGB
                                     : PNG_COLOR_TYPE_RGB_ALPHA;
  png_set_IHDR(writer, info, static_cast<png_uint_32>(width), static_cast<png_uint_32>(height), bits, colour,
               interlaced ? PNG_INTERLACE_ADAM7 : PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT,
               PNG_FILTER_TYPE_DEFAULT);
  png_write_info(writer, info);
  const auto per_row = static_cast<std::size_t>(width * channels * bits / 8);
  std::vector<std::vector<png_byte>> bytes(static_cast<std::size_t>(height), std::vector<png_byte>(per_row));
  std::vector<png_bytep> rows;
  for (int y = 0; y < height; ++y) {
    std::size_t at = 0;
    auto& row = bytes[static_cast<std::size_t>(y)];
    for (int x = 0; x < width; ++x) {
      const auto pixel = paint(x, y);
      for (std::size_t c = 0; c < static_cast<std::size_t>(channels); ++c) {
        if (bits == 16) row[at++] = static_cast<png_byte>(pixel[c] >> 8);
        row[at++] = static_cast<png_byte>(pixel[c] & 0xFF);
      }
    }
    rows.push_back(row.data());
  }
  png_write_image(writer, rows.data());
  png_write_end(writer, nullptr);
  png_destroy_write_struct(&writer, &info);
  std::fclose(file);
}

}  // namespace dendrofit::test
