// SPDX-License-Identifier: GPL-3.0-or-later
// Files written whole or not at all.
#pragma once

#include <filesystem>
#include <fstream>
#include <string_view>

namespace dendrofit {

/// A file under a temporary name beside its final one; commit() renames it into place, the destructor of an
/// uncommitted file removes it. Throws IoError when the file cannot be made, filled or renamed.
class AtomicFile {
 public:
  explicit AtomicFile(std::filesystem::path path);
  ~AtomicFile();
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;

  std::ostream& stream() { return stream_; }
  void commit();

  /// For writers that want a file name of their own (an image library): the temporary path, not yet existing
  /// content.
  const std::filesystem::path& temporary_path() const { return temporary_; }

 private:
  std::filesystem::path path_;
  std::filesystem::path temporary_;
  std::ofstream stream_;
  bool committed_ = false;
};

/// The whole content at once.
void write_file(const std::filesystem::path& path, std::string_view content);

}  // namespace dendrofit
