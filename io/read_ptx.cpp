// SPDX-License-Identifier: GPL-3.0-or-later
// PTX: one or more gridded scans, each with its scanner's place and the matrix that takes it to common
// coordinates.
#include "io/cloud_formats.h"
#include "io/csv_table.h"
#include "io/text_numbers.h"

#include <array>
#include <cmath>

namespace dendrofit {
namespace {

class Lines {
 public:
  explicit Lines(const FileBytes& bytes)
      : bytes_(bytes), at_(bytes.view().starts_with("\xef\xbb\xbf") ? 3 : 0) {}

  bool at_end() {
    while (at_ < bytes_.size() &&
           std::string_view(" \t\r\n").find(bytes_.view()[at_]) != std::string_view::npos)
      if (bytes_.view()[at_++] == '\n') ++line_;
    return at_ >= bytes_.size();
  }

  // Numbers of the next line into `values` (at most its size); the number of them, or -1 for a word among
  // them.
  template <std::size_t n>
  int next(std::array<double, n>& values) {
    const std::string_view view = bytes_.view();
    const std::size_t end = std::min(view.find('\n', at_), view.size());
    const char* p = view.data() + at_;
    const char* const stop = view.data() + end;
    at_ = std::min(end + 1, view.size());
    ++line_;
    int count = 0;
    while (true) {
      while (p != stop && (*p == ' ' || *p == '\t' || *p == '\r')) ++p;
      if (p == stop) return count;
      if (count == static_cast<int>(n)) return count + 1;
      p = parse_number(p, stop, values[static_cast<std::size_t>(count)]);
      if (!p || (p != stop && *p != ' ' && *p != '\t' && *p != '\r')) return -1;
      ++count;
    }
  }
  [[noreturn]] void fail(const std::string& what) const { fail_at_line(bytes_.path(), line_, what); }
  std::size_t bytes_left() const { return bytes_.size() - at_; }

 private:
  const FileBytes& bytes_;
  std::size_t at_;
  std::size_t line_ = 0;
};

bool is_whole(double value) {
  return value >= 0 && value <= 1e9 && value == std::floor(value);
}

}  // namespace

bool is_ptx(const FileBytes& bytes) {
  if (bytes.view().substr(0, 4096).find('\0') != std::string_view::npos) return false;
  Lines lines(bytes);
  std::array<double, 7> v{};
  for (const int expected : {1, 1, 3, 3, 3, 3, 4, 4, 4, 4}) {
    if (lines.at_end() || lines.next(v) != expected) return false;
    if (expected == 1 && !is_whole(v[0])) return false;
  }
  return true;
}

PointCloud read_ptx(const FileBytes& bytes, Progress& progress) {
  require_text(bytes);
  Lines lines(bytes);
  PointCloud cloud;
  PointTicker ticker(progress, "reading", 0);
  while (!lines.at_end()) {
    std::array<double, 7> v{};
    std::array<double, 2> grid{};
    for (double& extent : grid) {
      if (lines.next(v) != 1 || !is_whole(v[0])) lines.fail("a scan's number of columns or rows expected");
      extent = v[0];
    }
    const double claimed = grid[0] * grid[1];
    if (claimed > static_cast<double>(lines.bytes_left()) / 2)
      lines.fail("a scan of " + std::to_string(static_cast<std::uint64_t>(claimed)) +
                 " points claimed where the file has too few bytes left; it is truncated");
    for (int k = 0; k < 4; ++k)
      if (lines.at_end() || lines.next(v) != 3)
        lines.fail("three numbers expected: the scanner's place and axes");
    Eigen::Matrix4d to_common;
    for (int k = 0; k < 4; ++k) {
      if (lines.at_end() || lines.next(v) != 4)
        lines.fail("four numbers expected: a row of the scan's matrix");
      for (int j = 0; j < 4; ++j) to_common(k, j) = v[static_cast<std::size_t>(j)];
    }
    if (!to_common.allFinite()) lines.fail("the scan's matrix holds what is not a finite number");
    // Points are rows: world = [x y z 1] * matrix, so the shift is its last row.
    const Eigen::Matrix3d turn = to_common.topLeftCorner<3, 3>().transpose();
    const Vec3 shift = to_common.row(3).head<3>().transpose();
    cloud.scanner_positions.push_back(shift);
    const auto count = static_cast<std::uint64_t>(claimed);
    for (std::uint64_t i = 0; i < count; ++i) {
      if (lines.at_end())
        lines.fail("the scan has " + std::to_string(count) + " points, the file ends after " +
                   std::to_string(i) + "; it is truncated");
      const int n = lines.next(v);
      if (n != 3 && n != 4 && n != 7) lines.fail("x y z [intensity [red green blue]] expected");
      ticker.tick();
      if (v[0] == 0 && v[1] == 0 && v[2] == 0) continue;  // no return
      const Vec3 p(v[0], v[1], v[2]);
      if (!p.allFinite()) lines.fail("a coordinate that is not a finite number; remove the point");
      cloud.points.push_back(turn * p + shift);
      cloud.intensity.push_back(n > 3 ? static_cast<float>(v[3]) : 0.0f);
    }
  }
  return cloud;
}

}  // namespace dendrofit
