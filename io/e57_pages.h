// SPDX-License-Identifier: GPL-3.0-or-later
// E57 (ASTM E2807) files below their XML: pages that end in a checksum, and streams of packed numbers.
#pragma once

#include "io/file_bytes.h"

#include <cstdint>
#include <string>
#include <vector>

namespace dendrofit {

/// The file's bytes without the checksums. Offsets in the file are physical; reading goes on over page ends.
class E57Pages {
 public:
  /// Reads and checks the 48 byte header. Throws IoError.
  explicit E57Pages(const FileBytes& bytes);

  std::uint64_t xml_offset() const { return xml_offset_; }  ///< physical
  std::uint64_t xml_length() const { return xml_length_; }  ///< logical
  /// Logical place of a physical offset; throws IoError when it lies in a checksum or beyond the end.
  std::uint64_t logical(std::uint64_t physical, const char* what) const;
  std::uint64_t logical_size() const { return pages_ * (page_ - 4); }
  /// `count` bytes from a logical offset on. Throws IoError beyond the end and for a page whose checksum is
  /// wrong.
  std::string read(std::uint64_t logical, std::uint64_t count, const char* what);

 private:
  void check_page(std::uint64_t page);

  const FileBytes& bytes_;
  std::uint64_t page_ = 1024;  ///< bytes, checksum included
  std::uint64_t pages_ = 0;
  std::uint64_t xml_offset_ = 0;
  std::uint64_t xml_length_ = 0;
  std::vector<char> checked_;
};

/// CRC-32C of `size` bytes (Castagnoli polynomial, reflected).
std::uint32_t crc32c(const char* data, std::size_t size);

/// One field of a compressed vector: its numbers come as a stream of bits, cut into packets anywhere.
class E57Stream {
 public:
  enum class Kind { single, real, integer };
  static E57Stream reals(Kind kind);
  /// Whole numbers in [lo, hi], each in the fewest bits that hold hi - lo, times `scale` plus `offset`.
  static E57Stream integers(std::int64_t lo, std::int64_t hi, double scale, double offset);

  int bits() const { return bits_; }
  void append(std::string_view data) { pending_ += data; }
  /// Whole numbers now there; any number of them where each takes no bits.
  std::uint64_t available() const;
  double next();
  /// Frees what has been read.
  void compact();

 private:
  Kind kind_ = Kind::real;
  int bits_ = 64;
  std::int64_t lo_ = 0;
  double scale_ = 1;
  double offset_ = 0;
  std::string pending_;
  std::uint64_t bit_ = 0;  ///< of pending_, read so far
};

}  // namespace dendrofit
