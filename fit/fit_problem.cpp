// SPDX-License-Identifier: GPL-3.0-or-later
#include "fit/fit_problem.h"

#include "core/errors.h"
#include "core/metrics.h"
#include "core/parallel.h"
#include "core/random.h"
#include "fit/growth_fit.h"
#include "forward/growth_equations.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>

#include <fmt/format.h>

namespace dendrofit {
namespace {

constexpr int kMostDraws = 240;
constexpr int kCutTrees = 8;
constexpr double kOldestYearly = 26;  // older trees: a cycle is several years
constexpr double kCyclesOfOldTrees = 24;
constexpr double kExactShare = 0.1;  // of a scan's error: what is left of it where the tree is known
// Heights in internodes at which the bank has trees enough: all but 7 and 0.5 % of them lie between.
constexpr double kFewestInternodes = 30, kMostInternodes = 118;
// Of the height in internodes: where X at the end of growth lies.
constexpr double kSmallestSize = 0.95, kLargestSize = 1.9, kLeastSize = 6;

Eigen::VectorXd to_vector(const std::vector<double>& values) {
  return Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size()));
}

std::optional<double> age_of(const FitOptions& options) {
  if (options.age_years) return options.age_years;
  if (options.heights) return *std::max_element(options.heights->time.begin(), options.heights->time.end());
  return {};
}

double years_per_cycle(std::optional<double> age) {
  return age && *age > kOldestYearly ? *age / kCyclesOfOldTrees : 1;
}

/// The curve through dated heights, in cycles and shares of its asymptote.
GrowthCourse course_of(const MeasurementSeries& heights, const std::string& equation, double years_a_cycle) {
  const GrowthFit fit = fit_growth_equation(heights, equation);
  if (fit.status != GrowthStatus::ok)
    throw SolverError("the dated heights give no growth curve: " + fit.reason);
  std::vector<double> p;
  for (const GrowthParameter& parameter : fit.parameters) p.push_back(parameter.value);
  const GrowthEquation& row = growth_equation(equation);
  // fit.parameters come in growth.json's order, which is the equation's own; the asymptote becomes 1.
  const double most = p[row.asymptote_row];
  if (equation == "logistic") return {{p[0] / most, 1, p[2] * years_a_cycle}};
  if (equation == "bertalanffy") return {{1, p[1] * years_a_cycle}};
  return {{1, p[1] * std::pow(years_a_cycle, p[2]), p[2]}};
}

/// Latin hypercube sample of the unit box.
UnitPoints latin_hypercube(int count, Eigen::Index dimensions, std::uint64_t seed) {
  UnitPoints points(static_cast<std::size_t>(count), Eigen::VectorXd(dimensions));
  for (Eigen::Index d = 0; d < dimensions; ++d) {
    Random random = Random(seed).child({0x1a7, static_cast<std::uint64_t>(d)});
    std::vector<int> stratum(static_cast<std::size_t>(count));
    std::iota(stratum.begin(), stratum.end(), 0);
    for (std::size_t i = stratum.size(); i > 1; --i) std::swap(stratum[i - 1], stratum[random.below(i)]);
    for (std::size_t i = 0; i < points.size(); ++i) points[i][d] = (stratum[i] + random.uniform()) / count;
  }
  return points;
}

/// Columns of the bank that are known of the observed tree: which equation is asked for, and the fixed
/// coordinates of the search.
void add_known(const FitProblem& problem, PriorInformation& prior) {
  const SearchSpace open(problem.space.equation());
  std::vector<Eigen::Index> rows;
  for (const char* key : {"cycles", "maturity"})
    if (const Eigen::Index i = problem.space.row(key); problem.space.fixed(i)) rows.push_back(i);
  PriorSimulations& s = prior.simulations;
  const auto known = static_cast<Eigen::Index>(rows.size());
  s.known.resize(s.unit.rows(), known);
  prior.observation.known.resize(known);
  for (Eigen::Index k = 0; k < known; ++k) {
    const Eigen::Index i = rows[static_cast<std::size_t>(k)];
    s.known.col(k) = s.unit.col(i);
    prior.observation.known[k] = open.unit(i, problem.space.value(i, 0.5));
  }
}

