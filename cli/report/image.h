// SPDX-License-Identifier: GPL-3.0-or-later
// A picture in memory, PNG out of it, and drawing on it: lines, boxes, text. Needs no display.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace dendrofit {

/// 8 bits a channel, sRGB.
struct Rgb {
  std::uint8_t r = 0;
  std::uint8_t g = 0;
  std::uint8_t b = 0;
  bool operator==(const Rgb&) const = default;
};

/// Rows from the top, three bytes a pixel. Drawing outside the picture is clipped.
struct Image {
  int width = 0;
  int height = 0;
  std::vector<std::uint8_t> rgb;

  Image() = default;
  /// Throws InputError unless both sides are in 1..16384.
  Image(int width_px, int height_px, Rgb fill);
  Rgb at(int x, int y) const;
  void blend(int x, int y, Rgb colour, double coverage);
  void paste(const Image& other, int x, int y);
};

/// The bytes of a PNG file; the same image gives the same bytes. Throws InputError for an empty image.
std::string encode_png(const Image& image);
/// Written whole or not at all; throws IoError when it cannot be.
void write_png(const std::filesystem::path& path, const Image& image);

/// A line with round ends, antialiased; pixels from the top left corner.
void draw_line(Image& image, double x0, double y0, double x1, double y1, double width_px, Rgb colour);
void fill_box(Image& image, int x0, int y0, int x1, int y1, Rgb colour);

enum class TextAnchor { left, middle, right };

/// UTF-8 text in a built-in stroke font, `size_px` high from baseline to capital top; (x, y) is on the
/// baseline. Letters with accents lose them, other characters without a glyph become a small box.
void draw_text(Image& image, double x, double y, std::string_view utf8, double size_px, Rgb colour,
               TextAnchor anchor = TextAnchor::left);
double text_width(std::string_view utf8, double size_px);
/// The text cut (with "..") so that it is no wider than `width_px`.
std::string fit_text(std::string_view utf8, double size_px, double width_px);

}  // namespace dendrofit
