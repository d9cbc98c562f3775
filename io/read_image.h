// SPDX-License-Identifier: GPL-3.0-or-later
// Photographs and masks from JPEG and PNG files.
#pragma once

#include "core/photograph.h"

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace dendrofit {

struct ReadImageOptions {
  double most_megapixels = 13;  ///< a larger picture is halved until it has no more
  int at_least_halvings = 0;    ///< to match another picture that was halved
  /// Width and height that a cameras file gives. Where only the stored orientation fits, it is kept.
  std::optional<std::array<int, 2>> expected_size = std::nullopt;
  void validate() const;
};

struct ReadImageResult {
  Photograph photo;    ///< upright (EXIF orientation applied), 8 bits a channel
  int full_width = 0;  ///< upright, before halving
  int full_height = 0;
  int halvings = 0;
  std::vector<std::string> warnings;
};

/// True for a file that begins like a JPEG or PNG.
bool is_image(const std::filesystem::path& file);

/// 16-bit pictures are scaled linearly so that the 99.9th percentile of all values is white. Where a
/// picture has transparent pixels, those with less than half opacity are background, the others its mask.
/// Throws IoError naming file and row of what is broken, and what to do about other formats.
ReadImageResult read_photograph(const std::filesystem::path& file, const ReadImageOptions& options = {});

/// Reads `file` as the mask of `image`: what is brighter than half its brightest value is tree (opaque, where
/// the file has transparency). Throws InputError when its size is not the photograph's, or when it marks
/// nothing or everything.
void read_mask(const std::filesystem::path& file, ReadImageResult& image);

}  // namespace dendrofit
