// SPDX-License-Identifier: GPL-3.0-or-later
// LAS and LAZ to each other without a loss: the header patched, everything else as it is.
#include "core/atomic_file.h"
#include "core/errors.h"
#include "io/laz_stream.h"
#include "io/text_numbers.h"

#include <algorithm>
#include <cstring>

namespace dendrofit {
namespace {

enum : std::size_t {  // byte offsets in the header
  kGlobalEncoding = 6,
  kPointsOffset = 96,
  kVlrCount = 100,
  kPointFormat = 104,
  kOffset = 155,
  kBounds = 179,
  kWaveforms = 227,
  kEvlrStart = 235,
  kEvlrCount = 243
};

template <class Number>
void put(std::string& header, std::size_t at, Number value) {
  std::memcpy(header.data() + at, &value, sizeof(value));
}

// The extended records at the end of a LAS 1.4 file; empty without any.
std::string_view extended_records(const FileBytes& bytes, const LasHeader& h, std::uint32_t& count) {
  count = 0;
  if (h.minor < 4) return {};
  const auto start = bytes.number<std::uint64_t>(kEvlrStart, "extended records");
  count = bytes.number<std::uint32_t>(kEvlrCount, "number of extended records");
  if (count == 0 || start < h.points_offset) return {};
  std::uint64_t at = start;
  for (std::uint32_t k = 0; k < count; ++k) {
    bytes.need(at, 60, "extended record");
    const auto length = bytes.number<std::uint64_t>(at + 20, "record length");
    bytes.need(at + 60, length, "extended record");
    at += 60 + length;
  }
  return bytes.view().substr(start, at - start);
}

#if !DENDROFIT_HAS_LASZIP
// Header and variable length records but the compressor's, as those of an uncompressed file.
std::string uncompressed_head(const FileBytes& bytes, const LasHeader& h, const Vec3& shift) {
  const auto header_size = bytes.number<std::uint16_t>(94, "header size");
  std::string head(bytes.view().substr(0, header_size));
  const auto records = bytes.number<std::uint32_t>(kVlrCount, "number of records");
  std::uint64_t at = header_size;
  std::uint32_t kept = 0;
  for (std::uint32_t k = 0; k < records && at < h.points_offset; ++k) {
    const std::uint64_t size = 54 + bytes.number<std::uint16_t>(at + 20, "record length");
    bytes.need(at, size, "variable length record");
    if (!bytes.view().substr(at + 2, 16).starts_with("laszip encoded")) {
      head += bytes.view().substr(at, size);
      ++kept;
    }
    at += size;
  }
  put(head, kVlrCount, kept);
  put(head, kPointsOffset, static_cast<std::uint32_t>(head.size()));
  put(head, kPointFormat, static_cast<std::uint8_t>(h.point_format));
  for (std::size_t k = 0; k < 3; ++k) {
    const double add = shift[static_cast<Eigen::Index>(k)];
    put(head, kOffset + 8 * k, h.offset[k] + add);
    for (std::size_t side = 0; side < 2; ++side) {
      const std::size_t place = kBounds + 16 * k + 8 * side;
      put(head, place, bytes.number<double>(place, "bounds") + add);
    }
  }
  if (h.minor >= 3 && header_size >= 235) put(head, kWaveforms, std::uint64_t{0});
  return head;
}

void copy_points(const FileBytes& bytes, const LasHeader& h, std::ostream& out, Progress& progress) {
  progress.begin("copying", static_cast<double>(h.point_count), "points");
  const auto take = [&](const char* records, std::uint64_t count) {
    out.write(records, static_cast<std::streamsize>(count * h.record_length));
    progress.advance(static_cast<double>(count));
    progress.check();
  };
  if (h.compressed) {
    check_laz_chunks(bytes, h);
    return laz_records(bytes, h, take, progress);
  }
  constexpr std::uint64_t block = 1 << 18;
  bytes.need(h.points_offset, h.point_count * h.record_length, "points");
  for (std::uint64_t i = 0; i < h.point_count; i += block)
    take(bytes.data() + h.points_offset + i * h.record_length, std::min(block, h.point_count - i));
}
#endif

}  // namespace

bool can_write_laz() {
#if DENDROFIT_HAS_LASZIP
  return true;
#else
  return false;
#endif
}

void fail_without_laz_writer(const std::filesystem::path& out) {
  throw IoError(
      out.string() +
      ": this build has no LAZ compressor: that is the LASzip library, which Debian 12 does not have, and "
      "npm's laz-perf, which reads LAZ here, cannot compress; write .las, or build where LASzip is "
      "installed (apt-get install liblaszip-dev on Debian 13 and Ubuntu)");
}

void copy_las(const std::filesystem::path& in, const std::filesystem::path& out, const Vec3& shift,
              Progress& progress) {
  const bool compress = lower(out.extension().string()) == ".laz";
  if (compress && !can_write_laz()) fail_without_laz_writer(out);
  const FileBytes bytes(in);
  const LasHeader h = read_las_header(bytes);
  if (h.compressed) check_laz_chunks(bytes, h);
  std::uint32_t extended_count = 0;
  const std::string_view extended = extended_records(bytes, h, extended_count);
  AtomicFile file(out);
#if DENDROFIT_HAS_LASZIP
  laszip_copy(bytes, h, file.stream(), compress, shift, progress);
#else
  const std::string head = uncompressed_head(bytes, h, shift);
  file.stream().write(head.data(), static_cast<std::streamsize>(head.size()));
  copy_points(bytes, h, file.stream(), progress);
#endif
  if (h.minor >= 4) {
    file.stream().seekp(0, std::ios::end);
    const auto start = static_cast<std::uint64_t>(file.stream().tellp());
    file.stream().write(extended.data(), static_cast<std::streamsize>(extended.size()));
    const std::uint64_t place = extended.empty() ? 0 : start;
    const std::uint32_t count = extended.empty() ? 0 : extended_count;
    file.stream().seekp(kEvlrStart);
    file.stream().write(reinterpret_cast<const char*>(&place), 8);
    file.stream().write(reinterpret_cast<const char*>(&count), 4);
  }
  file.commit();
  progress.end();
}

}  // namespace dendrofit
