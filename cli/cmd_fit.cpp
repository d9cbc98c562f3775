// SPDX-License-Identifier: GPL-3.0-or-later
// dendrofit fit SCAN|PHOTO|qsm.csv... -o DIR
#include "cli/commands.h"
#include "cli/fit_report.h"
#include "cli/fit_settings.h"
#include "cli/observed_tree.h"
#include "cli/output_folder.h"
#include "cli/parse.h"
#include "cli/report_file.h"
#include "cli/tree_files.h"
#include "cli/version.h"
#include "core/atomic_file.h"
#include "core/errors.h"
#include "fit/fit_trees.h"
#include "fit/tree_simulator.h"
#include "forward/virtual_scan/virtual_scan.h"
#include "io/file_info.h"
#include "io/metrics_json.h"

#include <algorithm>
#include <fstream>
#include <iterator>
#include <optional>
#include <vector>

#include <fmt/format.h>

namespace dendrofit::cli {
namespace {

namespace fs = std::filesystem;

constexpr const char* kCheckpoint = "fit.checkpoint";

std::string read_bytes(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

class Fit : public Command {
 public:
  void declare(OptionTable& options) override {
    options.positionals(
        "TREE", inputs_,
        "Scan or photograph of a tree, its model (qsm.csv or any QSM format), or a folder with "
        "qsm.csv; several trees of one kind are fitted together",
        false);
    options.path("--output", output_, "Folder for the results", "-o");
    fit_.declare(options);
    options.flag("--resume", resume_,
                 "Go on with an interrupted fit: the same command, with the same output folder");
    options.flag("--through-scan", through_scan_,
                 "Compare grown trees as a virtual scanner and the reconstruction see them (slow)");
    reconstruct_.declare(options);
    photo_.declare(options);
  }

  int run(Session& session) override {
    need_output(output_);
    const fs::path input = inputs_.empty() ? fs::path() : tree_file(inputs_.front());
    photo_.check(input);
    if (photo_.asked_for(input)) reconstruct_.check_for_photographs();
    FitOptions options = fit_.resolve(session);
    if (inputs_.size() > 1) return run_several(session, options);
    std::optional<Tree> model;
    if (!photo_.asked_for(input)) model = describe_file(input, session.progress()).tree;
    const fs::path folder = prepare_folder(session);
    const fs::path checkpoint = folder / kCheckpoint;
    if (resume_) options.resume_from = read_bytes(checkpoint);
    options.on_checkpoint = [&](std::string_view bytes) { write_file(checkpoint, bytes); };
    std::vector<fs::path> inputs = {input};
    if (!model) {
      ObservedTree seen = observe_tree(session, input, reconstruct_, photo_, folder, {});
      if (seen.one_view) options.observed_from = ObservedFrom::one_view;
      options.dbh_m = seen.model.metrics.dbh_m;
      inputs = seen.inputs;
      model = std::move(seen.model.tree);
    }
    const Tree& observed = *model;

    if (through_scan_) options.observe = observer(session, measure(observed).height_m);
    const TreeFit fit = fit_or_say_how_to_resume(session, observed, options, checkpoint);
    write_results(session, folder, inputs.front(), fit);
    for (const fs::path& other : fit_.inputs()) inputs.push_back(other);
    write_file(folder / "run.toml", run_record(session, inputs));
    fs::remove(checkpoint);

    session.json(fit_json(fit));
    say_fit(session, fit);
    session.say("Written to " + folder.string() + ": fit.json, params.toml, regrown/qsm.csv");
    return 0;
  }

 private:
  static TreeFit fit_or_say_how_to_resume(Session& session, const Tree& observed, const FitOptions& options,
                                          const fs::path& checkpoint) {
    try {
      return fit_tree(observed, options, session.progress());
    } catch (const Cancelled&) {
      if (fs::exists(checkpoint))
        session.warn("the same command with --resume goes on from " + checkpoint.string());
      throw;
    }
  }

  int run_several(Session& session, const FitOptions& options) const {
    if (resume_ || through_scan_) throw UsageError("--resume and --through-scan: for one tree at a time");
    const fs::path folder = prepare_output_folder(output_, session.common());
    std::vector<Tree> trees;
    std::vector<fs::path> files;
    for (std::size_t t = 0; t < inputs_.size(); ++t) {
      files.push_back(tree_file(inputs_[t]));
      fs::create_directories(own_folder(folder, t));
      std::optional<Tree> model = describe_file(files.back(), session.progress()).tree;
      if (!model) {
        ObservedTree seen =
            observe_tree(session, files.back(), reconstruct_, photo_, own_folder(folder, t), {});
        if (seen.one_view) throw UsageError("photographs are fitted one at a time");
        model = std::move(seen.model.tree);
      }
      trees.push_back(std::move(*model));
    }
    const TreesFit fit = fit_trees(trees, options, session.progress());
    for (std::size_t t = 0; t < trees.size(); ++t)
      write_results(session, own_folder(folder, t), files[t], fit.trees[t]);
    const std::string json = trees_fit_json(fit);
    write_file(folder / "fit.json", json);
    write_file(folder / "run.toml", run_record(session, files));

    session.json(json);
    for (std::size_t t = 0; t < trees.size(); ++t) {
      session.say(files[t].string());
      say_fit(session, fit.trees[t]);
    }
    session.say("Shared by all trees (90 % intervals)");
    say_parameters(session, fit.shared);
    session.say("Written to " + folder.string() +
                ": fit.json, and for each tree tree_N/fit.json, params.toml");
    return 0;
  }

  static fs::path own_folder(const fs::path& folder, std::size_t tree) {
    return folder / fmt::format("tree_{}", tree + 1);
  }

  static fs::path tree_file(const fs::path& input) {
    return fs::is_directory(input) ? input / "qsm.csv" : input;
  }

  /// Also report.json, which `view` makes a page of.
  static void write_results(Session& session, const fs::path& folder, const fs::path& input,
                            const TreeFit& fit) {
    write_fit(folder, fit);
    DirectEstimates observed = fit.direct;
    observed.internode_length_m = fit.best.rho_m;
    const Tree regrown = regrow(fit.best, observed, fit.best_seed, session.progress()).tree;
    fs::create_directories(folder / "regrown");
    write_tree_files(folder / "regrown", regrown, measure(regrown), {});
    ReportData report;
    report.title = input.stem().string();
    describe_fit(report, fit);
    report.provenance.version = version();
    report.provenance.seed = session.common().seed;
    report.provenance.command_line = "dendrofit fit " + input.filename().string();
    report.provenance.input_name = input.filename().string();
    report.provenance.input_checksum = "crc32:" + checksum(input);
    // Of a scan that was reconstructed here, or as it stands beside the model that was given.
    const fs::path model = folder / "qsm.csv";
    report.provenance.crs = crs_beside(fs::exists(model) ? model : input);
    write_file(folder / "report.json", report_json(report));
  }

  fs::path prepare_folder(const Session& session) const {
    CommonOptions common = session.common();
    common.force |= resume_;
    if (resume_ && !fs::is_regular_file(output_ / kCheckpoint))
      throw UsageError(output_.string() + ": no interrupted fit to resume here (no " + kCheckpoint + ")");
    return prepare_output_folder(output_, common);
  }

  /// Four stations about the tree, as far away as it is tall (8 m at least), then the reconstruction as the
  /// options of this run have it.
  ObserveTree observer(const Session& session, double height_m) const {
    ReconstructOptions reconstruction = reconstruct_.resolve(session.common());
    reconstruction.threads = 1;  // many trees are observed at a time
    ScanOptions scan;
    scan.distance_m = std::max(scan.distance_m, height_m);
    scan.threads = 1;
    return [=](const Tree& grown, std::uint64_t seed) {
      ScanOptions own = scan;
      own.seed = seed;
      return reconstruct(scan_tree(grown, nullptr, own).cloud, reconstruction).tree;
    };
  }

  std::vector<fs::path> inputs_;
  fs::path output_;
  bool resume_ = false;
  bool through_scan_ = false;
  FitSettings fit_;
  ReconstructSettings reconstruct_;
  PhotoSettings photo_;
};

}  // namespace

std::unique_ptr<Command> make_fit() {
  return std::make_unique<Fit>();
}

}  // namespace dendrofit::cli
