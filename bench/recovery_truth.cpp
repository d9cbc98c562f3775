// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/recovery_truth.h"

#include "core/errors.h"
#include "core/metrics.h"
#include "core/random.h"
#include "fit/descriptors.h"
#include "fit/search_space.h"
#include "forward/igm/grow.h"
#include "forward/virtual_scan/virtual_scan.h"
#include "recon/reconstruct.h"

namespace dendrofit {
namespace {

constexpr int kStrata = 200;
constexpr std::uint64_t kTruthSeed = 0x77777;

/// Stratum of truth `index` in dimension d: a fixed permutation of the strata.
int stratum(int index, int d) {
  std::vector<int> order(kStrata);
  for (int i = 0; i < kStrata; ++i) order[static_cast<std::size_t>(i)] = i;
  Random random = Random(kTruthSeed).child({0xa11, static_cast<std::uint64_t>(d)});
  for (std::size_t i = order.size(); i > 1; --i) std::swap(order[i - 1], order[random.below(i)]);
  return order[static_cast<std::size_t>(index % kStrata)];
}

}  // namespace

Truth grow_truth(int index) {
  const SearchSpace space("logistic");
  Truth truth;
  truth.index = index;
  for (std::uint64_t attempt = 0; attempt < 20; ++attempt) {
    Random random = Random(kTruthSeed).child({static_cast<std::uint64_t>(index), attempt});
    Eigen::VectorXd unit(space.size());
    for (Eigen::Index d = 0; d < unit.size(); ++d)
      unit[d] = 0.1 + 0.8 * (stratum(index, static_cast<int>(d)) + random.uniform()) / kStrata;
    truth.parameters = space.at(unit);
    truth.seed = random.bits();
    IgmOptions options;
    options.seed = truth.seed;
    truth.tree = grow_igm(truth.parameters, {}, options).tree;
    const double internodes = measure(truth.tree).height_m / truth.parameters.rho_m;
    if (internodes >= 40 && internodes <= 110) return truth;
  }
  throw SolverError("no tree of a usable height for this truth");
}

Tree as_seen(const Truth& truth, char arm) {
  if (arm == 'a') return truth.tree;
  if (arm == 'b') return without_thin_wood(truth.tree, kThinnestSeen);
  ScanOptions scan;
  scan.seed = truth.seed;
  scan.threads = 1;
  ReconstructOptions reconstruction;
  reconstruction.threads = 1;
  return reconstruct(scan_tree(truth.tree, nullptr, scan).cloud, reconstruction).tree;
}

}  // namespace dendrofit
