// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/report/image.h"

#include "core/errors.h"

#include <cstring>
#include <filesystem>

#include <gtest/gtest.h>
#include <png.h>

namespace dendrofit {
namespace {

Image decode(const std::string& bytes) {
  png_image header;
  std::memset(&header, 0, sizeof header);
  header.version = PNG_IMAGE_VERSION;
  EXPECT_TRUE(png_image_begin_read_from_memory(&header, bytes.data(), bytes.size())) << header.message;
  header.format = PNG_FORMAT_RGB;
  Image image(static_cast<int>(header.width), static_cast<int>(header.height), {});
  EXPECT_TRUE(png_image_finish_read(&header, nullptr, image.rgb.data(), 0, nullptr)) << header.message;
  return image;
}

std::size_t inked(const Image& image) {
  std::size_t count = 0;
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) count += !(image.at(x, y) == Rgb{255, 255, 255});
  return count;
}

TEST(Image, PngGivesBackEveryPixel) {
  Image image(7, 5, {10, 20, 30});
  image.blend(6, 4, {200, 100, 50}, 1);
  const Image back = decode(encode_png(image));
  EXPECT_EQ(back.width, 7);
  EXPECT_EQ(back.rgb, image.rgb);
  EXPECT_EQ(encode_png(image), encode_png(image));
}

TEST(Image, RefusesImpossibleSizesAndFolders) {
  EXPECT_THROW(Image(0, 5, {}), InputError);
  EXPECT_THROW(Image(5, 20000, {}), InputError);
  EXPECT_THROW(encode_png(Image{}), InputError);
  EXPECT_THROW(write_png("no/such/folder/a.png", Image(2, 2, {})), IoError);
}

TEST(Image, DrawingOutsideIsClipped) {
  Image image(20, 20, {255, 255, 255});
  draw_line(image, -1e9, 5, 1e9, 5, 1, {0, 0, 0});
  EXPECT_EQ(image.at(0, 4), image.at(19, 4));
  EXPECT_LT(image.at(10, 4).r, 255);
  image.blend(-1, 3, {0, 0, 0}, 1);
  image.blend(3, 20, {0, 0, 0}, 1);
  fill_box(image, -5, 15, 50, 18, {1, 2, 3});
  EXPECT_EQ(image.at(19, 17), (Rgb{1, 2, 3}));
  EXPECT_EQ(image.at(19, 18), (Rgb{255, 255, 255}));
  Image small(3, 3, {9, 9, 9});
  image.paste(small, 18, -1);
  EXPECT_EQ(image.at(19, 1), (Rgb{9, 9, 9}));
  EXPECT_EQ(image.at(19, 2), (Rgb{255, 255, 255}));
  image.paste(small, 40, 40);
}

TEST(Text, EveryPrintableCharacterLeavesAMarkOfItsOwn) {
  std::vector<std::vector<std::uint8_t>> seen;
  for (char c = '!'; c <= '~'; ++c) {
    Image image(40, 40, {255, 255, 255});
    draw_text(image, 8, 28, std::string(1, c), 20, {0, 0, 0});
    EXPECT_GT(inked(image), 3u) << c;
    for (const auto& other : seen) EXPECT_NE(other, image.rgb) << c;
    seen.push_back(image.rgb);
  }
}

TEST(Text, AccentsFallBackToTheirLetterAndTheRestToABox) {
  const auto picture = [](std::string_view text) {
    Image image(60, 40, {255, 255, 255});
    draw_text(image, 8, 28, text, 16, {0, 0, 0});
    return image.rgb;
  };
  EXPECT_EQ(picture("B\xc3\xa4ume"), picture("Baume"));
  EXPECT_EQ(picture("\xc5\x81"), picture("L"));
  EXPECT_EQ(picture("\xe6\x9c\xa8"), picture("\xff"));  // a character without a glyph, a byte that is none
  EXPECT_NE(picture("\xff"), picture(" "));
}

TEST(Text, IsCutToTheRoomThereIs) {
  const std::string name = "a very long name of a tree B\xc3\xa4ume";
  EXPECT_EQ(fit_text(name, 10, 1e6), name);
  for (double room = 0; room < 300; room += 7) {
    const std::string cut = fit_text(name, 10, room);
    EXPECT_LE(text_width(cut, 10), room);
    EXPECT_TRUE(cut.empty() || cut == name || cut.ends_with("..")) << cut;
  }
  EXPECT_EQ(text_width("", 10), 0);
}

}  // namespace
}  // namespace dendrofit
