// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/errors.h"
#include "io/read_image.h"
#include "tests/io/picture_samples.h"
#include "tests/support/scratch_folder.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace dendrofit {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

/// Left half red, right half green, a blue block in the upper left corner: every turn shows.
std::vector<unsigned> flag(int x, int y) {
  if (x < 16 && y < 16) return {20, 20, 220};
  return x < 40 ? std::vector<unsigned>{220, 20, 20} : std::vector<unsigned>{20, 220, 20};
}

char colour_at(const Photograph& photo, int x, int y) {
  const std::uint8_t* p = photo.rgb.data() + 3 * photo.pixel(x, y);
  return p[0] > 150 ? 'r' : p[1] > 150 ? 'g' : p[2] > 150 ? 'b' : '?';
}

TEST(ReadImage, turns_a_photograph_as_its_exif_says) {
  const test::ScratchFolder folder;
  for (int orientation = 1; orientation <= 8; ++orientation) {
    const auto file = folder / ("turned" + std::to_string(orientation) + ".jpg");
    test::write_jpeg(file, 64, 48, flag, orientation);
    const Photograph photo = read_photograph(file).photo;
    const bool swapped = orientation >= 5;
    ASSERT_EQ(photo.width, swapped ? 48 : 64) << orientation;
    ASSERT_EQ(photo.height, swapped ? 64 : 48) << orientation;
    const int right = photo.width - 5, bottom = photo.height - 5;
    std::string corners;
    for (const auto& [x, y] :
         {std::pair{4, 4}, std::pair{right, 4}, std::pair{4, bottom}, std::pair{right, bottom}})
      corners += colour_at(photo, x, y);
    // Upper left, upper right, lower left, lower right, by EXIF orientation 1 to 8.
    const std::vector<std::string> expected = {"bgrg", "gbgr", "grgb", "rgbg",
                                               "brgg", "rbgg", "ggrb", "ggbr"};
    EXPECT_EQ(corners, expected[static_cast<std::size_t>(orientation - 1)]) << orientation;
  }
}

TEST(ReadImage, keeps_the_stored_orientation_where_only_that_fits_the_cameras) {
  const test::ScratchFolder folder;
  test::write_jpeg(folder / "turned.jpg", 64, 48, flag, 6);
  EXPECT_EQ(read_photograph(folder / "turned.jpg", {.expected_size = {{64, 48}}}).photo.width, 64);
  EXPECT_EQ(read_photograph(folder / "turned.jpg", {.expected_size = {{48, 64}}}).photo.width, 48);
}

TEST(ReadImage, names_the_row_after_which_a_file_is_corrupt) {
  const test::ScratchFolder folder;
  const auto noise = [](int x, int y) {
    const unsigned v = static_cast<unsigned>(x * 7919 + y * 104729) % 251;
    return std::vector<unsigned>{v, 255 - v, v / 2};
  };
  test::write_jpeg(folder / "whole.jpg", 128, 160, noise);
  test::write_jpeg(folder / "progressive.jpg", 128, 160, noise, 0, true);
  test::write_png_file(folder / "whole.png", 128, 160, 3, 8, noise);
  for (const std::string name : {"whole.jpg", "whole.png", "progressive.jpg"}) {
    const std::string bytes = test::content_of(folder / name);
    EXPECT_NO_THROW(read_photograph(folder / name)) << name;
    std::ofstream(folder / "cut", std::ios::binary) << bytes.substr(0, bytes.size() / 2);
    const std::string said =
        name == "progressive.jpg" ? "every row is affected" : "file is corrupt after row ";
    EXPECT_THAT([&] { read_photograph(folder / "cut"); }, ThrowsMessage<IoError>(HasSubstr(said))) << name;
    std::ofstream(folder / "head", std::ios::binary) << bytes.substr(0, 20);
    EXPECT_THROW(read_photograph(folder / "head"), IoError) << name;
  }
}

TEST(ReadImage, halves_what_is_too_large_and_says_so) {
  const test::ScratchFolder folder;
  test::write_png_file(folder / "large.png", 101, 60, 3, 8, [](int x, int) {
    const unsigned v = x < 50 ? 200 : 100;
    return std::vector<unsigned>{v, v, v};
  });
  const ReadImageResult read = read_photograph(folder / "large.png", {.most_megapixels = 500e-6});
  EXPECT_EQ(read.halvings, 2);
  EXPECT_EQ(read.photo.width, 26);
  EXPECT_EQ(read.photo.height, 15);
  EXPECT_EQ(read.full_width, 101);
  ASSERT_EQ(read.warnings.size(), 1u);
  EXPECT_THAT(read.warnings[0], HasSubstr("halved twice, widths below 4 px lost"));
  EXPECT_EQ(read.photo.rgb[3 * read.photo.pixel(5, 3)], 200);
  EXPECT_EQ(read.photo.rgb[3 * read.photo.pixel(12, 3)], 150);  // columns 48 to 51
  EXPECT_EQ(read.photo.rgb[3 * read.photo.pixel(25, 3)], 100);  // a block one column wide
}

