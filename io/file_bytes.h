// SPDX-License-Identifier: GPL-3.0-or-later
// A file's bytes, and the two ways of saying where in them something is wrong.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <string>
#include <string_view>

namespace dendrofit {

/// Throws IoError "FILE, byte OFFSET: what".
[[noreturn]] void fail_at_byte(const std::filesystem::path& path, std::uint64_t offset,
                               const std::string& what);
/// Throws IoError "FILE, line LINE: what".
[[noreturn]] void fail_at_line(const std::filesystem::path& path, std::size_t line, const std::string& what);
/// Throws IoError "FILE: what".
[[noreturn]] void fail_in_file(const std::filesystem::path& path, const std::string& what);
/// At most 24 characters of a field, unprintable bytes as '?', in quotes: fit for a message.
std::string shown(std::string_view field);

/// The whole content of a file, mapped into memory (read, where it cannot be mapped). Throws IoError for a
/// missing file, a folder, a file that may not be read, or an empty one.
class FileBytes {
 public:
  explicit FileBytes(std::filesystem::path path);
  ~FileBytes();
  FileBytes(const FileBytes&) = delete;
  FileBytes& operator=(const FileBytes&) = delete;

  const std::filesystem::path& path() const { return path_; }
  std::string_view view() const { return {data_, size_}; }
  const char* data() const { return data_; }
  std::size_t size() const { return size_; }

  /// A number of fixed width at `offset`, whose bytes are little- (default) or big-endian. Throws IoError
  /// when the file ends before; `what` names the field.
  template <class Number>
  Number number(std::uint64_t offset, const char* what, std::endian order = std::endian::little) const {
    need(offset, sizeof(Number), what);
    return load<Number>(data_ + offset, order);
  }
  /// Throws IoError unless bytes [offset, offset + count) exist.
  void need(std::uint64_t offset, std::uint64_t count, const char* what) const;

  /// Bytes to number, unchecked.
  template <class Number>
  static Number load(const char* from, std::endian order = std::endian::little) {
    char bytes[sizeof(Number)];
    std::memcpy(bytes, from, sizeof(Number));
    if (order != std::endian::native)
      for (std::size_t i = 0; i < sizeof(Number) / 2; ++i) std::swap(bytes[i], bytes[sizeof(Number) - 1 - i]);
    Number value;
    std::memcpy(&value, bytes, sizeof(Number));
    return value;
  }

 private:
  std::filesystem::path path_;
  const char* data_ = nullptr;
  std::size_t size_ = 0;
  bool mapped_ = false;
  std::string copy_;
};

}  // namespace dendrofit
