// SPDX-License-Identifier: GPL-3.0-or-later
#include "fit/regression_posterior.h"

#include "core/errors.h"
#include "core/random.h"
#include "fit/summary_regression.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace dendrofit {
namespace {

constexpr Eigen::Index kFewest = 30;
constexpr double kFewestShare = 0.2;    // of simulations that must have a descriptor for it to be used
constexpr double kNearestShare = 0.08;  // of the simulations make the posterior, within the two limits
constexpr double kFewestNearest = 80, kMostNearest = 500;
constexpr double kFarthest = 3.5;     // sd: descriptors beyond are pulled back, regressions must not
                                      // extrapolate
constexpr double kKnownScale = 0.12;  // of a known column's range is one unit of distance
constexpr std::uint64_t kErrorSeed = 0x5ca9e;

/// The used descriptors in standard units, simulations with the observation's error added, gaps at the mean.
struct Standardised {
  Eigen::MatrixXd simulations;
  Eigen::VectorXd observed;
  std::vector<Eigen::Index> outlying;
};

void check(const PriorSimulations& simulations, const Observation& observed) {
  const Eigen::Index n = simulations.unit.rows();
  if (simulations.descriptors.rows() != n || simulations.descriptors.cols() != observed.descriptors.size() ||
      observed.error.size() != observed.descriptors.size() ||
      simulations.known.cols() != observed.known.size() ||
      (simulations.known.cols() > 0 && simulations.known.rows() != n) ||
      (!simulations.group.empty() && static_cast<Eigen::Index>(simulations.group.size()) != n))
    throw InputError("regression_posterior: parameters, descriptors and observation do not fit together");
}

Standardised standardise(const PriorSimulations& simulations, const Observation& observed) {
  const Eigen::MatrixXd& all = simulations.descriptors;
  std::vector<Eigen::VectorXd> columns;
  std::vector<double> point;
  Standardised out;
  for (Eigen::Index j = 0; j < all.cols(); ++j) {
    if (!std::isfinite(observed.descriptors[j])) continue;
    Eigen::VectorXd column = all.col(j);
    std::vector<double> finite;
    for (Eigen::Index i = 0; i < column.size(); ++i) {
      if (!std::isfinite(column[i])) continue;
      if (observed.error[j] > 0)
        column[i] +=
            observed.error[j] *
            Random(kErrorSeed).child({static_cast<std::uint64_t>(i), static_cast<std::uint64_t>(j)}).normal();
      finite.push_back(column[i]);
    }
    if (static_cast<double>(finite.size()) < kFewestShare * static_cast<double>(column.size())) continue;
    const Eigen::Map<const Eigen::VectorXd> values(finite.data(), static_cast<Eigen::Index>(finite.size()));
    const double mean = values.mean();
    const double sd = std::sqrt((values.array() - mean).square().mean());
    if (!(sd > 0)) continue;
    std::sort(finite.begin(), finite.end());
    const auto beyond = static_cast<std::size_t>(0.001 * static_cast<double>(finite.size()));
    if (observed.descriptors[j] < finite[beyond] ||
        observed.descriptors[j] > finite[finite.size() - 1 - beyond])
      out.outlying.push_back(j);
    columns.push_back(column.unaryExpr([&](double v) {
      return std::isfinite(v) ? std::clamp((v - mean) / sd, -kFarthest, kFarthest) : 0.0;
    }));
    point.push_back(std::clamp((observed.descriptors[j] - mean) / sd, -kFarthest, kFarthest));
  }
  const auto used = static_cast<Eigen::Index>(columns.size());
  out.simulations.resize(all.rows(), used + simulations.known.cols());
  for (Eigen::Index k = 0; k < used; ++k) out.simulations.col(k) = columns[static_cast<std::size_t>(k)];
  out.simulations.rightCols(simulations.known.cols()) = simulations.known;
  out.observed.resize(used + observed.known.size());
  out.observed.head(used) =
      Eigen::Map<const Eigen::VectorXd>(point.data(), static_cast<Eigen::Index>(point.size()));
  out.observed.tail(observed.known.size()) = observed.known;
  return out;
}

/// Distance of each simulation from the observed tree: in the summaries, counted in their errors, and in what
/// is known.
Eigen::VectorXd distances(const SummaryRegression& regression, const PriorSimulations& simulations,
                          const Observation& observed) {
  Eigen::VectorXd square = Eigen::VectorXd::Zero(simulations.unit.rows());
  for (Eigen::Index j = 0; j < simulations.unit.cols(); ++j) {
    const double error = std::max(regression.error[j], 1e-6);
    square.array() += ((regression.fitted.col(j).array() - regression.predicted[j]) / error).square();
  }
  for (Eigen::Index j = 0; j < observed.known.size(); ++j)
    square.array() += ((simulations.known.col(j).array() - observed.known[j]) / kKnownScale).square();
  return square.cwiseSqrt();
}

PosteriorSample prior_sample(const PriorSimulations& simulations) {
  PosteriorSample sample;
  sample.is_prior = true;
  sample.unit = simulations.unit;
  sample.weights = Eigen::VectorXd::Constant(
      simulations.unit.rows(), 1.0 / static_cast<double>(std::max<Eigen::Index>(1, simulations.unit.rows())));
  sample.rows.resize(static_cast<std::size_t>(simulations.unit.rows()));
  std::iota(sample.rows.begin(), sample.rows.end(), Eigen::Index{0});
  return sample;
}

}  // namespace

