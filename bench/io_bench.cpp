// SPDX-License-Identifier: GPL-3.0-or-later
// Throughput of the cloud readers on one core: points (lines) a CPU second, median of five readings of a file
// that lies in the page cache.  usage: io_bench [POINTS] [FILE...]   without files: made here, in the
// temporary folder
#include "core/random.h"
#include "io/read_cloud.h"
#include "io/write_cloud.h"
#include "tests/io/e57_sample.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <sys/resource.h>

using namespace dendrofit;

namespace {

/// Of this process and of the helpers it waited for (LAZ without the LASzip library).
double cpu_seconds() {
  double sum = 0;
  for (const int who : {RUSAGE_SELF, RUSAGE_CHILDREN}) {
    rusage use{};
    getrusage(who, &use);
    for (const timeval& t : {use.ru_utime, use.ru_stime})
      sum += static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
  }
  return sum;
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

/// The same points as millimetres in scaled integers of 15 bits, as scanners' programs write them.
void write_e57(const std::filesystem::path& path, const PointCloud& cloud) {
  std::vector<std::int64_t> millimetres[3];
  for (const Vec3& p : cloud.points)
    for (int k = 0; k < 3; ++k) millimetres[k].push_back(std::llround(1000 * p[k]));
  std::vector<test::E57Sample::Stream> streams;
  for (int k = 0; k < 3; ++k)
    streams.push_back(test::E57Sample::integers(std::string("cartesian") + "XYZ"[k], millimetres[k], 0, 25000,
                                                "scale=\"0.001\""));
  test::E57Sample sample;
  sample.add_scan(cloud.size(), streams, test::E57Sample::pose(1, 0, 0, 0, cloud.origin_shift), 20000);
  std::ofstream(path, std::ios::binary) << sample.file();
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
  write_e57(folder / "cloud.e57", cloud);
  measure(folder / "cloud.e57");
  std::filesystem::remove_all(folder);
}
