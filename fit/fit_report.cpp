// SPDX-License-Identifier: GPL-3.0-or-later
#include "fit/fit_report.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

namespace dendrofit {
namespace {

constexpr double kIdentifiableShrinkage = 0.3;
constexpr double kPairedShrinkage = 0.1;
constexpr double kPairCorrelation = 0.6;
constexpr double kPoorCost = 4;    // 2 sd a descriptor
constexpr double kSeedsApart = 1;  // two seeds of one tree
constexpr double kErratic = 2;  // trees of one parameter set that differ this much are not one kind of tree
constexpr int kFewForPosterior = 100;
// A tree that lacks more of the descriptors, or is stranger in more of them, is outside what the simulations
// know: what regressions say there is guessing.
constexpr double kFewestDescriptors = 0.6, kMostOutlying = 0.15;

/// The posterior's and the prior's reported values, one draw a row.
struct ReportedDraws {
  std::vector<ReportedRow> rows;
  Eigen::MatrixXd posterior, prior;
};

ReportedDraws reported_draws(const FitProblem& problem, const PosteriorSample& sample) {
  ReportedDraws draws;
  draws.rows = problem.space.reported();
  const auto columns = static_cast<Eigen::Index>(draws.rows.size());
  draws.posterior.resize(sample.unit.rows(), columns);
  for (Eigen::Index i = 0; i < sample.unit.rows(); ++i)
    draws.posterior.row(i) = problem.space.report(sample.unit.row(i).transpose(), draws.rows).transpose();
  constexpr Eigen::Index kPriorDraws = 400;
  draws.prior.resize(kPriorDraws, columns);
  for (Eigen::Index i = 0; i < kPriorDraws; ++i)
    draws.prior.row(i) =
        problem.space.report(prior_draw(static_cast<std::uint64_t>(i)).unit, draws.rows).transpose();
  return draws;
}

double prior_deviation(const Eigen::VectorXd& values) {
  return std::sqrt((values.array() - values.mean()).square().mean());
}

double shrinkage(const ReportedDraws& draws, const PosteriorSample& sample, Eigen::Index column) {
  if (sample.is_prior) return 0;
  const double prior = prior_deviation(draws.prior.col(column));
  if (!(prior > 0)) return 0;
  return std::clamp(1 - weighted_deviation(draws.posterior.col(column), sample.weights) / prior, 0.0, 1.0);
}

/// Whether the simulations know trees like the observed one.
bool within_experience(const FitProblem& problem, const PosteriorSample& sample) {
  double known = 0, expected = 0;
  for (std::size_t i = 0; i < descriptor_table().size(); ++i) {
    if (problem.options.observed_from == ObservedFrom::one_view && !descriptor_table()[i].one_view) continue;
    ++expected;
    known += std::isfinite(problem.observed[static_cast<Eigen::Index>(i)]) ? 1 : 0;
  }
  return known >= kFewestDescriptors * expected &&
         static_cast<double>(sample.outlying.size()) <= kMostOutlying * known;
}

double correlation(const Eigen::VectorXd& a, const Eigen::VectorXd& b, const Eigen::VectorXd& weights) {
  const Eigen::ArrayXd x = a.array() - weights.dot(a), y = b.array() - weights.dot(b);
  const double scale = std::sqrt(weights.dot(x.square().matrix()) * weights.dot(y.square().matrix()));
  return scale > 0 ? weights.dot((x * y).matrix()) / scale : 0;
}

/// Mean of the simulations that have it; NaN where none has.
double mean_where_known(const Eigen::VectorXd& values) {
  double sum = 0;
  int count = 0;
  for (const double v : values) {
    if (!std::isfinite(v)) continue;
    sum += v;
    ++count;
  }
  return count > 0 ? sum / count : std::numeric_limits<double>::quiet_NaN();
}

}  // namespace

std::vector<FittedParameter> report_parameters(const FitProblem& problem, const PosteriorSample& sample,
                                               const IgmParameters& best) {
  const std::vector<ParameterSpec> table = igm_parameter_table(best.equation);
  const ReportedDraws draws = reported_draws(problem, sample);
  const bool experienced = within_experience(problem, sample);
  std::vector<FittedParameter> report;
  for (std::size_t i = 0; i < draws.rows.size(); ++i) {
    const ReportedRow& row = draws.rows[i];
    const auto column = static_cast<Eigen::Index>(i);
    const auto spec =
        std::find_if(table.begin(), table.end(), [&](const ParameterSpec& s) { return s.key == row.key; });
    const auto at = [&](double share) {
      return weighted_quantile(
          sample.is_prior ? Eigen::VectorXd(draws.prior.col(column))
                          : Eigen::VectorXd(draws.posterior.col(column)),
          sample.is_prior ? Eigen::VectorXd::Constant(draws.prior.rows(), 1.0 / double(draws.prior.rows()))
                          : sample.weights,
          share);
    };
    FittedParameter p;
    p.key = row.key;
    p.unit = spec->unit;
    p.meaning = spec->meaning;
    p.value = best.get(row.key);
    p.median = at(0.5);
    p.lo = std::min(p.value, at(0.05));
    p.hi = std::max(p.value, at(0.95));
    p.lo50 = at(0.25);
    p.hi50 = at(0.75);
    p.prior_lo = std::min(row.lo, p.lo);
    p.prior_hi = std::max(row.hi, p.hi);
    p.shrinkage = shrinkage(draws, sample, column);
    p.identifiable = experienced && p.shrinkage >= kIdentifiableShrinkage;
    report.push_back(p);
  }
  return report;
}

std::vector<CorrelatedPair> report_correlations(const FitProblem& problem, const PosteriorSample& sample) {
  std::vector<CorrelatedPair> pairs;
  if (sample.is_prior) return pairs;
  const ReportedDraws draws = reported_draws(problem, sample);
  for (Eigen::Index i = 0; i < draws.posterior.cols(); ++i) {
    if (shrinkage(draws, sample, i) < kPairedShrinkage) continue;
    for (Eigen::Index j = i + 1; j < draws.posterior.cols(); ++j) {
      if (shrinkage(draws, sample, j) < kPairedShrinkage) continue;
      const double r = correlation(draws.posterior.col(i), draws.posterior.col(j), sample.weights);
      if (std::abs(r) >= kPairCorrelation)
        pairs.push_back(
            {draws.rows[static_cast<std::size_t>(i)].key, draws.rows[static_cast<std::size_t>(j)].key, r});
    }
  }
  return pairs;
}

std::vector<DescriptorFit> report_descriptors(const FitProblem& problem, const NoiseMetric& metric,
                                              const Eigen::MatrixXd& before, const Eigen::MatrixXd& after) {
  std::vector<DescriptorFit> report;
  for (const Eigen::Index j : metric.used()) {
    const DescriptorRow& row = descriptor_table()[static_cast<std::size_t>(j)];
    report.push_back({std::string(row.name), std::string(row.unit), problem.observed[j],
                      mean_where_known(before.col(j)), mean_where_known(after.col(j)), metric.noise(j)});
  }
  return report;
}

void warn(const FitProblem& problem, const PosteriorSample& posterior, TreeFit& fit) {
  fit.warnings = problem.warnings;
  if (fit.prior_simulations < kFewForPosterior)
    fit.warnings.push_back(
        fmt::format("{} simulations are too few to tell what the tree says of each parameter: without a bank "
                    "of prior simulations, a budget of 300 or more gives intervals",
                    fit.prior_simulations));
  if (!within_experience(problem, posterior))
    fit.warnings.emplace_back(
        "this tree is unlike any the growth model grows (or has hardly any branches to compare): no "
        "parameter "
        "can be told from it");
  if (fit.cost_after > kPoorCost || fit.seed_floor > kErratic) {
    for (FittedParameter& p : fit.parameters) p.identifiable = false;
    auto worst = fit.descriptors;
    std::stable_sort(worst.begin(), worst.end(), [](const DescriptorFit& a, const DescriptorFit& b) {
      return std::abs(a.after - a.observed) / a.noise > std::abs(b.after - b.observed) / b.noise;
    });
    std::string names;
    for (std::size_t i = 0; i < std::min<std::size_t>(3, worst.size()); ++i)
      names += (i ? ", " : "") + worst[i].name;
    fit.warnings.push_back("the growth model cannot follow this tree: even the best parameters miss its " +
                           names +
                           "; none of its parameters can be told, take them as a description of "
                           "the nearest tree");
  } else if (fit.cost_after > kSeedsApart && !(fit.cost_after < fit.cost_before)) {
    fit.warnings.push_back(fmt::format(
        "the fit came no nearer to this tree (distance {:.2f}) than the middle of the prior's trees "
        "({:.2f}): size "
        "and wood of the regrown tree are this tree's, its shape is not; a larger budget may help",
        fit.cost_after, fit.cost_before));
  }
  if (!posterior.outlying.empty()) {
    std::string names;
    for (const Eigen::Index j : posterior.outlying)
      if (j < problem.observed.size())  // beyond: what other trees say
        names +=
            (names.empty() ? "" : ", ") + std::string(descriptor_table()[static_cast<std::size_t>(j)].name);
    if (!names.empty())
      fit.warnings.push_back("hardly any simulated tree has this tree's " + names +
                             ": intervals are those of the nearest trees the model can grow");
  }
}

}  // namespace dendrofit
