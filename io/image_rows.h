// SPDX-License-Identifier: GPL-3.0-or-later
// A picture as its decoder hands it over, row by row, made smaller on the way so that a huge one never lies
// in memory whole.
#pragma once

#include "io/file_bytes.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace dendrofit {

/// Rows from the top as stored in the file, `channels` values a pixel (1 grey, 3 RGB, 4 RGB and alpha), 0 to
/// 255 or, where `deep`, 0 to 65535.
struct StoredImage {
  int stored_width = 0;  ///< of the file, before halving
  int stored_height = 0;
  int halvings = 0;
  int width = 0;  ///< of `values`: stored size over 2^halvings, rounded up
  int height = 0;
  int channels = 0;
  bool deep = false;
  int orientation = 1;  ///< EXIF, 1 to 8
  std::vector<std::uint16_t> values;
};

struct HalvingRule {
  double most_pixels = 13e6;  ///< a picture with more is halved until it has no more
  int at_least = 0;           ///< halvings in any case
};

/// Takes a file's rows and fills StoredImage::values with the means of blocks of 2^halvings pixels.
class RowShrinker {
 public:
  /// Sets sizes and halvings of `image`, whose stored size and channels are known.
  RowShrinker(StoredImage& image, const HalvingRule& rule);
  void add(const std::uint8_t* row);
  void add(const std::uint16_t* row);
  /// After the last row.
  void finish();

 private:
  template <class Value>
  void sum(const Value* row);
  void flush();

  StoredImage& image_;
  std::vector<std::uint32_t> sums_;
  std::vector<std::uint32_t> count_;  ///< pixels of the stored row in each block's width
  std::uint32_t rows_ = 0;
  int next_row_ = 0;
};

/// Both throw IoError naming the file, and the row after which it is corrupt.
StoredImage decode_jpeg(const FileBytes& file, const HalvingRule& rule);
StoredImage decode_png(const FileBytes& file, const HalvingRule& rule);

/// Orientation (1 to 8) of a TIFF-structured EXIF block; 1 where it holds none or is damaged (CIPA DC-008,
/// tag 0x0112).
int exif_orientation(const std::uint8_t* tiff, std::size_t size);

}  // namespace dendrofit
