// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/cloud_formats.h"
#include "io/las_format.h"
#include "io/las_projection.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace dendrofit {
namespace {

constexpr std::array<std::uint32_t, 11> kRecordLength = {20, 28, 26, 34, 57, 63, 30, 36, 38, 59, 67};

enum : std::uint64_t {  // byte offsets in the header
  kVersion = 24,
  kSoftware = 58,
  kHeaderSize = 94,
  kPointsOffset = 96,
  kVlrCount = 100,
  kPointFormat = 104,
  kRecordLengthAt = 105,
  kLegacyCount = 107,
  kScale = 131,
  kOffset = 155,
  kEvlrStart = 235,
  kEvlrCount = 243,
  kCount = 247
};

// One variable length record: `extended` ones have an 8 byte length. Returns the offset after it.
std::uint64_t read_record(const FileBytes& bytes, std::uint64_t at, bool extended, LasHeader& header) {
  const std::uint64_t head = extended ? 60 : 54;
  bytes.need(at, head, "variable length record");
  const std::uint64_t length = extended ? bytes.number<std::uint64_t>(at + 20, "record length")
                                        : bytes.number<std::uint16_t>(at + 20, "record length");
  bytes.need(at + head, length, "variable length record");
  const std::string_view user = bytes.view().substr(at + 2, 16);
  const auto id = bytes.number<std::uint16_t>(at + 18, "record id");
  const std::string_view content = bytes.view().substr(at + head, length);
  if (user.starts_with("LASF_Projection")) header.projection.push_back({id, std::string(content)});
  if (user.starts_with("laszip encoded") && id == 22204 && length >= 16)
    header.chunk_points = FileBytes::load<std::uint32_t>(content.data() + 12);
  return at + head + length;
}

}  // namespace

std::uint32_t las_record_length(int point_format) {
  return kRecordLength[static_cast<std::size_t>(point_format)];
}

LasHeader read_las_header(const FileBytes& bytes) {
  const auto fail = [&](std::uint64_t at, const std::string& what) { fail_at_byte(bytes.path(), at, what); };
  LasHeader h;
  bytes.need(0, 227, "LAS header");
  if (!bytes.view().starts_with("LASF"))
    fail(0, shown(bytes.view().substr(0, 4)) + " found, 'LASF' expected");
  h.major = bytes.number<std::uint8_t>(kVersion, "version");
  h.minor = bytes.number<std::uint8_t>(kVersion + 1, "version");
  if (h.major != 1 || h.minor > 4)
    fail(kVersion, "LAS version " + std::to_string(h.major) + "." + std::to_string(h.minor) +
                       " found; 1.0 to 1.4 are known");
  const auto header_size = bytes.number<std::uint16_t>(kHeaderSize, "header size");
  const std::uint16_t least = h.minor == 4 ? 375 : h.minor == 3 ? 235 : 227;
  if (header_size < least)
    fail(kHeaderSize, "header size " + std::to_string(header_size) + " found; LAS 1." +
                          std::to_string(h.minor) + " needs " + std::to_string(least));
  bytes.need(0, header_size, "LAS header");
  h.points_offset = bytes.number<std::uint32_t>(kPointsOffset, "offset to points");
  if (h.points_offset < header_size || h.points_offset > bytes.size())
    fail(kPointsOffset, "points at byte " + std::to_string(h.points_offset) + "; the header ends at " +
                            std::to_string(header_size) + " and the file at " + std::to_string(bytes.size()) +
                            " (truncated or damaged)");
  const auto format = bytes.number<std::uint8_t>(kPointFormat, "point format");
  h.compressed = (format & 0x80) != 0;
  h.point_format = format & 0x3f;
  if (h.point_format > 10)
    fail(kPointFormat, "point format " + std::to_string(h.point_format) + " found; 0 to 10 are known");
  h.record_length = bytes.number<std::uint16_t>(kRecordLengthAt, "record length");
  if (h.record_length < las_record_length(h.point_format))
    fail(kRecordLengthAt, "records of " + std::to_string(h.record_length) + " bytes; point format " +
                              std::to_string(h.point_format) + " needs " +
                              std::to_string(las_record_length(h.point_format)));
  h.point_count = bytes.number<std::uint32_t>(kLegacyCount, "number of points");
  if (h.minor == 4) {
    const auto count = bytes.number<std::uint64_t>(kCount, "number of points");
    if (count > 0 && h.point_count > 0 && count != h.point_count)
      fail(kCount, "two numbers of points that differ: " + std::to_string(h.point_count) + " (legacy) and " +
                       std::to_string(count));
    if (count > 0) h.point_count = count;
  }
  for (std::uint64_t k = 0; k < 3; ++k) {
    h.scale[k] = bytes.number<double>(kScale + 8 * k, "scale");
    h.offset[k] = bytes.number<double>(kOffset + 8 * k, "offset");
    if (!std::isfinite(h.scale[k]) || h.scale[k] == 0 || std::abs(h.scale[k]) > 1e6)
      fail(kScale + 8 * k,
           "scale " + std::to_string(h.scale[k]) + " found; expected a small number such as 0.001");
    if (!std::isfinite(h.offset[k]) || std::abs(h.offset[k]) > 1e12)
      fail(kOffset + 8 * k, "offset " + std::to_string(h.offset[k]) + " found; expected metres");
  }
  h.software = printable_text(bytes.view().substr(kSoftware, 32));
  const auto records = bytes.number<std::uint32_t>(kVlrCount, "number of records");
  std::uint64_t at = header_size;
  for (std::uint32_t k = 0; k < records && at < h.points_offset; ++k) at = read_record(bytes, at, false, h);
  if (h.minor == 4) {
    at = bytes.number<std::uint64_t>(kEvlrStart, "extended records");
    const auto extended = bytes.number<std::uint32_t>(kEvlrCount, "number of extended records");
    for (std::uint32_t k = 0; k < extended && at >= h.points_offset; ++k)
      at = read_record(bytes, at, true, h);
  }
  h.crs_wkt = crs_of(h.projection);
  return h;
}

