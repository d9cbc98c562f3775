// SPDX-License-Identifier: GPL-3.0-or-later
// dendrofit fit SCAN|PHOTO|qsm.csv -o DIR
#include "cli/commands.h"
#include "cli/fit_settings.h"
#include "cli/observed_tree.h"
#include "cli/output_folder.h"
#include "cli/parse.h"
#include "cli/tree_files.h"
#include "core/atomic_file.h"
#include "fit/direct_estimates.h"
#include "fit/tree_simulator.h"
#include "io/file_info.h"

#include <fstream>
#include <iterator>
#include <optional>

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
    options.positional("TREE", input_,
                       "Scan or photograph of a tree, or its model (qsm.csv or any QSM format)", false);
    options.path("--output", output_, "Folder for the results", "-o");
    fit_.declare(options);
    options.flag("--resume", resume_,
                 "Go on with an interrupted fit: the same command, with the same output folder");
    reconstruct_.declare(options);
    photo_.declare(options);
  }

  int run(Session& session) override {
    need_output(output_);
    photo_.check(input_);
    FitOptions options = fit_.resolve(session);
    std::optional<Tree> model;
    if (!photo_.asked_for(input_)) model = describe_file(input_, session.progress()).tree;
    const fs::path folder = prepare_folder(session);
    const fs::path checkpoint = folder / kCheckpoint;
    if (resume_) options.resume_from = read_bytes(checkpoint);
    options.on_checkpoint = [&](std::string_view bytes) { write_file(checkpoint, bytes); };
    std::vector<fs::path> inputs = {input_};
    if (!model) {
      ObservedTree observed = observe_tree(session, input_, reconstruct_, photo_, folder, {});
      if (observed.one_view) options.observed_from = ObservedFrom::one_view;
      inputs = observed.inputs;
      model = std::move(observed.model.tree);
    }
    const Tree& observed = *model;

    const TreeFit fit = fit_tree(observed, options, session.progress());
    write_fit(folder, fit);
    const Tree regrown =
        regrow(fit.best, estimate_directly(observed, fit.best.rho_m), fit.best_seed, session.progress()).tree;
    fs::create_directories(folder / "regrown");
    write_tree_files(folder / "regrown", regrown, measure(regrown), {});
    for (const fs::path& other : fit_.inputs()) inputs.push_back(other);
    write_file(folder / "run.toml", run_record(session, inputs));
    fs::remove(checkpoint);

    session.json(fit_json(fit));
    say_fit(session, fit);
    session.say("Written to " + folder.string() + ": fit.json, params.toml, regrown/qsm.csv");
    return 0;
  }

 private:
  fs::path prepare_folder(const Session& session) const {
    CommonOptions common = session.common();
    common.force |= resume_;
    if (resume_ && !fs::is_regular_file(output_ / kCheckpoint))
      throw UsageError(output_.string() + ": no interrupted fit to resume here (no " + kCheckpoint + ")");
    return prepare_output_folder(output_, common);
  }

  fs::path input_, output_;
  bool resume_ = false;
  FitSettings fit_;
  ReconstructSettings reconstruct_;
  PhotoSettings photo_;
};

}  // namespace

std::unique_ptr<Command> make_fit() {
  return std::make_unique<Fit>();
}

}  // namespace dendrofit::cli
