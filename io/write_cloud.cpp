// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/write_cloud.h"

#include "core/atomic_file.h"
#include "core/errors.h"
#include "io/las_format.h"
#include "io/las_projection.h"
#include "io/text_numbers.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>

namespace dendrofit {
namespace {

// Little-endian bytes gathered in blocks and handed to the file.
class Bytes {
 public:
  Bytes(std::ostream& out, Progress& progress) : out_(out), progress_(progress) {
    block_.reserve(kBlock + 256);
  }
  template <class Number>
  Bytes& put(Number value) {
    static_assert(std::endian::native == std::endian::little);
    block_.append(reinterpret_cast<const char*>(&value), sizeof(value));
    return *this;
  }
  Bytes& text(std::string_view text, std::size_t width) {
    text = text.substr(0, width);
    block_ += text;
    block_.append(width - text.size(), '\0');
    return *this;
  }
  std::string& block() { return block_; }
  void flush_if_full() {
    if (block_.size() >= kBlock) flush();
  }
  void flush() {
    progress_.check();
    out_.write(block_.data(), static_cast<std::streamsize>(block_.size()));
    block_.clear();
  }

 private:
  static constexpr std::size_t kBlock = 1 << 20;
  std::ostream& out_;
  Progress& progress_;
  std::string block_;
};

std::uint16_t las_intensity(const PointCloud& cloud, std::size_t i) {
  if (cloud.intensity.empty() || !(cloud.intensity[i] > 0)) return 0;
  return static_cast<std::uint16_t>(std::min(std::round(cloud.intensity[i]), 65535.0f));
}

// The given frame where every coordinate is a 32 bit multiple of its step; else one of our own.
LasFrame frame_for(const PointCloud& cloud, const std::optional<LasFrame>& wanted) {
  const Bounds bounds = bounds_of(cloud.points);
  const auto reach = [&](const Vec3& offset) {
    const Vec3 lo = bounds.lo + (cloud.origin_shift - offset), hi = bounds.hi + (cloud.origin_shift - offset);
    return Vec3(lo.cwiseAbs().cwiseMax(hi.cwiseAbs()));
  };
  LasFrame frame = wanted.value_or(LasFrame{});
  if (wanted && reach(frame.offset).cwiseQuotient(frame.step).maxCoeff() < 2e9) return frame;
  frame.offset = cloud.origin_shift;
  double step = 1e-5;
  while (reach(frame.offset).maxCoeff() / step > 2e9) step *= 10;
  frame.step = Vec3::Constant(step);
  return frame;
}

// The coordinate system's records: as they were, else made from the cloud's own words.
std::vector<LasRecord> projection_records(const PointCloud& cloud, const LasFrame& frame) {
  if (frame.projection.empty()) return projection_of(cloud.crs_wkt);
  std::vector<LasRecord> records;
  for (const auto& [id, content] : frame.projection) records.push_back({id, content});
  return records;
}

void write_las(std::ostream& out, const PointCloud& cloud, const std::optional<LasFrame>& wanted,
               Progress& progress) {
  const Bounds bounds = bounds_of(cloud.points);
  const LasFrame frame = frame_for(cloud, wanted);
  const Vec3 local = cloud.origin_shift - frame.offset;
  const auto grid = [&](const Vec3& p, int k) {
    return static_cast<std::int32_t>(std::lround((p[k] + local[k]) / frame.step[k]));
  };
  const auto records = projection_records(cloud, frame);
  std::size_t record_bytes = 0;
  bool wkt = false;
  for (const auto& [id, content] : records) {
    if (content.size() > 65535)
      throw InputError("coordinate system: a record of more than 65535 bytes does not fit a LAS file");
    record_bytes += 54 + content.size();
    wkt = wkt || id == 2112;
  }
  const bool high_class = std::any_of(cloud.classification.begin(), cloud.classification.end(),
                                      [](std::uint8_t c) { return c > 31; });
  const bool modern = wkt || high_class || cloud.size() > std::numeric_limits<std::uint32_t>::max();
  const std::uint16_t header_size = modern ? 375 : 227;
  const auto points_offset = static_cast<std::uint32_t>(header_size + record_bytes);
  const int format = modern ? 6 : 0;
  const auto length = static_cast<std::uint16_t>(las_record_length(format));
  Bytes bytes(out, progress);
  bytes.text("LASF", 4).put(std::uint16_t{0}).put(static_cast<std::uint16_t>(wkt ? 16 : 0)).text("", 16);
  bytes.put(std::uint8_t{1})
      .put(static_cast<std::uint8_t>(modern ? 4 : 2))
      .text("", 32)
      .text("dendrofit", 32);
  bytes.put(std::uint16_t{0}).put(std::uint16_t{0}).put(header_size).put(points_offset);
  bytes.put(static_cast<std::uint32_t>(records.size())).put(static_cast<std::uint8_t>(format)).put(length);
  const std::uint32_t legacy = modern ? 0 : static_cast<std::uint32_t>(cloud.size());
  bytes.put(legacy).put(legacy).text("", 16);  // all points as first returns
  for (int k = 0; k < 3; ++k) bytes.put(frame.step[k]);
  for (int k = 0; k < 3; ++k) bytes.put(frame.offset[k]);
  for (int k = 0; k < 3; ++k) {
    bytes.put(grid(bounds.hi, k) * frame.step[k] + frame.offset[k]);
    bytes.put(grid(bounds.lo, k) * frame.step[k] + frame.offset[k]);
  }
  if (modern) {
    bytes.put(std::uint64_t{0})
        .put(std::uint64_t{0})
        .put(std::uint32_t{0})
        .put(static_cast<std::uint64_t>(cloud.size()));
    bytes.put(static_cast<std::uint64_t>(cloud.size())).text("", 14 * 8);
  }
  for (const auto& [id, content] : records) {
    bytes.put(std::uint16_t{0}).text("LASF_Projection", 16).put(id);
    bytes.put(static_cast<std::uint16_t>(content.size())).text("", 32).text(content, content.size());
  }
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    for (int k = 0; k < 3; ++k) bytes.put(grid(cloud.points[i], k));
    const std::uint8_t kind = cloud.classification.empty() ? std::uint8_t{0} : cloud.classification[i];
    bytes.put(las_intensity(cloud, i));
    if (modern) {
      bytes.put(std::uint8_t{0x11})
          .put(std::uint8_t{0})
          .put(kind)
          .put(std::uint8_t{0})
          .put(std::int16_t{0})
          .put(std::uint16_t{0})
          .put(0.0);
    } else {
      bytes.put(std::uint8_t{0x09}).put(kind).put(std::int8_t{0}).put(std::uint8_t{0}).put(std::uint16_t{0});
    }
    bytes.flush_if_full();
  }
  bytes.flush();
}

void put_point_binary(Bytes& bytes, const PointCloud& cloud, std::size_t i) {
  const Vec3 world = cloud.points[i] + cloud.origin_shift;
  bytes.put(world.x()).put(world.y()).put(world.z());
  if (!cloud.intensity.empty()) bytes.put(cloud.intensity[i]);
  if (!cloud.classification.empty()) bytes.put(cloud.classification[i]);
  bytes.flush_if_full();
}

// One line, as a PLY comment must be.
std::string crs_comment(std::string crs) {
  if (crs.empty()) return {};
  std::replace_if(
      crs.begin(), crs.end(), [](unsigned char c) { return c < 32; }, ' ');
  return "comment crs " + crs + "\n";
}

void write_ply(std::ostream& out, const PointCloud& cloud, Progress& progress) {
  Bytes bytes(out, progress);
  bytes.block() += "ply\nformat binary_little_endian 1.0\ncomment written by dendrofit\n" +
                   crs_comment(cloud.crs_wkt) + "element vertex " + std::to_string(cloud.size()) +
                   "\nproperty double x\nproperty double y\nproperty double z\n";
  if (!cloud.intensity.empty()) bytes.block() += "property float intensity\n";
  if (!cloud.classification.empty()) bytes.block() += "property uchar classification\n";
  bytes.block() += "end_header\n";
  for (std::size_t i = 0; i < cloud.size(); ++i) put_point_binary(bytes, cloud, i);
  bytes.flush();
}

void write_pcd(std::ostream& out, const PointCloud& cloud, Progress& progress) {
  Bytes bytes(out, progress);
  const bool intensity = !cloud.intensity.empty();
  const bool classes = !cloud.classification.empty();
  const auto row = [&](const char* name, const char* each, const char* of_intensity, const char* of_class) {
    bytes.block() +=
        std::string(name) + each + (intensity ? of_intensity : "") + (classes ? of_class : "") + "\n";
  };
  bytes.block() += "# .PCD v0.7\nVERSION 0.7\n";
  row("FIELDS", " x y z", " intensity", " classification");
  row("SIZE", " 8 8 8", " 4", " 1");
  row("TYPE", " F F F", " F", " U");
  row("COUNT", " 1 1 1", " 1", " 1");
  const std::string count = std::to_string(cloud.size());
  bytes.block() +=
      "WIDTH " + count + "\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS " + count + "\nDATA binary\n";
  for (std::size_t i = 0; i < cloud.size(); ++i) put_point_binary(bytes, cloud, i);
  bytes.flush();
}

void write_text(std::ostream& out, const PointCloud& cloud, char delimiter, Progress& progress) {
  Bytes bytes(out, progress);
  const bool intensity = !cloud.intensity.empty();
  const bool classes = !cloud.classification.empty();
  const std::string d(1, delimiter);
  bytes.block() += (delimiter == ' ' ? "# x" : "x") + d + "y" + d + "z" + (intensity ? d + "intensity" : "") +
                   (classes ? d + "classification" : "") + "\n";
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const Vec3 world = cloud.points[i] + cloud.origin_shift;
    for (int k = 0; k < 3; ++k) {
      if (k > 0) bytes.block() += delimiter;
      append_number(bytes.block(), world[k]);
    }
    if (intensity) {
      bytes.block() += delimiter;
      append_number(bytes.block(), static_cast<double>(cloud.intensity[i]));
    }
    if (classes) {
      bytes.block() += delimiter;
      append_number(bytes.block(), std::int64_t{cloud.classification[i]});
    }
    bytes.block() += '\n';
    bytes.flush_if_full();
  }
  bytes.flush();
}

}  // namespace