PosteriorSample regression_posterior(const PriorSimulations& simulations, const Observation& observed) {
  check(simulations, observed);
  if (simulations.unit.rows() < kFewest) return prior_sample(simulations);
  const Standardised data = standardise(simulations, observed);
  if (data.observed.size() == 0) return prior_sample(simulations);

  const SummaryRegression regression(data.simulations, simulations.unit, data.observed);
  const Eigen::VectorXd distance = distances(regression, simulations, observed);
  std::vector<Eigen::Index> order(static_cast<std::size_t>(distance.size()));
  std::iota(order.begin(), order.end(), Eigen::Index{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](Eigen::Index a, Eigen::Index b) { return distance[a] < distance[b]; });
  const auto all = static_cast<double>(order.size());
  const auto nearest =
      static_cast<std::size_t>(std::min(all, std::clamp(kNearestShare * all, kFewestNearest, kMostNearest)));
  order.resize(nearest);

  PosteriorSample sample;
  sample.rows = order;
  sample.outlying = data.outlying;
  sample.unit.resize(static_cast<Eigen::Index>(nearest), simulations.unit.cols());
  sample.weights.resize(static_cast<Eigen::Index>(nearest));
  const double reach = 1.0001 * distance[order.back()] + 1e-12;
  for (std::size_t k = 0; k < nearest; ++k) {
    const Eigen::Index i = order[k];
    const auto at = static_cast<Eigen::Index>(k);
    sample.weights[at] = 1 - std::pow(distance[i] / reach, 2);  // Epanechnikov
    const Eigen::RowVectorXd moved =
        regression.predicted.transpose() + simulations.unit.row(i) - regression.fitted.row(i);
    sample.unit.row(at) = moved.cwiseMax(0.0).cwiseMin(1.0);
  }
  sample.weights /= sample.weights.sum();
  return sample;
}

double weighted_quantile(const Eigen::VectorXd& values, const Eigen::VectorXd& weights, double share) {
  std::vector<Eigen::Index> order(static_cast<std::size_t>(values.size()));
  std::iota(order.begin(), order.end(), Eigen::Index{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](Eigen::Index a, Eigen::Index b) { return values[a] < values[b]; });
  double sum = 0;
  for (const Eigen::Index i : order) {
    sum += weights[i];
    if (sum >= share) return values[i];
  }
  return values[order.back()];
}

double weighted_deviation(const Eigen::VectorXd& values, const Eigen::VectorXd& weights) {
  const double mean = weights.dot(values) / weights.sum();
  return std::sqrt(weights.dot((values.array() - mean).square().matrix()) / weights.sum());
}

}  // namespace dendrofit
