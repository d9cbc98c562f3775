// SPDX-License-Identifier: GPL-3.0-or-later
// One reader for each cloud format; read_point_cloud() chooses among them. All return world coordinates with
// shift 0; settle_cloud() then makes them local.
#pragma once

#include "core/point_cloud.h"
#include "core/progress.h"
#include "io/file_bytes.h"
#include "io/read_cloud.h"

#include <cstdint>
#include <string>
#include <string_view>

namespace dendrofit {

enum class CloudFormat { las, laz, ply, pcd, ptx, e57, text };

/// "las", "laz", "ply", "pcd", "ptx", "e57" or "xyz".
std::string_view to_string(CloudFormat format);
/// By content. Throws IoError for binary content of no known kind.
CloudFormat cloud_format_of(const FileBytes& bytes);

PointCloud read_las(const FileBytes& bytes, Progress& progress);
PointCloud read_laz(const FileBytes& bytes, Progress& progress);
PointCloud read_ply_cloud(const FileBytes& bytes, Progress& progress);
PointCloud read_pcd(const FileBytes& bytes, Progress& progress);
bool is_ptx(const FileBytes& bytes);
PointCloud read_ptx(const FileBytes& bytes, Progress& progress);
PointCloud read_e57(const FileBytes& bytes, Progress& progress);
PointCloud read_text_cloud(const FileBytes& bytes, const ReadCloudOptions& options, Progress& progress);

/// Chooses the origin shift (near the median of 101 points spread over the file) and subtracts it. Throws
/// IoError for a cloud without points or with a coordinate beyond 10^9 m.
void settle_cloud(const FileBytes& bytes, PointCloud& cloud);

/// Calls progress.check() and advance() once every so many points.
class PointTicker {
 public:
  PointTicker(Progress& progress, std::string_view stage, double total) : progress_(progress) {
    progress_.begin(stage, total, "points");
  }
  void tick() {
    if (++count_ % kStep == 0) report();
  }

 private:
  static constexpr std::uint64_t kStep = 1 << 18;
  void report() {
    progress_.advance(kStep);
    progress_.check();
  }
  Progress& progress_;
  std::uint64_t count_ = 0;
};

}  // namespace dendrofit
