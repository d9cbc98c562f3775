// SPDX-License-Identifier: GPL-3.0-or-later
// How well known growth parameters come back: trees are grown from them, handed over as they are (arm a),
// without the wood a scan does not show (b), or virtually scanned and reconstructed (c), and fitted blind.
// usage: recovery BANK TABLE.csv [--arm a|b|c|h] [--truths N] [--first I] [--age] [--search SETS]
// One line a truth and parameter goes to TABLE.csv as it is worked out; a second run goes on where the table
// ends. The summary goes to standard output.
#include "core/errors.h"
#include "core/metrics.h"
#include "fit/fit_problem.h"
#include "fit/fit_report.h"
#include "fit/fit_tree.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <iterator>
#include <map>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "bench/recovery_held_out.h"
#include "bench/recovery_truth.h"
#include <fmt/format.h>
#include <fmt/ostream.h>

namespace {

using namespace dendrofit;

struct Settings {
  std::string bank, table;
  char arm = 'b';
  int truths = 20, first = 0, search = 0;
  bool age = false;
};

struct Line {
  int truth = 0;
  std::string key;
  double value = 0, estimate = 0, lo = 0, hi = 0, lo50 = 0, hi50 = 0, shrinkage = 0, rank = 0;
};

/// The posterior from the bank alone, as the fit has it before its search.
std::vector<Line> first_posterior(const Truth& truth, const Tree& seen, const FitOptions& options) {
  FitProblem problem = pose(seen, options);
  SimulationLog log(0);
  const PriorInformation prior = prior_information(problem, log, no_progress());
  if (!prior.from_bank) throw SolverError("the bank cannot be used");
  const PosteriorSample posterior = regression_posterior(prior.simulations, prior.observation);
  const auto rows = problem.space.reported();
  const auto parameters = report_parameters(problem, posterior, truth.parameters);
  std::vector<Line> lines;
  for (std::size_t k = 0; k < rows.size(); ++k) {
    Line line{truth.index, rows[k].key, truth.parameters.get(rows[k].key)};
    Eigen::VectorXd values(posterior.unit.rows());
    for (Eigen::Index i = 0; i < values.size(); ++i)
      values[i] = problem.space.report(posterior.unit.row(i).transpose(), rows)[static_cast<Eigen::Index>(k)];
    line.estimate = parameters[k].median;
    line.lo = weighted_quantile(values, posterior.weights, 0.05);
    line.hi = weighted_quantile(values, posterior.weights, 0.95);
    line.lo50 = parameters[k].lo50;
    line.hi50 = parameters[k].hi50;
    line.shrinkage = parameters[k].shrinkage;
    for (Eigen::Index i = 0; i < values.size(); ++i)
      if (values[i] < line.value) line.rank += posterior.weights[i];
    lines.push_back(line);
  }
  return lines;
}

/// The whole fit; `estimate` is the value that regrows the tree.
std::vector<Line> whole_fit(const Truth& truth, const Tree& seen, const FitOptions& options) {
  const TreeFit fit = fit_tree(seen, options);
  std::vector<Line> lines;
  for (const FittedParameter& p : fit.parameters) {
    lines.push_back({truth.index, p.key, truth.parameters.get(p.key), p.value, p.lo, p.hi, p.lo50, p.hi50,
                     p.shrinkage, 0.5});
    lines.push_back({truth.index, p.key + "_median", truth.parameters.get(p.key), p.median, p.lo, p.hi,
                     p.lo50, p.hi50, p.shrinkage, 0.5});
  }
  // The regrown trees against the true one.
  double height = 0, dbh = 0, volume = 0;
  constexpr int kRegrown = 4;
  for (int s = 0; s < kRegrown; ++s) {
    const Regrown again = regrow(fit.best, fit.direct, simulation_seed(truth.seed, 99, s), no_progress());
    const TreeMetrics m = measure(again.tree);
    height += m.height_m / kRegrown;
    dbh += m.dbh_m.value_or(0) / kRegrown;
    volume += m.total_volume_m3 / kRegrown;
  }
  const TreeMetrics m = measure(truth.tree);
  lines.push_back({truth.index, "tree_height_percent", 0, 100 * (height / m.height_m - 1)});
  if (m.dbh_m) lines.push_back({truth.index, "tree_dbh_percent", 0, 100 * (dbh / *m.dbh_m - 1)});
  lines.push_back({truth.index, "tree_volume_percent", 0, 100 * (volume / m.total_volume_m3 - 1)});
  lines.push_back({truth.index, "cost_over_floor", 1, fit.cost_after / fit.seed_floor});
  lines.push_back({truth.index, "cost_before_over_floor", 1, fit.cost_before / fit.seed_floor});
  lines.push_back({truth.index, "surrogate_kept", 0, fit.refinement.kept ? 1.0 : 0.0});
  lines.push_back({truth.index, "surrogate_gain", 0, fit.refinement.cost_without - fit.refinement.cost_with});
  return lines;
}

std::vector<Line> read_table(const std::string& file) {
  std::vector<Line> lines;
  std::ifstream in(file);
  for (std::string text; std::getline(in, text);) {
    std::ranges::replace(text, ',', ' ');
    std::istringstream words(text);
    Line l;
    if (words >> l.truth >> l.key >> l.value >> l.estimate >> l.lo >> l.hi >> l.lo50 >> l.hi50 >>
        l.shrinkage >> l.rank)
      lines.push_back(l);
  }
  return lines;
}

double middle(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values.empty() ? 0 : values[values.size() / 2];
}

void summarise(const std::vector<Line>& lines) {
  std::map<std::string, std::vector<Line>> by_key;
  for (const Line& line : lines) by_key[line.key].push_back(line);
  std::printf(
      "| parameter | n | median error | relative | bias | 50 %% covers | 90 %% covers | shrinkage | "
      "ranks in tenths |\n|---|---|---|---|---|---|---|---|---|\n");
  for (const auto& [key, rows] : by_key) {
    std::vector<double> error, relative, signed_error, shrinkage;
    double half = 0, most = 0;
    std::vector<int> tenths(10, 0);
    for (const Line& l : rows) {
      error.push_back(std::abs(l.estimate - l.value));
      relative.push_back(l.value != 0 ? std::abs(l.estimate / l.value - 1) : 0);
      signed_error.push_back(l.estimate - l.value);
      shrinkage.push_back(l.shrinkage);
      half += l.lo50 <= l.value && l.value <= l.hi50;
      most += l.lo <= l.value && l.value <= l.hi;
      ++tenths[static_cast<std::size_t>(std::clamp(l.rank * 10, 0.0, 9.0))];
    }
    std::string ranks;
    for (const int t : tenths) ranks += fmt::format("{} ", t);
    const auto n = static_cast<double>(rows.size());
    std::printf("| %s | %zu | %.4g | %.1f %% | %+.3g | %.0f %% | %.0f %% | %.2f | %s|\n", key.c_str(),
                rows.size(), middle(error), 100 * middle(relative), middle(signed_error), 100 * half / n,
                100 * most / n, middle(shrinkage), ranks.c_str());
  }
}

Settings parse(int argc, char** argv) {
  if (argc < 3)
    throw InputError(
        "usage: recovery BANK TABLE.csv [--arm a|b|c] [--truths N] [--first I] [--age] [--search SETS]");
  Settings s{argv[1], argv[2]};
  for (int i = 3; i < argc; ++i) {
    const std::string word = argv[i];
    if (word == "--age")
      s.age = true;
    else if (i + 1 >= argc)
      throw InputError(word + ": a value is missing");
    else if (word == "--arm")
      s.arm = argv[++i][0];
    else if (word == "--truths")
      s.truths = std::stoi(argv[++i]);
    else if (word == "--first")
      s.first = std::stoi(argv[++i]);
    else if (word == "--search")
      s.search = std::stoi(argv[++i]);
    else
      throw InputError("unknown option " + word);
  }
  return s;
}

void run(const Settings& settings) {
  std::ifstream in(settings.bank, std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(in), {}};
  const auto bank = std::make_shared<const PriorBank>(decode_bank(bytes, settings.bank));
  if (settings.arm == 'h') {  // no table: it takes seconds
    for (std::size_t level = 0; level < kVisibleShares.size(); ++level)
      for (const double errors : {0.0, 1.0}) {
        std::printf("\nvisible share %g, %s\n\n", kVisibleShares[level],
                    errors > 0 ? "with a scan's errors" : "without error");
        std::vector<Line> lines;
        for (const HeldOut& l : held_out_posteriors(*bank, settings.truths, level, errors))
          lines.push_back(
              {l.truth, l.key, l.value, l.median, l.lo, l.hi, l.lo50, l.hi50, l.shrinkage, l.rank});
        summarise(lines);
      }
    return;
  }
  std::set<int> done;
  for (const Line& line : read_table(settings.table)) done.insert(line.truth);
  std::ofstream out(settings.table, std::ios::app);
  for (int t = settings.first; t < settings.first + settings.truths; ++t) {
    if (done.count(t)) continue;
    Truth truth;
    try {
      truth = grow_truth(t);
    } catch (const SolverError& error) {
      std::fprintf(stderr, "truth %d: %s\n", t, error.what());
      continue;
    }
    FitOptions options;
    options.bank = bank;
    options.internode_length_m = truth.parameters.rho_m;
    options.threads = 1;
    options.seed = truth.seed;
    options.observed_from = settings.arm == 'a' ? ObservedFrom::exact : ObservedFrom::scan;
    if (settings.age) options.age_years = truth.parameters.cycles;
    if (settings.search > 0) options.evaluations = settings.search;
    try {
      const Tree seen = as_seen(truth, settings.arm);
      const auto lines =
          settings.search > 0 ? whole_fit(truth, seen, options) : first_posterior(truth, seen, options);
      for (const Line& l : lines)
        fmt::print(out, "{},{},{},{},{},{},{},{},{},{}\n", l.truth, l.key, l.value, l.estimate, l.lo, l.hi,
                   l.lo50, l.hi50, l.shrinkage, l.rank);
      out.flush();
    } catch (const std::exception& error) {
      std::fprintf(stderr, "truth %d: %s\n", t, error.what());
    }
  }
  summarise(read_table(settings.table));
}

}  // namespace

int main(int argc, char** argv) {
  try {
    run(parse(argc, argv));
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "recovery: %s\n", error.what());
    return 2;
  }
}
