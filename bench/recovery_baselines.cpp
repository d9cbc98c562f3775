// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/recovery_baselines.h"

#include "core/errors.h"
#include "core/random.h"
#include "fit/descriptor_input.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace dendrofit {
namespace {

constexpr Eigen::Index kFeatures = 7;
constexpr Eigen::Index kDirections = 100;
constexpr Eigen::Index kFewestBranches = 3;
constexpr int kPopulation = 30, kElites = 2;
constexpr double kMutationShare = 0.15, kMutationStep = 0.15, kBlend = 0.3;
constexpr std::uint64_t kFixedSeed = 4711;

/// One branch a row.
Eigen::MatrixXd branch_features(const Tree& tree, const DescribeOptions& comparison) {
  const DescriptorInput in = analyse(tree, comparison);
  std::vector<std::array<double, kFeatures>> rows;
  for (const Axis& axis : in.axes) {
    if (axis.parent_node < 0) continue;
    const double base = in.tree.radius[static_cast<std::size_t>(axis.nodes.front())];
    const double tip = in.tree.radius[static_cast<std::size_t>(axis.nodes.back())];
    rows.push_back({axis.length / in.height, base_height(in, axis), insertion_angle(in, axis),
                    base / in.base_diameter, tip / base, straightness(in, axis),
                    static_cast<double>(axis.order)});
  }
  Eigen::MatrixXd features(static_cast<Eigen::Index>(rows.size()), kFeatures);
  for (std::size_t i = 0; i < rows.size(); ++i)
    features.row(static_cast<Eigen::Index>(i)) =
        Eigen::Map<const Eigen::RowVectorXd>(rows[i].data(), kFeatures);
  return features;
}

std::vector<double> sorted(const Eigen::VectorXd& values) {
  std::vector<double> list(values.begin(), values.end());
  std::sort(list.begin(), list.end());
  return list;
}

/// Largest difference of the two empirical distribution functions; both samples rising.
double kolmogorov_smirnov(const std::vector<double>& a, const std::vector<double>& b) {
  double most = 0;
  std::size_t i = 0, j = 0;
  while (i < a.size() && j < b.size()) {
    const double x = std::min(a[i], b[j]);
    while (i < a.size() && a[i] <= x) ++i;
    while (j < b.size() && b[j] <= x) ++j;
    most = std::max(most, std::abs(static_cast<double>(i) / static_cast<double>(a.size()) -
                                   static_cast<double>(j) / static_cast<double>(b.size())));
  }
  return most;
}

struct Individual {
  Eigen::VectorXd point;
  double distance = 0;
};

Eigen::VectorXd offspring(const std::vector<Individual>& parents, Random& random) {
  const auto tournament = [&]() -> const Individual& {
    const Individual& a = parents[random.below(parents.size())];
    const Individual& b = parents[random.below(parents.size())];
    return a.distance < b.distance ? a : b;
  };
  const Individual& mother = tournament();
  const Individual& father = tournament();
  Eigen::VectorXd child(mother.point.size());
  for (Eigen::Index i = 0; i < child.size(); ++i) {
    const double share = -kBlend + (1 + 2 * kBlend) * random.uniform();
    child[i] = mother.point[i] + share * (father.point[i] - mother.point[i]);
    if (random.uniform() < kMutationShare) child[i] += kMutationStep * random.normal();
    child[i] = std::clamp(child[i], 0.0, 1.0);
  }
  return child;
}

Eigen::VectorXd uniform_point(Eigen::Index size, Random& random) {
  Eigen::VectorXd point(size);
  for (double& u : point) u = random.uniform();
  return point;
}

Eigen::VectorXd genetic(const FitProblem& problem, const ProjectedKs& ks, int trees) {
  Random random = Random(problem.options.seed).child({0x6e7e});
  const auto measured = [&](const Eigen::VectorXd& point) {
    const Tree tree =
        regrow(problem.space.at(point), problem.setting.observed, kFixedSeed, no_progress()).tree;
    return Individual{point, ks.distance(tree)};
  };
  std::vector<Individual> population;
  int tried = 0;
  for (; tried < std::min(trees, kPopulation); ++tried)
    population.push_back(measured(uniform_point(problem.space.size(), random)));
  const auto by_distance = [](const Individual& a, const Individual& b) { return a.distance < b.distance; };
  std::stable_sort(population.begin(), population.end(), by_distance);
  while (tried < trees) {
    std::vector<Individual> next(population.begin(), population.begin() + kElites);
    for (; tried < trees && next.size() < population.size(); ++tried)
      next.push_back(measured(offspring(population, random)));
    population = std::move(next);
    std::stable_sort(population.begin(), population.end(), by_distance);
  }
  return population.front().point;
}

Eigen::VectorXd random_search(const FitProblem& problem, const NoiseMetric& metric, int trees) {
  constexpr int kSeeds = 2;
  Random random = Random(problem.options.seed).child({0x4a4d});
  UnitPoints points(static_cast<std::size_t>(std::max(1, trees / kSeeds)));
  for (Eigen::VectorXd& point : points) point = uniform_point(problem.space.size(), random);
  SimulationLog log(0);
  const Eigen::MatrixXd rows = problem.run(points, kSeeds, kSearchKeys, log, no_progress());
  std::size_t best = 0;
  double least = HUGE_VAL;
  for (std::size_t p = 0; p < points.size(); ++p) {
    const double cost = metric.cost(rows.middleRows(static_cast<Eigen::Index>(p) * kSeeds, kSeeds));
    if (cost >= least) continue;
    least = cost;
    best = p;
  }
  return points[best];
}

}  // namespace

ProjectedKs::ProjectedKs(const Tree& observed, const DescribeOptions& comparison, std::uint64_t seed)
    : comparison_(comparison), directions_(kFeatures, kDirections) {
  const Eigen::MatrixXd features = branch_features(observed, comparison);
  if (features.rows() < kFewestBranches) throw SolverError("too few branches to compare");
  const Eigen::RowVectorXd mean = features.colwise().mean();
  scale_ =
      ((features.rowwise() - mean).array().square().colwise().mean().sqrt()).max(1e-6).matrix().transpose();
  Random random = Random(seed).child({0x4b5});
  for (double& d : directions_.reshaped()) d = random.normal();
  directions_.colwise().normalize();
  const Eigen::MatrixXd projected = scaled(observed) * directions_;
  for (Eigen::Index d = 0; d < kDirections; ++d) observed_.push_back(sorted(projected.col(d)));
}

Eigen::MatrixXd ProjectedKs::scaled(const Tree& tree) const {
  return branch_features(tree, comparison_) * scale_.cwiseInverse().asDiagonal();
}

double ProjectedKs::distance(const Tree& tree) const {
  const Eigen::MatrixXd projected = scaled(tree) * directions_;
  if (projected.rows() < kFewestBranches) return 1;
  double sum = 0;
  for (Eigen::Index d = 0; d < kDirections; ++d)
    sum += kolmogorov_smirnov(observed_[static_cast<std::size_t>(d)], sorted(projected.col(d)));
  return sum / static_cast<double>(kDirections);
}

Eigen::VectorXd baseline(const std::string& method, const FitProblem& problem, const NoiseMetric& metric,
                         const ProjectedKs& ks, int trees) {
  if (method == "mean") return Eigen::VectorXd::Constant(problem.space.size(), 0.5);
  if (method == "random") return random_search(problem, metric, trees);
  if (method == "genetic") return genetic(problem, ks, trees);
  throw InputError("unknown method " + method);
}

}  // namespace dendrofit
