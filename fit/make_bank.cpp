// SPDX-License-Identifier: GPL-3.0-or-later
// Makes the bank of prior simulations that `dendrofit fit` starts from; see scripts/make_bank.
// usage: make_bank OUTPUT WORK_FILE DRAWS [THREADS]
#include "core/atomic_file.h"
#include "core/errors.h"
#include "core/parallel.h"
#include "fit/descriptors.h"
#include "fit/prior_bank.h"

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include <sys/resource.h>

namespace {

using namespace dendrofit;

constexpr std::size_t kBlock = 32;  // draws between two savings of the work file

std::string read_all(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

/// The work file: the stamp, then whole draws in single precision. Draws of another model are thrown away.
std::string stamp_bytes(const std::vector<float>& stamp) {
  return {reinterpret_cast<const char*>(stamp.data()), stamp.size() * sizeof(float)};
}

double cpu_seconds() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_utime.tv_sec) + 1e-6 * static_cast<double>(usage.ru_utime.tv_usec);
}

void make(const std::filesystem::path& output, const std::filesystem::path& work, std::size_t draws,
          int threads) {
  const std::vector<float> stamp = model_stamp();
  const std::size_t columns = descriptor_table().size() * kVisibleShares.size();
  const std::size_t row_bytes = columns * sizeof(float);
  const std::string head = stamp_bytes(stamp);
  std::string kept = read_all(work);
  if (!kept.starts_with(head)) {
    if (!kept.empty()) std::fprintf(stderr, "make_bank: the model has changed; starting anew\n");
    kept = head;
  }
  const std::size_t old = (kept.size() - head.size()) / row_bytes;
  kept.resize(head.size() + old * row_bytes);
  for (std::size_t done = old; done < draws;) {
    const std::size_t block = std::min(kBlock, draws - done);
    std::string rows(block * row_bytes, '\0');
    parallel_blocks(block, 1, threads, [&](std::size_t first, std::size_t) {
      const std::vector<double> values = simulate_draw(done + first);
      std::vector<float> row(values.begin(), values.end());
      std::memcpy(rows.data() + first * row_bytes, row.data(), row_bytes);
    });
    kept += rows;
    done += block;
    write_file(work, kept);
    std::fprintf(stderr, "\rmake_bank: %zu of %zu draws, %.2f CPU s a draw", done, draws,
                 cpu_seconds() / static_cast<double>(done - old));
  }
  std::fprintf(stderr, "\n");
  PriorBank bank;
  bank.stamp = stamp;
  using Rows = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  Rows rows(static_cast<Eigen::Index>(draws), static_cast<Eigen::Index>(columns));
  if ((kept.size() - head.size()) / row_bytes < draws) throw IoError(work.string() + ": was cut off");
  std::memcpy(rows.data(), kept.data() + head.size(), draws * row_bytes);
  bank.descriptors = rows;
  std::fprintf(stderr, "make_bank: measuring the noise between seeds\n");
  bank.noise = measure_seed_noise(bank.descriptors, threads);
  write_file(output, encode_bank(bank));
}

}  // namespace

int main(int argc, char** argv) {
  try {
    if (argc < 4) {
      std::fprintf(stderr, "usage: make_bank OUTPUT WORK_FILE DRAWS [THREADS]\n");
      return 2;
    }
    make(argv[1], argv[2], std::stoul(argv[3]), argc > 4 ? std::stoi(argv[4]) : 0);
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "make_bank: %s\n", error.what());
    return 3;
  }
}