/// What other trees say, as further descriptors that show a coordinate with that error.
void add_species(const FitProblem& problem, PriorInformation& prior) {
  const auto columns = prior.observation.descriptors.size();
  const auto more = static_cast<Eigen::Index>(problem.options.species.size());
  prior.simulations.descriptors.conservativeResize(Eigen::NoChange, columns + more);
  prior.observation.descriptors.conservativeResize(columns + more);
  prior.observation.error.conservativeResize(columns + more);
  for (Eigen::Index k = 0; k < more; ++k) {
    const SpeciesEstimate& estimate = problem.options.species[static_cast<std::size_t>(k)];
    prior.simulations.descriptors.col(columns + k) =
        prior.simulations.unit.col(problem.space.row(estimate.key));
    prior.observation.descriptors[columns + k] = estimate.unit;
    prior.observation.error[columns + k] = estimate.error;
  }
}

std::optional<std::string> why_unlike_bank(const FitProblem& problem) {
  const double size = problem.setting.observed.size_internodes;
  if (size >= kFewestInternodes && size <= kMostInternodes) return {};
  return fmt::format("its trees are {} to {} internodes tall, this one would be {:.0f}", kFewestInternodes,
                     kMostInternodes, size);
}

void from_bank(const FitProblem& problem, PriorInformation& prior) {
  const PriorBank& bank = *problem.options.bank;
  const auto n = static_cast<Eigen::Index>(bank.size());
  const auto columns = static_cast<Eigen::Index>(descriptor_table().size());
  prior.from_bank = true;
  prior.simulations.descriptors =
      bank.descriptors.middleCols(static_cast<Eigen::Index>(problem.level) * columns, columns).cast<double>();
  prior.simulations.unit.resize(n, problem.space.size());
  for (Eigen::Index i = 0; i < n; ++i) {
    const PriorDraw draw = prior_draw(static_cast<std::uint64_t>(i));
    prior.simulations.unit.row(i) = draw.unit.transpose();
    const auto& names = SearchSpace::equations();
    prior.simulations.group.push_back(
        static_cast<int>(std::find(names.begin(), names.end(), draw.equation) - names.begin()));
  }
}

void from_new_simulations(FitProblem& problem, PriorInformation& prior, SimulationLog& log,
                          Progress& progress) {
  const double height = problem.setting.observed.size_internodes;
  problem.space.limit("size", std::max(kLeastSize, kSmallestSize * height),
                      std::max(kLeastSize * 2, kLargestSize * height));
  const int count = std::clamp(problem.options.evaluations / 2, 1, kMostDraws);
  prior.points = latin_hypercube(count, problem.space.size(), problem.options.seed);
  progress.begin("simulating the prior", count, "sets");
  prior.simulations.descriptors = problem.run(prior.points, 1, kPriorKeys, log, progress);
  progress.end();
  prior.simulations.unit.resize(count, problem.space.size());
  for (int i = 0; i < count; ++i) prior.simulations.unit.row(i) = prior.points[static_cast<std::size_t>(i)];
}

}  // namespace

Eigen::MatrixXd FitProblem::run(const UnitPoints& points, int seeds, std::uint64_t first_key,
                                SimulationLog& log, Progress& progress) const {
  return simulate(points, space, setting, seeds, first_key, log, progress);
}

double FitProblem::seconds(const SimulationLog& log) const {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - started).count() +
         log.earlier_seconds();
}

bool FitProblem::out_of_time(const SimulationLog& log) const {
  return options.seconds && seconds(log) > *options.seconds;
}

FitProblem pose(const Tree& observed, const FitOptions& options) {
  const std::optional<double> age = age_of(options);
  DirectEstimates direct = estimate_directly(observed, options.internode_length_m);
  if (options.dbh_m) direct.dbh_m = options.dbh_m;
  FitProblem problem{options,
                     {direct, {}, options.observe, options.thinnest_wood_m, options.seed, options.threads},
                     SearchSpace(options.equation)};
  problem.years_per_cycle = years_per_cycle(age);
  problem.space.set_internode_length(direct.internode_length_m);
  if (age) problem.space.fix("cycles", std::max(1.0, std::round(*age / problem.years_per_cycle)));
  if (options.heights)
    problem.space.fix_course(course_of(*options.heights, options.equation, problem.years_per_cycle));

  problem.level = comparison_level(observed, options.observed_from);
  problem.setting.comparison.visible_share = kVisibleShares[problem.level];
  problem.setting.comparison.internode_length_m = direct.internode_length_m;
  problem.observed = to_vector(describe(observed, problem.setting.comparison));
  problem.error.resize(problem.observed.size());
  for (std::size_t i = 0; i < descriptor_table().size(); ++i) {
    const DescriptorRow& row = descriptor_table()[i];
    const auto j = static_cast<Eigen::Index>(i);
    // Seen through the observer, simulations carry the observation's error themselves.
    const bool exact = options.observed_from == ObservedFrom::exact || options.observe;
    problem.error[j] = (exact ? kExactShare : 1) * row.scan_error;
    if (options.observed_from == ObservedFrom::one_view && !row.one_view)
      problem.observed[j] = std::numeric_limits<double>::quiet_NaN();
  }
  return problem;
}

