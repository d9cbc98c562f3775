// SPDX-License-Identifier: GPL-3.0-or-later
// Photographs a tree that exists as cylinders from a ring of cameras, reconstructs it from them and says how
// near it comes; or writes the photographs for the command line; or takes photographs written before.
//
// usage: photo_bench [--tree QSM.csv | --preset NAME --seed N --cycles N] [--views N,N,...] [--size WxH]
//                    [--focal PX] [--photos] [--turn-error DEG] [--shift-error M] [--k1 K] [--out DIR]
//                    [--images cameras.json] [--threads N]
// --photos: without the masks.
#include "forward/igm/grow.h"
#include "io/read_cameras.h"
#include "io/read_tree.h"
#include "io/write_tree.h"
#include "recon/reconstruct_views.h"
#include "tests/support/photo_render.h"

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <string>

#include "bench/photo_files.h"
#include "bench/photo_score.h"
#include <sys/resource.h>

namespace {

using namespace dendrofit;
namespace fs = std::filesystem;

double cpu_seconds() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_utime.tv_sec + usage.ru_stime.tv_sec) +
         1e-6 * static_cast<double>(usage.ru_utime.tv_usec + usage.ru_stime.tv_usec);
}

}  // namespace

int main(int argc, char** argv) {
  std::string tree_file, preset = "standard", out, images, counts = "8";
  std::uint64_t seed = 1;
  int cycles = 0;
  test::RingOptions ring;
  ring.render.photograph = false;
  ViewsOptions options;
  for (int i = 1; i < argc; ++i) {
    const std::string key = argv[i];
    const auto value = [&] { return i + 1 < argc ? argv[++i] : ""; };
    if (key == "--tree")
      tree_file = value();
    else if (key == "--preset")
      preset = value();
    else if (key == "--seed")
      seed = std::strtoull(value(), nullptr, 10);
    else if (key == "--cycles")
      cycles = std::atoi(value());
    else if (key == "--views")
      counts = value();
    else if (key == "--size")
      std::sscanf(value(), "%dx%d", &ring.width, &ring.height);
    else if (key == "--focal")
      ring.focal_px = std::atof(value());
    else if (key == "--k1")
      ring.k1 = std::atof(value());
    else if (key == "--photos")
      ring.render.photograph = true;
    else if (key == "--turn-error")
      ring.turn_error_deg = std::atof(value());
    else if (key == "--shift-error")
      ring.shift_error_m = std::atof(value());
    else if (key == "--out")
      out = value();
    else if (key == "--images")
      images = value();
    else if (key == "--threads")
      ring.render.threads = options.cloud.threads = std::atoi(value());
    else
      return std::fprintf(stderr, "unknown option %s\n", key.c_str()), 2;
  }
  Tree truth;
  if (tree_file.empty()) {
    IgmParameters parameters = igm_preset(preset).parameters;
    if (cycles > 0) parameters.cycles = cycles;
    truth = grow_igm(parameters, {}, {.seed = seed}).tree;
  } else {
    truth = read_tree(tree_file);
  }
  ring.render.seed = seed;
  std::printf("%zu cylinders, %.2f m tall\n", truth.size(), measure(truth).height_m);
  std::printf("%5s %6s %6s %6s %8s %7s %8s %7s %6s %6s %6s %7s %6s\n", "views", "prec", "recall", "F",
              "parents", "height%", "dbh mm", "r bias", "IoU", "p 1px", "r 1px", "CPU s", "MB");
  for (char* word = std::strtok(counts.data(), ","); word; word = std::strtok(nullptr, ",")) {
    ring.views = std::atoi(word);
    const ViewSet set = images.empty() ? test::photograph_ring(truth, ring) : read_cameras_json(images);
    if (!out.empty() && images.empty()) {
      bench::write_views(fs::path(out) / word, set);
      write_qsm_csv(fs::path(out) / "truth.csv", truth);
    }
    ViewSet given = set;
    if (ring.render.photograph)  // the masks are the truth here
      for (View& view : given.views) view.photo.mask.clear();
    const double begin = cpu_seconds();
    ViewsReconstruction result;
    try {
      result = reconstruct_views(given, options);
    } catch (const std::exception& error) {
      std::printf("%5d %s\n", ring.views, error.what());
      continue;
    }
    const double seconds = cpu_seconds() - begin;
    for (const std::string& warning : result.model.warnings) std::fprintf(stderr, "%s\n", warning.c_str());
    if (!out.empty()) {
      fs::create_directories(fs::path(out) / word);
      write_qsm_csv(fs::path(out) / word / "qsm.csv", result.model.tree);
    }
    const bench::PhotoScore s = bench::score_tree(result.model.tree, truth, set);
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    std::printf("%5d %6.3f %6.3f %6.3f %5.3f/%-3d %6.2f %4.1f/%-4.0f %6.3f %6.3f %6.3f %6.3f %7.1f %6ld\n",
                static_cast<int>(set.views.size()), s.precision, s.recall, s.f, s.parents, s.parents_tested,
                100 * s.height_error, 1000 * s.dbh_error_m.value_or(-9), 1000 * s.true_dbh_m, s.radius_bias,
                s.iou, s.near_precision, s.near_recall, seconds, usage.ru_maxrss / 1024);
    std::fflush(stdout);
  }
  return 0;
}
