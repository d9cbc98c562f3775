// SPDX-License-Identifier: GPL-3.0-or-later
// MATLAB level 5 MAT-files (what save -v6 and -v7 write): the part that structures of numbers need.
#pragma once

#include "io/file_bytes.h"

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace dendrofit {

/// A variable: numbers (column-major, whatever their type in the file), text, or a structure or cell array.
struct MatValue {
  enum class Kind { numbers, text, structure, cell, other };
  Kind kind = Kind::other;
  std::vector<std::int64_t> size;   ///< rows, columns, ...
  std::vector<double> numbers;      ///< numbers, or character codes
  std::vector<std::string> fields;  ///< of a structure
  std::vector<MatValue> elements;   ///< of a cell; of a structure element by element, field by field

  std::size_t count() const;  ///< product of size
  /// Field of element `element` of a structure, nullptr without one.
  const MatValue* field(std::string_view name, std::size_t element = 0) const;
};

/// All variables of a file, in order. Throws IoError naming the byte: not level 5 (7.3 files are HDF5: the
/// message tells how to save again), truncated, sizes that do not fit the bytes, damaged compression, nesting
/// deeper than 32. Memory is bounded by what the file really holds (compressed data: by 1 GiB).
std::vector<std::pair<std::string, MatValue>> read_mat(const FileBytes& bytes);

/// A structure of named double matrices under one variable: MATLAB's QSM.cylinder.* as `name` = "QSM",
/// `inner` = "cylinder". Each matrix is column-major with `rows` rows.
struct MatMatrix {
  std::string name;
  std::int64_t rows = 0;
  std::vector<double> values;
};
void write_mat(const std::filesystem::path& path, const std::string& name, const std::string& inner,
               const std::vector<MatMatrix>& matrices);

}  // namespace dendrofit
