// SPDX-License-Identifier: GPL-3.0-or-later
// JPEG through libjpeg. Its errors leave by longjmp, so nothing with a destructor is made between setjmp and
// the calls that may fail.
#include "core/errors.h"
#include "io/image_rows.h"

#include <csetjmp>
#include <cstdio>
#include <cstring>
#include <memory>
#include <string>

#include <jerror.h>
#include <jpeglib.h>

namespace dendrofit {
namespace {

struct JpegState {
  jpeg_decompress_struct decoder;
  jpeg_error_mgr errors;
  std::jmp_buf back;
  char message[JMSG_LENGTH_MAX] = {};
  bool corrupt = false;   ///< the data ended or broke; libjpeg would go on with grey
  long corrupt_row = -1;  ///< rows delivered before that
};

JpegState& state_of(j_common_ptr any) {
  return *static_cast<JpegState*>(any->client_data);
}

[[noreturn]] void leave(j_common_ptr any) {
  JpegState& state = state_of(any);
  any->err->format_message(any, state.message);
  std::longjmp(state.back, 1);
}

void note(j_common_ptr any, int level) {
  if (level >= 0) return;
  const int code = any->err->msg_code;
  if (code != JWRN_HIT_MARKER && code != JWRN_JPEG_EOF && code != JWRN_HUFF_BAD_CODE &&
      code != JWRN_MUST_RESYNC)
    return;
  JpegState& state = state_of(any);
  if (state.corrupt) return;
  state.corrupt = true;
  state.corrupt_row = static_cast<long>(state.decoder.output_scanline);
  any->err->format_message(any, state.message);
}

/// Header read and decoder started; false after an error.
bool start(JpegState& state, const FileBytes& file) {
  if (setjmp(state.back)) return false;
  jpeg_mem_src(&state.decoder, reinterpret_cast<const unsigned char*>(file.data()), file.size());
  jpeg_save_markers(&state.decoder, JPEG_APP0 + 1, 0xFFFF);
  jpeg_read_header(&state.decoder, TRUE);
  const J_COLOR_SPACE space = state.decoder.jpeg_color_space;
  if (space == JCS_CMYK || space == JCS_YCCK) return true;
  state.decoder.out_color_space = space == JCS_GRAYSCALE ? JCS_GRAYSCALE : JCS_RGB;
  jpeg_start_decompress(&state.decoder);
  return true;
}

bool read_row(JpegState& state, std::uint8_t* row) {
  if (setjmp(state.back)) return false;
  JSAMPROW rows[1] = {row};
  jpeg_read_scanlines(&state.decoder, rows, 1);
  return !state.corrupt;
}

}  // namespace

StoredImage decode_jpeg(const FileBytes& file, const HalvingRule& rule) {
  auto state = std::make_unique<JpegState>();
  state->decoder.err = jpeg_std_error(&state->errors);
  state->decoder.client_data = state.get();
  state->errors.error_exit = leave;
  state->errors.emit_message = note;
  if (setjmp(state->back)) fail_in_file(file.path(), "the JPEG decoder does not start");
  jpeg_create_decompress(&state->decoder);
  struct Destroyer {
    JpegState& state;
    ~Destroyer() { jpeg_destroy_decompress(&state.decoder); }
  } const destroyer{*state};

  const bool started = start(*state, file);
  const jpeg_decompress_struct& decoder = state->decoder;
  if (!started) fail_in_file(file.path(), std::string("not a readable JPEG: ") + state->message);
  if (decoder.jpeg_color_space == JCS_CMYK || decoder.jpeg_color_space == JCS_YCCK)
    fail_in_file(file.path(), "a CMYK JPEG; save it as RGB");
  if (state->corrupt)
    fail_in_file(file.path(), std::string("file is corrupt: ") + state->message +
                                  " (progressive: every row is affected); fetch the photograph again");

  StoredImage image;
  image.stored_width = static_cast<int>(decoder.output_width);
  image.stored_height = static_cast<int>(decoder.output_height);
  image.channels = decoder.output_components;
  for (jpeg_saved_marker_ptr marker = decoder.marker_list; marker; marker = marker->next)
    if (marker->marker == JPEG_APP0 + 1 && marker->data_length > 6 &&
        std::memcmp(marker->data, "Exif\0\0", 6) == 0)
      image.orientation = exif_orientation(marker->data + 6, marker->data_length - 6);
  RowShrinker shrinker(image, rule);
  std::vector<std::uint8_t> row(static_cast<std::size_t>(image.stored_width) *
                                static_cast<std::size_t>(image.channels));
  for (int y = 0; y < image.stored_height; ++y) {
    if (!read_row(*state, row.data()))
      fail_in_file(file.path(), "file is corrupt after row " +
                                    std::to_string(state->corrupt ? state->corrupt_row : y) + " of " +
                                    std::to_string(image.stored_height) + " (" + state->message +
                                    "); fetch the photograph again");
    shrinker.add(row.data());
  }
  shrinker.finish();
  return image;
}

}  // namespace dendrofit
