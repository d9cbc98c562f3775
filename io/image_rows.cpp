// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/image_rows.h"

#include <algorithm>

namespace dendrofit {

RowShrinker::RowShrinker(StoredImage& image, const HalvingRule& rule) : image_(image) {
  const auto smaller = [](int size, int halvings) { return (size + (1 << halvings) - 1) >> halvings; };
  image.halvings = std::clamp(rule.at_least, 0, 8);
  while (image.halvings < 8 && static_cast<double>(smaller(image.stored_width, image.halvings)) *
                                       smaller(image.stored_height, image.halvings) >
                                   rule.most_pixels)
    ++image.halvings;
  image.width = smaller(image.stored_width, image.halvings);
  image.height = smaller(image.stored_height, image.halvings);
  const auto row = static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.channels);
  image.values.assign(row * static_cast<std::size_t>(image.height), 0);
  sums_.assign(row, 0);
  count_.assign(static_cast<std::size_t>(image.width), 0);
  for (int x = 0; x < image.stored_width; ++x) ++count_[static_cast<std::size_t>(x >> image.halvings)];
}

template <class Value>
void RowShrinker::sum(const Value* row) {
  const auto channels = static_cast<std::size_t>(image_.channels);
  for (int x = 0; x < image_.stored_width; ++x) {
    const std::size_t to = channels * static_cast<std::size_t>(x >> image_.halvings);
    const std::size_t from = channels * static_cast<std::size_t>(x);
    for (std::size_t c = 0; c < channels; ++c) sums_[to + c] += row[from + c];
  }
  if (++rows_ == 1U << image_.halvings) flush();
}

void RowShrinker::add(const std::uint8_t* row) {
  sum(row);
}
void RowShrinker::add(const std::uint16_t* row) {
  sum(row);
}

void RowShrinker::flush() {
  if (rows_ == 0 || next_row_ >= image_.height) return;
  const auto channels = static_cast<std::size_t>(image_.channels);
  const std::size_t out = static_cast<std::size_t>(next_row_) * sums_.size();
  for (std::size_t i = 0; i < sums_.size(); ++i) {
    const std::uint32_t n = rows_ * count_[i / channels];
    image_.values[out + i] = static_cast<std::uint16_t>((sums_[i] + n / 2) / n);
  }
  std::fill(sums_.begin(), sums_.end(), 0);
  rows_ = 0;
  ++next_row_;
}

void RowShrinker::finish() {
  flush();
}

int exif_orientation(const std::uint8_t* tiff, std::size_t size) {
  if (size < 14) return 1;
  const bool little = tiff[0] == 'I' && tiff[1] == 'I';
  if (!little && !(tiff[0] == 'M' && tiff[1] == 'M')) return 1;
  const auto number = [&](std::size_t at, int bytes) {
    std::size_t value = 0;
    for (int i = 0; i < bytes; ++i)
      value = value << 8 | tiff[at + static_cast<std::size_t>(little ? bytes - 1 - i : i)];
    return value;
  };
  const std::size_t directory = number(4, 4);
  if (directory > size - 2) return 1;
  const std::size_t entries = number(directory, 2);
  for (std::size_t e = 0; e < entries; ++e) {
    const std::size_t at = directory + 2 + 12 * e;
    if (at + 12 > size) return 1;
    if (number(at, 2) != 0x0112) continue;
    const std::size_t value = number(at + 8, 2);
    return value >= 1 && value <= 8 ? static_cast<int>(value) : 1;
  }
  return 1;
}

}  // namespace dendrofit