LasDecoder::LasDecoder(const LasHeader& header, Progress& progress) : header_(header), progress_(progress) {
  cloud_.crs_wkt = header.crs_wkt;
  progress_.begin("reading", static_cast<double>(header.point_count), "points");
}

void LasDecoder::append(const char* records, std::uint64_t count) {
  constexpr std::uint64_t block = 1 << 18;
  const bool modern = header_.point_format >= 6;
  const std::size_t class_at = modern ? 16 : 15;
  const std::uint8_t class_mask = modern ? 0xff : 0x1f;
  const std::size_t before = cloud_.size();
  cloud_.points.resize(before + count);
  cloud_.intensity.resize(before + count);
  cloud_.classification.resize(before + count);
  for (std::uint64_t first = 0; first < count; first += block) {
    const std::uint64_t last = std::min(count, first + block);
    for (std::uint64_t i = first; i < last; ++i) {
      const char* record = records + i * header_.record_length;
      const std::size_t to = before + i;
      for (int k = 0; k < 3; ++k)
        cloud_.points[to][k] =
            FileBytes::load<std::int32_t>(record + 4 * k) * header_.scale[k] + header_.offset[k];
      cloud_.intensity[to] = FileBytes::load<std::uint16_t>(record + 12);
      cloud_.classification[to] = static_cast<std::uint8_t>(record[class_at]) & class_mask;
    }
    progress_.advance(static_cast<double>(last - first));
    progress_.check();
  }
}

void LasDecoder::append(std::int32_t x, std::int32_t y, std::int32_t z, std::uint16_t intensity,
                        std::uint8_t classification) {
  cloud_.points.emplace_back(x * header_.scale[0] + header_.offset[0],
                             y * header_.scale[1] + header_.offset[1],
                             z * header_.scale[2] + header_.offset[2]);
  cloud_.intensity.push_back(intensity);
  cloud_.classification.push_back(classification);
  if (cloud_.size() % (1 << 18) == 0) {
    progress_.advance(1 << 18);
    progress_.check();
  }
}

PointCloud read_las(const FileBytes& bytes, Progress& progress) {
  const LasHeader header = read_las_header(bytes);
  const std::uint64_t fit = (bytes.size() - header.points_offset) / header.record_length;
  if (header.point_count > fit)
    fail_at_byte(bytes.path(), bytes.size(),
                 "the header claims " + std::to_string(header.point_count) + " points, the file ends after " +
                     std::to_string(fit) + "; it is truncated, copy it again");
  LasDecoder decoder(header, progress);
  decoder.append(bytes.data() + header.points_offset, header.point_count);
  return decoder.take();
}

}  // namespace dendrofit
