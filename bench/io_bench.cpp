// SPDX-License-Identifier: GPL-3.0-or-later
// Throughput of the cloud readers on one core: points (lines) a CPU second, median of five readings of a file
// that lies in the page cache.  usage: io_bench [POINTS] [FILE...]   without files: made here, in the
// temporary folder
#include "core/random.h"
#include "io/read_cloud.h"
#include "io/write_cloud.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <string>
#include <vector>

using namespace dendrofit;

namespace {

double cpu_seconds() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

void measure(const std::filesystem::path& path) {
  std::vector<double> seconds;
  std::size_t points = 0;
  for (int i = 0; i < 6; ++i) {
    const double begin = cpu_seconds();
    points = read_point_cloud(path).size();
    if (i > 0) seconds.push_back(cpu_seconds() - begin);  // the first reading fills the page cache
  }
  std::sort(seconds.begin(), seconds.end());
  const double median = seconds[seconds.size() / 2];
  std::printf("%-12s %9zu points  %6.1f MB  %7.3f s  %6.2f M points/s\n", path.filename().c_str(), points,
              1e-6 * static_cast<double>(std::filesystem::file_size(path)), median,
              1e-6 * static_cast<double>(points) / median);
}

}  // namespace

int main(int count, char** words) {
  const std::size_t points = count > 1 ? std::strtoull(words[1], nullptr, 10) : 2'000'000;
  if (count > 2) {
    for (int i = 2; i < count; ++i) measure(words[i]);
    return 0;
  }
  Random random(1);
  PointCloud cloud;
  cloud.origin_shift = Vec3(500000, 5400000, 300);
  for (std::size_t i = 0; i < points; ++i) {
    const auto millimetres = [&](double reach) { return std::round(random.uniform(0, reach) * 1000) / 1000; };
    cloud.points.emplace_back(millimetres(20), millimetres(20), millimetres(25));
  }
  const std::filesystem::path folder = std::filesystem::temp_directory_path() / "dendrofit_io_bench";
  std::filesystem::create_directories(folder);
  for (const char* name : {"cloud.las", "cloud.ply", "cloud.pcd", "cloud.xyz", "cloud.csv"}) {
    write_point_cloud(folder / name, cloud);
    measure(folder / name);
  }
  std::filesystem::remove_all(folder);
}