TEST(ReadImage, scales_sixteen_bits_by_the_brightest_values) {
  const test::ScratchFolder folder;
  const auto ramp = [](int x, int) { return std::vector<unsigned>{static_cast<unsigned>(40 * x)}; };
  test::write_png_file(folder / "deep.png", 100, 20, 1, 16, ramp);
  test::write_png_file(folder / "deep_interlaced.png", 100, 20, 1, 16, ramp, true);
  const Photograph photo = read_photograph(folder / "deep.png").photo;
  EXPECT_EQ(photo.rgb[3 * photo.pixel(99, 5)], 255);
  EXPECT_NEAR(photo.rgb[3 * photo.pixel(50, 5) + 1], 255 * 50 / 99.0, 1);
  EXPECT_EQ(read_photograph(folder / "deep_interlaced.png").photo.rgb, photo.rgb);
}

TEST(ReadImage, takes_transparency_for_background) {
  const test::ScratchFolder folder;
  test::write_png_file(folder / "cut_out.png", 30, 20, 4, 8, [](int x, int) {
    return std::vector<unsigned>{90, 80, 70, x < 10 ? 255u : x < 20 ? 127u : 0u};
  });
  const ReadImageResult read = read_photograph(folder / "cut_out.png");
  ASSERT_FALSE(read.photo.mask.empty());
  EXPECT_EQ(read.photo.mask[read.photo.pixel(9, 4)], 1);
  EXPECT_EQ(read.photo.mask[read.photo.pixel(10, 4)], 0);
  EXPECT_EQ(read.warnings.size(), 1u);
  test::write_png_file(folder / "opaque.png", 30, 20, 4, 8, [](int, int) {
    return std::vector<unsigned>{90, 80, 70, 255};
  });
  EXPECT_TRUE(read_photograph(folder / "opaque.png").photo.mask.empty());
}

TEST(ReadImage, reads_masks_and_refuses_those_that_mask_nothing) {
  const test::ScratchFolder folder;
  const auto grey = [](unsigned v) { return [v](int, int) { return std::vector<unsigned>{v, v, v}; }; };
  test::write_png_file(folder / "photo.png", 40, 30, 3, 8, grey(180));
  test::write_png_file(folder / "mask.png", 40, 30, 1, 8,
                       [](int x, int) { return std::vector<unsigned>{x == 7 ? 1u : 0u}; });
  ReadImageResult image = read_photograph(folder / "photo.png");
  read_mask(folder / "mask.png", image);
  EXPECT_EQ(image.photo.mask[image.photo.pixel(7, 9)], 1);
  EXPECT_EQ(std::count(image.photo.mask.begin(), image.photo.mask.end(), 1), 30);
  test::write_png_file(folder / "small.png", 39, 30, 1, 8, grey(255));
  test::write_png_file(folder / "black.png", 40, 30, 1, 8, grey(0));
  test::write_png_file(folder / "white.png", 40, 30, 1, 8, grey(255));
  EXPECT_THAT([&] { read_mask(folder / "small.png", image); },
              ThrowsMessage<InputError>(AllOf(HasSubstr("39 x 30"), HasSubstr("40 x 30"))));
  EXPECT_THAT([&] { read_mask(folder / "black.png", image); },
              ThrowsMessage<InputError>(HasSubstr("no pixel")));
  EXPECT_THAT([&] { read_mask(folder / "white.png", image); },
              ThrowsMessage<InputError>(HasSubstr("every pixel")));
}

TEST(ReadImage, names_formats_it_does_not_read) {
  const test::ScratchFolder folder;
  std::ofstream(folder / "photo.heic", std::ios::binary) << std::string(
      "\0\0\0\x18"
      "ftypheic0000",
      16);
  std::ofstream(folder / "text.jpg") << "no picture at all";
  EXPECT_THAT([&] { read_photograph(folder / "photo.heic"); },
              ThrowsMessage<IoError>(AllOf(HasSubstr("HEIC"), HasSubstr("JPEG or PNG"))));
  EXPECT_THAT([&] { read_photograph(folder / "text.jpg"); }, ThrowsMessage<IoError>(HasSubstr("unknown")));
  EXPECT_THROW(read_photograph(folder / "missing.jpg"), IoError);
  EXPECT_FALSE(is_image(folder / "text.jpg"));
}

}  // namespace
}  // namespace dendrofit
