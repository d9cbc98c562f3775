// SPDX-License-Identifier: GPL-3.0-or-later
// PNG through libpng's row interface (its simple one does not tell where a file breaks). Errors leave by
// longjmp, so nothing with a destructor is made between setjmp and the calls that may fail.
#include "core/errors.h"
#include "io/image_rows.h"

#include <algorithm>
#include <bit>
#include <csetjmp>
#include <cstring>
#include <string>

#include <png.h>

namespace dendrofit {
namespace {

struct PngState {
  const FileBytes* file = nullptr;
  std::size_t at = 0;
  png_structp reader = nullptr;
  png_infop info = nullptr;
  std::string message;
  ~PngState() { png_destroy_read_struct(&reader, &info, nullptr); }
};

void give_bytes(png_structp reader, png_bytep out, std::size_t count) {
  auto& state = *static_cast<PngState*>(png_get_io_ptr(reader));
  if (count > state.file->size() - state.at) png_error(reader, "the file ends early");
  std::memcpy(out, state.file->data() + state.at, count);
  state.at += count;
}

[[noreturn]] void leave(png_structp reader, png_const_charp message) {
  auto& state = *static_cast<PngState*>(png_get_error_ptr(reader));
  state.message = message;
  png_longjmp(reader, 1);
}

void ignore(png_structp, png_const_charp) {}

/// Header read, pixels asked for as grey, RGB or RGBA of 8 or 16 bits; the number of passes, 0 after an
/// error.
int start(PngState& state) {
  if (setjmp(png_jmpbuf(state.reader))) return 0;
  png_set_read_fn(state.reader, &state, give_bytes);
  png_set_user_limits(state.reader, 1'000'000, 1'000'000);
  png_read_info(state.reader, state.info);
  png_set_expand(state.reader);
  if (std::endian::native == std::endian::little) png_set_swap(state.reader);
  const int colour = png_get_color_type(state.reader, state.info);
  const bool alpha =
      (colour & PNG_COLOR_MASK_ALPHA) || png_get_valid(state.reader, state.info, PNG_INFO_tRNS);
  if (alpha && !(colour & PNG_COLOR_MASK_COLOR)) png_set_gray_to_rgb(state.reader);
  const int passes = png_set_interlace_handling(state.reader);
  png_read_update_info(state.reader, state.info);
  return passes;
}

bool read_row(PngState& state, png_bytep row) {
  if (setjmp(png_jmpbuf(state.reader))) return false;
  png_read_row(state.reader, row, nullptr);
  return true;
}

bool finish(PngState& state) {
  if (setjmp(png_jmpbuf(state.reader))) return false;
  png_read_end(state.reader, state.info);
  return true;
}

}  // namespace

StoredImage decode_png(const FileBytes& file, const HalvingRule& rule) {
  PngState state;
  state.file = &file;
  state.reader = png_create_read_struct(PNG_LIBPNG_VER_STRING, &state, leave, ignore);
  if (state.reader) state.info = png_create_info_struct(state.reader);
  if (!state.info) fail_in_file(file.path(), "the PNG decoder does not start");
  const int passes = start(state);
  if (passes == 0) fail_in_file(file.path(), "not a readable PNG: " + state.message);

  StoredImage image;
  const double width = png_get_image_width(state.reader, state.info);
  const double height = png_get_image_height(state.reader, state.info);
  const double most = passes == 1 ? 1e9 : 2e8;
  if (width * height > most)
    fail_in_file(file.path(), std::to_string(static_cast<long>(width * height / 1e6)) + " Mpx" +
                                  (passes == 1 ? "" : " (interlaced)") + ": at most " +
                                  std::to_string(static_cast<long>(most / 1e6)) + "; make it smaller");
  image.stored_width = static_cast<int>(width);
  image.stored_height = static_cast<int>(height);
  image.channels = png_get_channels(state.reader, state.info);
  image.deep = png_get_bit_depth(state.reader, state.info) == 16;

  const std::size_t bytes = png_get_rowbytes(state.reader, state.info);
  // An interlaced file gives its rows complete only in the last pass.
  std::vector<std::uint16_t> pixels((bytes + 1) / 2 * (passes == 1 ? 1 : static_cast<std::size_t>(height)));
  RowShrinker shrinker(image, rule);
  for (int pass = 0; pass < passes; ++pass)
    for (int y = 0; y < image.stored_height; ++y) {
      std::uint16_t* row = pixels.data() + (passes == 1 ? 0 : (bytes + 1) / 2 * static_cast<std::size_t>(y));
      if (!read_row(state, reinterpret_cast<png_bytep>(row)))
        fail_in_file(file.path(),
                     (passes == 1 ? "file is corrupt after row " + std::to_string(y) + " of " +
                                        std::to_string(image.stored_height)
                                  : std::string("file is corrupt (interlaced: every row is affected)")) +
                         " (" + state.message + "); fetch the picture again");
      if (pass + 1 < passes) continue;
      if (image.deep)
        shrinker.add(row);
      else
        shrinker.add(reinterpret_cast<const std::uint8_t*>(row));
    }
  shrinker.finish();
  if (!finish(state)) fail_in_file(file.path(), "file is corrupt after its last row (" + state.message + ")");
  png_bytep exif = nullptr;
  png_uint_32 size = 0;
  if (png_get_eXIf_1(state.reader, state.info, &size, &exif) != 0 && exif)
    image.orientation = exif_orientation(exif, size);
  return image;
}

}  // namespace dendrofit
