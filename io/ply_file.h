// SPDX-License-Identifier: GPL-3.0-or-later
// PLY: header, and its numbers one after another whatever their encoding.
#pragma once

#include "io/file_bytes.h"

#include <bit>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace dendrofit {

enum class PlyType : std::uint8_t { int8, uint8, int16, uint16, int32, uint32, float32, float64 };
std::size_t ply_width(PlyType type);
double ply_number(PlyType type, const char* from, std::endian order);

struct PlyProperty {
  std::string name;
  PlyType type = PlyType::float32;
  bool is_list = false;
  PlyType count_type = PlyType::uint8;  ///< of a list's length
};

struct PlyElement {
  std::string name;
  std::uint64_t count = 0;
  std::vector<PlyProperty> properties;
  int find(std::string_view property) const;  ///< index, -1 without one
  bool has_lists() const;
  std::size_t stride() const;  ///< bytes of one, without lists
};

struct PlyHeader {
  bool ascii = false;
  std::endian order = std::endian::little;
  std::vector<PlyElement> elements;
  std::uint64_t data_offset = 0;
  std::size_t lines = 0;  ///< of the header
  std::string crs;        ///< after "comment crs", as write_point_cloud leaves it
  const PlyElement* find(std::string_view element) const;
};

/// Throws IoError for anything that is no PLY header, or claims more than the file can hold.
PlyHeader read_ply_header(const FileBytes& bytes);

/// Walks over the numbers behind the header. Every step is checked against the end of the file.
class PlyCursor {
 public:
  PlyCursor(const FileBytes& bytes, const PlyHeader& header)
      : bytes_(bytes), header_(header), at_(header.data_offset), line_(header.lines + 1) {}
  /// The next number of this type; finite or not. Throws IoError at the end or for what is no number.
  double next(PlyType type);
  /// A list's length, at most what the file can still hold.
  std::uint64_t next_count(PlyType type);
  /// Passes over one element.
  void skip(const PlyElement& element);
  std::uint64_t offset() const { return at_; }
  void seek(std::uint64_t offset) { at_ = offset; }
  [[noreturn]] void fail(const std::string& what) const;

 private:
  const FileBytes& bytes_;
  const PlyHeader& header_;
  std::uint64_t at_;
  std::size_t line_;
};

}  // namespace dendrofit
