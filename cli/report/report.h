// SPDX-License-Identifier: GPL-3.0-or-later
// report.html: what a run found, in one file that opens offline by double click and asks no network for
// anything.
#pragma once

#include "core/foliage.h"
#include "core/metrics.h"
#include "core/point_cloud.h"
#include "core/progress.h"
#include "core/tree.h"

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace dendrofit {

/// One fitted (or fixed) parameter of the growth model.
struct ReportParameter {
  std::string key;
  std::string symbol;
  std::string unit;
  std::string meaning;
  double value = 0;
  std::optional<double> lo;  ///< 90 % interval of the fit
  std::optional<double> hi;
  std::optional<double> prior_lo;  ///< bounds (or prior interval) before the fit
  std::optional<double> prior_hi;
  bool identifiable = true;  ///< false: the data do not tell this value from others
  bool fixed = false;        ///< not fitted: given or default
};

/// A quantity over growth cycles (or years). Vectors are empty or as long as `time`.
struct ReportCurve {
  std::string name;  ///< "height", ...
  std::string value_unit = "m";
  std::string time_unit = "cycle";
  std::vector<double> time;
  std::vector<double> value;  ///< of the regrown tree
  std::vector<double> cap;    ///< what the growth equation allows to be added each cycle
  std::vector<double> lo;     ///< band about `value`
  std::vector<double> hi;
  std::vector<std::pair<double, double>>
      measured;                    ///< (time, value) points, e.g. the scan's height at its age
  std::string band = "95 % band";  ///< what the band is
};

/// How far the regrown tree is from the scanned one, by descriptor; 0 = the same.
struct ReportDescriptor {
  std::string name;
  std::optional<double> before;  ///< at the start of the fit
  double after = 0;
};

struct ReportStage {
  std::string name;
  double seconds = 0;
};

/// How the run was made.
struct ReportProvenance {
  std::string program = "dendrofit";
  std::string version;
  std::optional<std::uint64_t> seed;
  std::string command_line;
  std::string input_name;
  std::string input_checksum;  ///< with its kind: "sha256:..."
  std::string crs;             ///< coordinate system of the input, as it states it
  std::vector<std::pair<std::string, std::string>> options;
  std::vector<ReportStage> stages;
};

/// Everything may be absent (null, empty) but the title; the report then leaves the section out or says so.
/// Pointers are borrowed for the call. Text may hold any characters; it is escaped.
struct ReportData {
  std::string title;                       ///< the tree's or file's name
  const PointCloud* scan = nullptr;        ///< of any size; thinned here
  std::optional<std::size_t> scan_points;  ///< of the file, where `scan` was already thinned
  const Tree* model = nullptr;             ///< reconstructed from the scan
  const Tree* regrown = nullptr;           ///< by the growth model; birth_cycle drives the growth slider
  const Foliage* foliage = nullptr;
  bool leaves_on_model = false;  ///< leaves stand on the model rather than on the regrown tree
  const TreeMetrics* model_metrics = nullptr;
  const TreeMetrics* regrown_metrics = nullptr;
  /// Stem diameters measured on the scan itself; where empty, the model's stem cylinders of measured radius
  /// stand for them.
  std::vector<TaperPoint> measured_taper;
  std::string growth_model;  ///< "IGM, logistic equation"
  std::string fit_status;    ///< plain words: converged or why it stopped
  std::vector<ReportParameter> parameters;
  std::vector<ReportCurve> curves;
  std::vector<ReportDescriptor> descriptors;
  std::vector<std::pair<double, double>> cost_by_evaluation;    ///< (evaluation, best cost so far)
  std::vector<std::pair<std::string, std::string>> leaf_facts;  ///< e.g. ("Leaf area", "34.2 m2")
  std::vector<std::string> warnings;                            ///< plain words
  std::string side_by_side_png;  ///< bytes of the picture; empty: none in the report
  std::string overlay_png;       ///< bytes of the model drawn over its photograph; empty: no photograph
  ReportProvenance provenance;
};

struct ReportOptions {
  int max_scan_points = 700'000;  ///< in the 3-D view
  int max_leaves = 120'000;       ///< in the 3-D view
  void validate() const;
};

/// The whole page. Same data, same bytes. Throws InputError for options out of range, broken trees or vectors
/// of unequal length.
std::string make_report(const ReportData& data, const ReportOptions& options = {},
                        Progress& progress = no_progress());

/// Whether the 3-D view was built in (needs Node.js and npm at build time). A report made without it says so.
bool has_viewer();

}  // namespace dendrofit
