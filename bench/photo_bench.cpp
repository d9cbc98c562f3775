// SPDX-License-Identifier: GPL-3.0-or-later
// Photographs a tree that exists as cylinders from a ring of cameras, reconstructs it from them and says how
// near it comes; or writes the photographs for the command line.
//
// usage: photo_bench [--tree QSM.csv | --preset NAME --seed N] [--views N,N,...] [--size WxH] [--focal PX]
//                    [--photos] [--turn-error DEG] [--shift-error M] [--k1 K] [--out DIR] [--threads N]
#include "cli/report/image.h"
#include "core/atomic_file.h"
#include "forward/igm/grow.h"
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

#include "bench/photo_score.h"
#include <nlohmann/json.hpp>
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

void write_views(const fs::path& folder, const ViewSet& set) {
  fs::create_directories(folder);
  nlohmann::ordered_json json = {
      {"format", "dendrofit-cameras"}, {"version", 1}, {"units", "m"}, {"up", {0, 0, 1}}};
  json["origin"] = {set.origin_shift.x(), set.origin_shift.y(), set.origin_shift.z()};
  json["pixel_origin"] = "corner";
  const Camera& first = set.views.front().camera;
  json["cameras"] = nlohmann::ordered_json::array();
  json["cameras"].push_back({{"id", 0},
                             {"model", "radial2"},
                             {"width", first.width},
                             {"height", first.height},
                             {"fx", first.fx},
                             {"fy", first.fy},
                             {"cx", first.cx},
                             {"cy", first.cy},
                             {"k1", first.k1},
                             {"k2", first.k2}});
  json["images"] = nlohmann::ordered_json::array();
  for (const View& view : set.views) {
    nlohmann::ordered_json pose = nlohmann::ordered_json::array();
    for (int r = 0; r < 3; ++r)
      pose.push_back({view.camera.rotation(r, 0), view.camera.rotation(r, 1), view.camera.rotation(r, 2),
                      view.camera.translation[r]});
    const std::string photo = view.photo.name + ".png", mask = "mask_" + view.photo.name.substr(5) + ".png";
    Image image(view.photo.width, view.photo.height, {});
    image.rgb = view.photo.rgb;
    write_png(folder / photo, image);
    for (std::size_t i = 0; i < view.photo.mask.size(); ++i)
      for (std::size_t k = 0; k < 3; ++k) image.rgb[3 * i + k] = view.photo.mask[i];
    write_png(folder / mask, image);
    json["images"].push_back({{"file", photo}, {"mask", mask}, {"camera", 0}, {"camera_from_world", pose}});
  }
  write_file(folder / "cameras.json", json.dump(1) + "\n");
}

}  // namespace

int main(int argc, char** argv) {
  std::string tree_file, preset = "standard", out, counts = "8";
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
    const ViewSet set = test::photograph_ring(truth, ring);
    if (!out.empty()) {
      write_views(fs::path(out) / word, set);
      write_qsm_csv(fs::path(out) / "truth.csv", truth);
    }
    const double begin = cpu_seconds();
    const ViewsReconstruction result = reconstruct_views(set, options);
    const double seconds = cpu_seconds() - begin;
    if (!out.empty()) write_qsm_csv(fs::path(out) / word / "qsm.csv", result.model.tree);
    const bench::PhotoScore s = bench::score_tree(result.model.tree, truth, set);
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    std::printf("%5d %6.3f %6.3f %6.3f %5.3f/%-3d %6.2f %4.1f/%-4.0f %6.3f %6.3f %6.3f %6.3f %7.1f %6ld\n",
                ring.views, s.precision, s.recall, s.f, s.parents, s.parents_tested, 100 * s.height_error,
                1000 * s.dbh_error_m.value_or(-9), 1000 * s.true_dbh_m, s.radius_bias, s.iou,
                s.near_precision, s.near_recall, seconds, usage.ru_maxrss / 1024);
    std::fflush(stdout);
  }
  return 0;
}
