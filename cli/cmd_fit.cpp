// SPDX-License-Identifier: GPL-3.0-or-later
// dendrofit fit SCAN|qsm.csv -o DIR
#include "cli/commands.h"
#include "cli/fit_settings.h"
#include "cli/output_folder.h"
#include "cli/reconstruct_settings.h"
#include "cli/tree_files.h"
#include "core/atomic_file.h"
#include "fit/search_space.h"
#include "fit/tree_simulator.h"
#include "io/file_info.h"

#include <fmt/format.h>

namespace dendrofit::cli {
namespace {

class Fit : public Command {
 public:
  void declare(OptionTable& options) override {
    options.positional("TREE", input_, "Scan of a tree, or its model (qsm.csv or any QSM format)");
    options.path("--output", output_, "Folder for the results", "-o");
    fit_.declare(options);
    reconstruct_.declare(options);
  }

  int run(Session& session) override {
    need_output(output_);
    const FitOptions options = fit_.resolve(session.common());
    const FileInfo info = describe_file(input_, session.progress());
    const auto folder = prepare_output_folder(output_, session.common());
    const Tree observed = info.tree ? *info.tree : reconstruct_first(session, folder);

    const TreeFit fit = fit_tree(observed, options, session.progress());
    write_fit(folder, fit);
    const Tree regrown =
        regrow(fit.best, estimate_directly(observed, fit.best.rho_m), fit.best_seed, session.progress()).tree;
    std::filesystem::create_directories(folder / "regrown");
    write_tree_files(folder / "regrown", regrown, measure(regrown), {});
    write_file(folder / "run.toml", run_record(session, {input_}));

    session.json(fit_json(fit));
    say_fit(session, fit);
    session.say("Written to " + folder.string() + ": fit.json, params.toml, regrown/qsm.csv");
    return 0;
  }

 private:
  Tree reconstruct_first(Session& session, const std::filesystem::path& folder) const {
    const PointCloud scan = reconstruct_.read_scan(session, input_, session.progress());
    const Reconstruction result =
        reconstruct(scan, reconstruct_.resolve(session.common()), session.progress());
    write_reconstruction(folder, result, {});
    say_reconstruction(session, result);
    return result.tree;
  }

  std::filesystem::path input_, output_;
  FitSettings fit_;
  ReconstructSettings reconstruct_;
};

}  // namespace

std::unique_ptr<Command> make_fit() {
  return std::make_unique<Fit>();
}

}  // namespace dendrofit::cli
