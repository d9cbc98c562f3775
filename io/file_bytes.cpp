// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/file_bytes.h"

#include "core/errors.h"

#include <cctype>
#include <cerrno>
#include <utility>

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

namespace dendrofit {
namespace {

struct Descriptor {
  int fd;
  ~Descriptor() { ::close(fd); }
};

}  // namespace

void fail_at_byte(const std::filesystem::path& path, std::uint64_t offset, const std::string& what) {
  throw IoError(path.string() + ", byte " + std::to_string(offset) + ": " + what);
}

void fail_at_line(const std::filesystem::path& path, std::size_t line, const std::string& what) {
  throw IoError(path.string() + ", line " + std::to_string(line) + ": " + what);
}

void fail_in_file(const std::filesystem::path& path, const std::string& what) {
  throw IoError(path.string() + ": " + what);
}

std::string shown(std::string_view field) {
  std::string text = "'";
  for (const char c : field.substr(0, 24)) text += std::isprint(static_cast<unsigned char>(c)) ? c : '?';
  return text + (field.size() > 24 ? "...'" : "'");
}

FileBytes::FileBytes(std::filesystem::path path) : path_(std::move(path)) {
  const int fd = ::open(path_.c_str(), O_RDONLY | O_CLOEXEC);
  if (fd < 0) {
    if (errno == ENOENT) fail_in_file(path_, "no such file; check its name and folder");
    fail_in_file(path_,
                 std::string("cannot be opened (") + std::strerror(errno) + "); check its permissions");
  }
  const Descriptor file{fd};
  struct stat status {};
  if (::fstat(fd, &status) != 0)
    fail_in_file(path_, std::string("cannot be read (") + std::strerror(errno) + ")");
  if (S_ISDIR(status.st_mode)) fail_in_file(path_, "is a folder; name a file in it");
  if (S_ISREG(status.st_mode) && status.st_size > 0) {
    size_ = static_cast<std::size_t>(status.st_size);
    void* mapping = ::mmap(nullptr, size_, PROT_READ, MAP_PRIVATE, fd, 0);
    if (mapping != MAP_FAILED) {
      ::madvise(mapping, size_, MADV_SEQUENTIAL);
      data_ = static_cast<const char*>(mapping);
      mapped_ = true;
      return;
    }
  }
  char block[1 << 16];
  while (true) {
    const ssize_t got = ::read(fd, block, sizeof(block));
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) fail_in_file(path_, std::string("cannot be read (") + std::strerror(errno) + ")");
    if (got == 0) break;
    copy_.append(block, static_cast<std::size_t>(got));
  }
  data_ = copy_.data();
  size_ = copy_.size();
  if (size_ == 0) fail_in_file(path_, "is empty (0 bytes); was the copy or download interrupted?");
}

FileBytes::~FileBytes() {
  if (mapped_) ::munmap(const_cast<char*>(data_), size_);
}

void FileBytes::need(std::uint64_t offset, std::uint64_t count, const char* what) const {
  if (offset > size_ || count > size_ - offset)
    fail_at_byte(path_, size_,
                 std::string("the file ends before its ") + what + " (" + std::to_string(count) +
                     " bytes at byte " + std::to_string(offset) +
                     "); it is truncated or damaged, copy it again");
}

}  // namespace dendrofit