void check_cloud_format(const std::filesystem::path& path) {
  const std::string extension = lower(path.extension().string());
  constexpr std::array kKnown{".las", ".laz", ".ply", ".pcd", ".xyz", ".txt", ".asc", ".csv"};
  if (std::find(kKnown.begin(), kKnown.end(), extension) == kKnown.end())
    throw IoError(path.string() +
                  ": clouds are written as .las, .laz, .ply, .pcd, .xyz, .txt, .asc or .csv, not '" +
                  extension + "'");
  if (extension == ".laz" && !can_write_laz()) fail_without_laz_writer(path);
}

void write_point_cloud(const std::filesystem::path& path, const PointCloud& cloud,
                       const WriteCloudOptions& options, Progress& progress) {
  cloud.validate();
  check_cloud_format(path);
  if (cloud.empty()) throw InputError(path.string() + ": a point cloud without points is not written");
  const std::string extension = lower(path.extension().string());
  const auto write = [&](auto&& body) {
    AtomicFile file(path);
    body(file.stream());
    file.commit();
  };
  if (extension == ".las")
    return write([&](std::ostream& out) { write_las(out, cloud, options.frame, progress); });
  if (extension == ".laz") {
    AtomicFile plain(path.string() + ".las");  // never committed: gone when the compressed file stands
    write_las(plain.stream(), cloud, options.frame, progress);
    plain.stream().flush();
    return copy_las(plain.temporary_path(), path, Vec3::Zero(), progress);
  }
  if (extension == ".ply") return write([&](std::ostream& out) { write_ply(out, cloud, progress); });
  if (extension == ".pcd") return write([&](std::ostream& out) { write_pcd(out, cloud, progress); });
  if (extension == ".csv") return write([&](std::ostream& out) { write_text(out, cloud, ',', progress); });
  write([&](std::ostream& out) { write_text(out, cloud, ' ', progress); });
}

}  // namespace dendrofit