std::uint64_t identity(const FitProblem& problem) {
  const FitOptions& o = problem.options;
  Digest digest;
  for (const double v : problem.observed) digest.add(v);
  for (const double v : problem.error) digest.add(v);
  for (Eigen::Index i = 0; i < problem.space.size(); ++i) digest.add(problem.space.value(i, 0.3));
  digest.add(o.evaluations).add(o.seconds ? 1 : 0).add(o.equation).add(o.seeds);
  digest.add(static_cast<double>(o.seed >> 32)).add(static_cast<double>(o.seed & 0xffffffff));
  digest.add(problem.setting.observed.internode_length_m).add(problem.setting.observed.dbh_m.value_or(-1));
  digest.add(o.bank ? static_cast<double>(o.bank->size()) : -1).add(o.observe ? 1 : 0);
  digest.add(o.thinnest_wood_m.value_or(-1));
  for (const SpeciesEstimate& e : o.species) digest.add(e.key).add(e.unit).add(e.error);
  for (const auto& [key, unit] : o.held) digest.add(key).add(unit);
  for (const double v :
       problem.space.at(Eigen::VectorXd::Constant(problem.space.size(), 0.5)).equation_values)
    digest.add(v);
  for (const float v : model_stamp()) digest.add(v);
  return digest.value();
}

PriorInformation prior_information(FitProblem& problem, SimulationLog& log, Progress& progress) {
  PriorInformation prior;
  prior.observation.descriptors = problem.observed;
  prior.observation.error = problem.error;
  const auto bank = problem.options.bank;
  const std::optional<std::string> stale = bank ? why_stale(*bank) : "there is none";
  const std::optional<std::string> why = stale ? stale : why_unlike_bank(problem);
  if (!why) {
    from_bank(problem, prior);
  } else {
    if (bank)
      problem.warnings.push_back("the bank of prior simulations is not used: " + *why +
                                 "; part of the budget goes into new ones");
    from_new_simulations(problem, prior, log, progress);
  }
  // Noise depends less on the tree than the tree does: the bank's serves trees of every size.
  prior.noise = stale ? noise_about_trend(prior.simulations.unit, prior.simulations.descriptors)
                      : bank->noise.at(problem.level);
  add_known(problem, prior);
  add_species(problem, prior);
  return prior;
}

Observation as_whole(const FitProblem& problem, const Observation& observation, const Eigen::VectorXd& centre,
                     Progress& progress) {
  const IgmParameters parameters = problem.space.at(centre);
  std::array<double, kCutTrees> lost{};
  parallel_blocks(lost.size(), 1, problem.options.threads, [&](std::size_t s, std::size_t) {
    progress.check();
    const std::uint64_t seed = simulation_seed(problem.options.seed, kCutKeys, static_cast<int>(s));
    const Tree whole = regrow(parameters, problem.setting.observed, seed, no_progress()).tree;
    lost[s] = std::log(measure(whole).height_m / measure(as_observed(whole, problem.setting)).height_m);
  });
  double mean = 0;
  for (const double l : lost) mean += std::isfinite(l) ? l / kCutTrees : 0;
  Observation corrected = observation;
  corrected.descriptors[static_cast<Eigen::Index>(descriptor_row("internodes"))] += mean;
  return corrected;
}

std::vector<EquationEvidence> equation_evidence(const PosteriorSample& posterior,
                                                const PriorSimulations& simulations) {
  if (simulations.group.empty() || posterior.is_prior) return {};
  const auto& names = SearchSpace::equations();
  std::vector<EquationEvidence> evidence;
  double sum = 0;
  // One draw's worth of each equation's prior share keeps an equation without a near draw possible.
  const double one = 1.0 / static_cast<double>(posterior.rows.size());
  for (std::size_t e = 0; e < names.size(); ++e) {
    double weight = one * prior_share(names[e]);
    for (std::size_t k = 0; k < posterior.rows.size(); ++k)
      if (simulations.group[static_cast<std::size_t>(posterior.rows[k])] == static_cast<int>(e))
        weight += posterior.weights[static_cast<Eigen::Index>(k)];
    evidence.push_back({names[e], weight / prior_share(names[e]), 0});
    sum += evidence.back().probability;
  }
  for (EquationEvidence& e : evidence) {
    e.log10_evidence = std::log10(e.probability / (sum / static_cast<double>(names.size())));
    e.probability /= sum;
  }
  return evidence;
}

}  // namespace dendrofit
