// SPDX-License-Identifier: GPL-3.0-or-later
#include "fit/search_space.h"

#include "core/errors.h"
#include "core/metrics.h"
#include "core/tree_topology.h"
#include "forward/growth_equations.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace dendrofit {
namespace {

constexpr int kFewestForks = 10;
constexpr double kTypicalCycles = 20;

/// v with sum(child^v) = parent^v, in [1.2, 5]; nothing where no such v exists (a child thicker than its
/// parent).
std::optional<double> fork_exponent(double parent, const std::vector<double>& children) {
  const auto excess = [&](double v) {
    double sum = 0;
    for (const double child : children) sum += std::pow(child / parent, v);
    return sum - 1;
  };
  double lo = 1.2;
  double hi = 5;
  if (excess(lo) < 0 || excess(hi) > 0) return {};
  for (int i = 0; i < 40; ++i) (excess(0.5 * (lo + hi)) > 0 ? lo : hi) = 0.5 * (lo + hi);
  return 0.5 * (lo + hi);
}

void estimate_pipe_exponent(const Tree& tree, DirectEstimates& direct) {
  const TreeChildren children(tree);
  std::vector<double> exponents;
  for (std::size_t i = 0; i < tree.size(); ++i) {
    const auto of = children.of(i);
    if (of.size() < 2 || tree.quality[i] != RadiusQuality::measured) continue;
    std::vector<double> radii;
    bool measured = true;
    for (const std::int32_t c : of) {
      measured &= tree.quality[static_cast<std::size_t>(c)] == RadiusQuality::measured;
      radii.push_back(tree.radius[static_cast<std::size_t>(c)]);
    }
    if (!measured) continue;
    if (const auto v = fork_exponent(tree.radius[i], radii)) exponents.push_back(*v);
  }
  direct.forks = static_cast<int>(exponents.size());
  if (direct.forks < kFewestForks) return;
  const auto middle = exponents.begin() + static_cast<std::ptrdiff_t>(exponents.size() / 2);
  std::nth_element(exponents.begin(), middle, exponents.end());
  direct.pipe_exponent = std::clamp(*middle, 1.8, 3.5);
}

}  // namespace

double scale_for(double height_m) {
  constexpr std::array<double, 8> kSeries = {1, 0.5, 0.2, 0.1, 0.05, 0.02, 0.01, 0.005};
  for (const double rho : kSeries)
    if (height_m / rho >= 50) return rho;
  return kSeries.back();
}

DirectEstimates estimate_directly(const Tree& tree, std::optional<double> internode_length_m) {
  const TreeMetrics metrics = measure(tree);
  DirectEstimates direct;
  direct.height_m = metrics.height_m;
  direct.dbh_m = metrics.dbh_m;
  for (std::size_t i = 0; i < tree.size(); ++i)
    if (tree.parent[i] < 0) direct.base_radius_m = std::max(direct.base_radius_m, tree.radius[i]);
  direct.internode_length_m = internode_length_m.value_or(scale_for(metrics.height_m));
  require(std::isfinite(direct.internode_length_m) && direct.internode_length_m > 0, "internode_length_m",
          direct.internode_length_m, "must be positive");
  estimate_pipe_exponent(tree, direct);
  return direct;
}

SearchSpace::SearchSpace(const DirectEstimates& direct, const std::string& equation,
                         std::optional<int> cycles)
    : base_(igm_preset("table2-06").parameters) {
  base_.rho_m = direct.internode_length_m;
  base_.pipe_exponent = direct.pipe_exponent;
  base_.set_equation(equation);
  const double size = direct.height_m / base_.rho_m;
  const double age = cycles.value_or(static_cast<int>(kTypicalCycles));
  // The asymptote: at least about the size reached; a tree may yet double. Rates: the range of Table 2's
  // trees for 20 cycles, in proportion for other ages.
  const double rate = kTypicalCycles / age;
  if (equation == "logistic") {
    rows_ = {{"xm", 0.9 * size, 2.2 * size}, {"r", 0.15 * rate, 0.6 * rate}};
    base_.set("x0", std::min(base_.get("x0"), 0.1 * size));
  } else if (equation == "bertalanffy") {
    rows_ = {{"beta1", 0.9 * size, 2.2 * size}, {"beta2", 0.06 * rate, 0.35 * rate}};
  } else if (equation == "weibull") {
    rows_ = {{"omega1", 0.9 * size, 2.2 * size}, {"omega2", 0.0005, 0.02}, {"omega3", 1.5, 3}};
  } else {
    throw InputError("fit: equation '" + equation + "': expected logistic, bertalanffy or weibull");
  }
  rows_.insert(rows_.end(), {{"k", 0.15, 0.85},
                             {"lambda", 0.46, 0.58},
                             {"mu", 0.3, 2.0},
                             {"gamma", -1.5, 1.5},
                             {"shed_ratio", 0.05, 0.55},
                             {"branch_angle_deg", 15, 80}});
  if (cycles)
    base_.cycles = *cycles;
  else
    rows_.push_back({"cycles", 6, 26});
}

double SearchSpace::value(Eigen::Index row, double unit) const {
  const SearchRow& r = rows_[static_cast<std::size_t>(row)];
  const double value = r.lo + std::clamp(unit, 0.0, 1.0) * (r.hi - r.lo);
  return r.key == "cycles" ? std::round(value) : value;
}

IgmParameters SearchSpace::at(const Eigen::VectorXd& unit) const {
  IgmParameters parameters = base_;
  for (Eigen::Index i = 0; i < size(); ++i)
    parameters.set(rows_[static_cast<std::size_t>(i)].key, value(i, unit[i]));
  return parameters;
}

SearchSpace SearchSpace::rescaled(double internode_length_m) const {
  SearchSpace other = *this;
  other.base_.rho_m = internode_length_m;
  return other;
}

}  // namespace dendrofit
