// SPDX-License-Identifier: GPL-3.0-or-later
// How well known growth parameters come back: trees are grown from them, handed over as they are (arm a),
// without the wood a scan does not show (b), or virtually scanned and reconstructed (c), and fitted blind.
// usage: recovery BANK TABLE.csv [--arm a|b|c|h] [--truths N] [--first I] [--age] [--search SETS]
//                              [--method fit|mean|random|genetic]
// One line a truth and parameter goes to TABLE.csv as it is worked out; a second run goes on where the table
// ends. The summary goes to standard output.
#include "core/errors.h"

#include <cstdio>
#include <fstream>
#include <iterator>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "bench/recovery_fits.h"
#include "bench/recovery_held_out.h"

namespace {

using namespace dendrofit;

struct Settings {
  std::string bank, table;
  char arm = 'b';
  int truths = 20, first = 0, search = 0;
  bool age = false;
  std::string method = "fit";
};

Settings parse(int argc, char** argv) {
  if (argc < 3)
    throw InputError(
        "usage: recovery BANK TABLE.csv [--arm a|b|c] [--truths N] [--first I] [--age] [--search SETS] "
        "[--method fit|mean|random|genetic]");
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
    else if (word == "--method")
      s.method = argv[++i];
    else
      throw InputError("unknown option " + word);
  }
  return s;
}

std::vector<RecoveryLine> fitted(const Settings& settings, const Truth& truth, const Tree& seen,
                                 const FitOptions& options) {
  if (settings.method != "fit") return baseline_fit(settings.method, truth, seen, options);
  return settings.search > 0 ? whole_fit(truth, seen, options) : first_posterior(truth, seen, options);
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
        std::vector<RecoveryLine> lines;
        for (const HeldOut& l : held_out_posteriors(*bank, settings.truths, level, errors))
          lines.push_back(
              {l.truth, l.key, l.value, l.median, l.lo, l.hi, l.lo50, l.hi50, l.shrinkage, l.rank});
        summarise(lines);
      }
    return;
  }
  std::set<int> done;
  for (const RecoveryLine& line : read_table(settings.table)) done.insert(line.truth);
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
    if (settings.arm == 'b') options.thinnest_wood_m = kThinnestSeen;
    if (settings.age) options.age_years = truth.parameters.cycles;
    if (settings.search > 0) options.evaluations = settings.search;
    try {
      for (const RecoveryLine& l : fitted(settings, truth, as_seen(truth, settings.arm), options))
        out << table_row(l);
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
