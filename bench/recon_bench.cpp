// SPDX-License-Identifier: GPL-3.0-or-later
// Reconstruction against known trees: grow or draw -> virtual scan -> reconstruct -> score, over made cases
// and any folder of scans with their truth beside them (NAME.las with NAME_truth.csv, as `dendrofit scan`
// writes).
//
// usage: recon_bench [--cases N] [--first K] [--leaf-on] [--folder DIR] [--keep DIR] [--out FILE.csv]
// [--seconds S]
//   --cases N, --first K   made cases K to N (K = 1)
//   --out FILE.csv   one row a case; cases that have a row there are not run again
//   --keep DIR       also keep the made scans and truths there, for --folder
//   --seconds S      start no further case after so many CPU seconds
#include "core/errors.h"
#include "io/read_cloud.h"
#include "io/read_tree.h"
#include "io/write_cloud.h"
#include "io/write_tree.h"
#include "recon/reconstruct.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <limits>
#include <sstream>
#include <string>
#include <vector>

#include "bench/recon_cases.h"
#include "bench/recon_score.h"
#include "bench/recon_truth.h"

namespace {

using namespace dendrofit;
using namespace dendrofit::bench;
namespace fs = std::filesystem;

constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
constexpr std::array<const char*, 4> kIntervals = {"dbh_m", "height_m", "stem_volume_m3", "total_volume_m3"};

/// Columns of a row, in the order of the CSV file.
enum Column {
  points,
  leaf_on,
  height_err_m,
  dbh_err_mm,
  stem_rel,
  branch_rel,
  total_rel,
  over_1cm_rel,
  loose_f,
  strict_f,
  strict_f_thick,
  parents,
  radius_bias,
  leaf_accuracy,
  wood_recall_1cm,
  false_leaf,
  wood_share,
  // for each interval: error over half width, and width over the truth
  off_dbh,
  width_dbh,
  off_height,
  width_height,
  off_stem,
  width_stem,
  off_total,
  width_total,
  cpu_read,
  cpu_neighbours,
  cpu_all,
  column_count
};
constexpr std::array<const char*, column_count> kNames = {
    "points",      "leaf_on",       "height_err_m",    "dbh_err_mm", "stem_rel",       "branch_rel",
    "total_rel",   "over_1cm_rel",  "loose_f",         "strict_f",   "strict_f_thick", "parents",
    "radius_bias", "leaf_accuracy", "wood_recall_1cm", "false_leaf", "wood_share",     "off_dbh",
    "width_dbh",   "off_height",    "width_height",    "off_stem",   "width_stem",     "off_total",
    "width_total", "cpu_read",      "cpu_neighbours",  "cpu_all"};

struct Row {
  std::string name;
  std::array<double, column_count> value;
  Row() { value.fill(kUnknown); }
};

struct Options {
  int cases = 12;
  int first = 1;
  bool leaves = false;
  std::vector<fs::path> folders;
  fs::path keep, out;
  double seconds = 1e9;
};

double cpu_seconds() {
  return static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}

void score_intervals(const TreeMetrics& model, const TreeMetrics& truth, Row& row) {
  const std::array<double, 4> right = {truth.dbh_m.value_or(kUnknown), truth.height_m, truth.stem_volume_m3,
                                       truth.total_volume_m3};
  for (std::size_t k = 0; k < kIntervals.size(); ++k) {
    const auto found = model.intervals.find(kIntervals[k]);
    if (found == model.intervals.end()) continue;
    const Interval& i = found->second;
    const double half = right[k] > i.value ? i.hi - i.value : i.value - i.lo;
    row.value[off_dbh + 2 * k] = (i.value - right[k]) / std::max(half, 1e-12);
    row.value[width_dbh + 2 * k] = (i.hi - i.lo) / right[k];
  }
}

/// Reconstructs and scores one scan. Where no answer is given the row keeps unknown values.
Row judge(const std::string& name, const PointCloud& cloud, double read_seconds, const Tree& truth,
          const PointTruth& by_point) {
  Row row;
  row.name = name;
  auto& v = row.value;
  v[points] = static_cast<double>(cloud.size());
  v[cpu_read] = read_seconds;
  Reconstruction r;
  try {
    r = reconstruct(cloud, {.threads = 1});
  } catch (const SolverError& e) {
    std::fprintf(stderr, "%s: no answer: %s\n", name.c_str(), e.what());
    return row;
  }
  const TreeMetrics right = measure(truth);
  const AxisScore axes = score_axes(r.tree, truth, by_point.hits);
  v[leaf_on] = r.leaf_on;
  v[height_err_m] = r.metrics.height_m - right.height_m;
  if (r.metrics.dbh_m && right.dbh_m) v[dbh_err_mm] = 1000 * (*r.metrics.dbh_m - *right.dbh_m);
  v[stem_rel] = r.metrics.stem_volume_m3 / right.stem_volume_m3 - 1;
  v[branch_rel] = r.metrics.branch_volume_m3 / right.branch_volume_m3 - 1;
  v[total_rel] = r.metrics.total_volume_m3 / right.total_volume_m3 - 1;
  v[over_1cm_rel] = axes.volume_1cm / axes.true_volume_1cm - 1;
  v[loose_f] = axes.loose_f;
  v[strict_f] = axes.strict_f;
  v[strict_f_thick] = axes.strict_f_thick;
  v[parents] = axes.parent_agreement;
  v[radius_bias] = axes.radius_bias;
  v[wood_share] = r.wood_share;
  if (!by_point.leaf.empty()) {
    const LeafScore leaves =
        score_leaves(cloud, by_point.leaf, by_point.radius, r.leaf_points, ReconstructOptions{}.voxel_size_m);
    v[leaf_accuracy] = leaves.accuracy;
    v[wood_recall_1cm] = leaves.wood_recall_1cm;
    v[false_leaf] = leaves.false_leaf;
  }
  score_intervals(r.metrics, right, row);
  v[cpu_all] = 0;
  std::fprintf(stderr, "%s: leafy places %.3f, straight paths %.3f;", name.c_str(), r.leafy_share,
               r.straight_share);
  for (const StageTime& s : r.stages) {
    v[cpu_all] += s.cpu_seconds;
    if (s.stage == "neighbours") v[cpu_neighbours] = s.cpu_seconds;
    std::fprintf(stderr, "  %s %.2f", s.stage.c_str(), s.cpu_seconds);
  }
  std::fprintf(stderr, "\n");
  return row;
}

/// Through a file and back, so that reading is measured too and coordinates are those of a scan.
PointCloud written_and_read(const fs::path& file, const PointCloud& cloud, double& seconds) {
  write_point_cloud(file, cloud);
  const double begin = cpu_seconds();
  PointCloud read = read_point_cloud(file);
  seconds = cpu_seconds() - begin;
  return read;
}

Row run_made(const Case& c, const Options& options) {
  const Tree tree = tree_of(c);
  const VirtualScan scan = scan_of(c, tree);
  const fs::path folder = options.keep.empty() ? fs::temp_directory_path() : options.keep;
  const fs::path file = folder / (c.name + ".las");
  double seconds = 0;
  const PointCloud cloud = written_and_read(file, scan.cloud, seconds);
  if (options.keep.empty())
    fs::remove(file);
  else
    write_qsm_csv(folder / (c.name + "_truth.csv"), tree);
  return judge(c.name, cloud, seconds, tree, truth_of(scan, tree));
}

Row run_file(const fs::path& file, const fs::path& truth) {
  const double begin = cpu_seconds();
  const PointCloud cloud = read_point_cloud(file);
  const double seconds = cpu_seconds() - begin;
  const Tree tree = read_tree(truth);
  return judge(file.stem().string(), cloud, seconds, tree, truth_from_classes(cloud, tree));
}

std::vector<Row> rows_in(const fs::path& file) {
  std::vector<Row> rows;
  std::ifstream in(file);
  std::string line;
  std::getline(in, line);
  while (std::getline(in, line)) {
    std::istringstream fields(line);
    Row row;
    std::getline(fields, row.name, ',');
    std::string field;
    for (double& value : row.value)
      if (std::getline(fields, field, ','))
        value = field.empty() ? kUnknown : std::strtod(field.c_str(), nullptr);
    rows.push_back(row);
  }
  return rows;
}

void append(const fs::path& file, const Row& row) {
  const bool fresh = !fs::exists(file);
  std::ofstream out(file, std::ios::app);
  if (fresh) {
    out << "name";
    for (const char* name : kNames) out << ',' << name;
    out << '\n';
  }
  out << row.name;
  for (const double value : row.value) {
    out << ',';
    if (!std::isnan(value)) out << value;
  }
  out << '\n';
}

std::vector<double> known(const std::vector<Row>& rows, int column) {
  std::vector<double> values;
  for (const Row& row : rows)
    if (!std::isnan(row.value[static_cast<std::size_t>(column)]))
      values.push_back(row.value[static_cast<std::size_t>(column)]);
  std::sort(values.begin(), values.end());
  return values;
}

double quantile(const std::vector<double>& sorted, double share) {
  if (sorted.empty()) return kUnknown;
  return sorted[static_cast<std::size_t>(std::lround(share * static_cast<double>(sorted.size() - 1)))];
}

void print_summary(const std::vector<Row>& rows) {
  std::printf("\n%-16s %5s %9s %9s %9s %9s %9s\n", "over all cases", "n", "10 %", "median", "90 %", "mean",
              "rms");
  for (int c = 0; c < column_count; ++c) {
    const std::vector<double> values = known(rows, c);
    if (values.empty()) continue;
    double sum = 0, square = 0;
    for (const double x : values) sum += x, square += x * x;
    const auto n = static_cast<double>(values.size());
    std::printf("%-16s %5zu %9.4g %9.4g %9.4g %9.4g %9.4g\n", kNames[static_cast<std::size_t>(c)],
                values.size(), quantile(values, 0.1), quantile(values, 0.5), quantile(values, 0.9), sum / n,
                std::sqrt(square / n));
  }
  std::printf("\n95 %% intervals: share that hold the truth, median width over the truth\n");
  for (std::size_t k = 0; k < kIntervals.size(); ++k) {
    const std::vector<double> off = known(rows, off_dbh + 2 * static_cast<int>(k));
    const auto inside = std::count_if(off.begin(), off.end(), [](double x) { return std::abs(x) <= 1; });
    std::printf(
        "  %-16s %ld of %zu = %.1f %%, width %.1f %%\n", kIntervals[k], static_cast<long>(inside), off.size(),
        100.0 * static_cast<double>(inside) / static_cast<double>(std::max<std::size_t>(1, off.size())),
        100 * quantile(known(rows, width_dbh + 2 * static_cast<int>(k)), 0.5));
  }
  std::vector<double> ratio;
  for (const Row& row : rows)
    if (!std::isnan(row.value[cpu_all]))
      ratio.push_back((row.value[cpu_read] + row.value[cpu_all]) /
                      std::max(1e-9, row.value[cpu_read] + row.value[cpu_neighbours]));
  std::sort(ratio.begin(), ratio.end());
  std::printf("CPU time over reading and one neighbour pass: median %.2f\n", quantile(ratio, 0.5));
}

Options parse(int argc, char** argv) {
  Options options;
  for (int i = 1; i < argc; ++i) {
    const std::string key = argv[i];
    if (key == "--leaf-on") {
      options.leaves = true;
      continue;
    }
    if (i + 1 == argc) throw InputError(key + ": needs a value, or is no option");
    const char* text = argv[++i];
    if (key == "--cases")
      options.cases = std::atoi(text);
    else if (key == "--first")
      options.first = std::atoi(text);
    else if (key == "--folder")
      options.folders.emplace_back(text);
    else if (key == "--keep")
      options.keep = text;
    else if (key == "--out")
      options.out = text;
    else if (key == "--seconds")
      options.seconds = std::atof(text);
    else
      throw InputError(key + ": no such option");
  }
  if (!options.folders.empty() && options.cases == Options{}.cases) options.cases = 0;
  return options;
}

int run(const Options& options) {
  std::vector<Row> rows = options.out.empty() ? std::vector<Row>{} : rows_in(options.out);
  const auto is_done = [&](const std::string& name) {
    return std::any_of(rows.begin(), rows.end(), [&](const Row& r) { return r.name == name; });
  };
  const auto take = [&](const Row& row) {
    rows.push_back(row);
    if (!options.out.empty()) append(options.out, row);
    std::printf(
        "%-18s height %+.3f m  DBH %+.1f mm  stem %+.1f %%  branches %+.1f %%  F %.3f strict %.3f  leaves "
        "%.3f\n",
        row.name.c_str(), row.value[height_err_m], row.value[dbh_err_mm], 100 * row.value[stem_rel],
        100 * row.value[branch_rel], row.value[loose_f], row.value[strict_f], row.value[leaf_accuracy]);
    std::fflush(stdout);
  };
  std::vector<Case> cases = made_cases(options.cases, options.leaves);
  cases.erase(cases.begin(), cases.begin() + std::clamp(options.first - 1, 0, options.cases));
  for (const Case& c : cases) {
    if (is_done(c.name) || cpu_seconds() > options.seconds) continue;
    take(run_made(c, options));
  }
  for (const fs::path& folder : options.folders) {
    std::vector<fs::path> files;
    for (const auto& entry : fs::directory_iterator(folder)) files.push_back(entry.path());
    std::sort(files.begin(), files.end());
    for (const fs::path& file : files) {
      const fs::path truth = file.parent_path() / (file.stem().string() + "_truth.csv");
      if (!fs::exists(truth) || file == truth || file.extension() == ".toml" || file.extension() == ".json")
        continue;
      if (is_done(file.stem().string()) || cpu_seconds() > options.seconds) continue;
      take(run_file(file, truth));
    }
  }
  print_summary(rows);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return run(parse(argc, argv));
  } catch (const std::exception& e) {
    std::fprintf(stderr, "recon_bench: %s\n", e.what());
    return 3;
  }
}
